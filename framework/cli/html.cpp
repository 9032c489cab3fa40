// --html: the report of a command as a page.
#include "framework/cli/commands.h"
#include "framework/report/report.h"

namespace talus {

std::string& command_line() {
  static std::string line;
  return line;
}

void add_html(CLI::App& command, std::string& file) {
  command
      .add_option("--html", file,
                  "write the report as one page with the linkage in 3-D, for any browser")
      ->type_name("FILE");
}

void check_html(const std::string& file, const std::vector<std::string>& inputs) {
  if (file.empty()) return;
  check_writable(file);
  check_apart(file, inputs);
  if (!has_page_template()) write_page({});  // says how to get it
}

PageContent page_content(const std::string& command, const Model& model, const Common& common,
                         const std::vector<std::string>& files) {
  PageContent content;
  content.command = command;
  content.command_line = command_line();
  content.model = &model;
  content.sets = common.sets;
  for (const std::string& file : files)
    if (!file.empty()) content.files.push_back(file);
  return content;
}

void put_page(const std::string& file, const PageContent& content) {
  if (!file.empty()) write_file(file, write_page(content));
}

}  // namespace talus
