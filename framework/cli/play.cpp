#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/dsl/text.h"
#include "framework/report/report.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

struct Options {
  Common common;
  std::string model, recordings, out;
};

// Beside the command where it was built, or where it was installed.
std::string page_template() {
  std::error_code error;
  const fs::path command = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& file :
       {command / "play.html", command.parent_path() / "share" / "talus" / "play.html"})
    if (std::ifstream in{file, std::ios::binary})
      return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  throw InputError(
      "talus play: the page was not built; run scripts/setup --page, then scripts/build page");
}

// Paths from the folder that holds them all, as the page sees them.
std::vector<std::string> short_paths(const std::vector<std::string>& files) {
  std::vector<fs::path> whole;
  for (const std::string& file : files) whole.push_back(fs::weakly_canonical(file));
  fs::path folder = whole[0].parent_path();
  const auto outside = [&](const fs::path& file) {
    return *file.lexically_relative(folder).begin() == "..";
  };
  while (std::any_of(whole.begin(), whole.end(), outside)) folder = folder.parent_path();
  std::vector<std::string> paths;
  for (const fs::path& file : whole)
    paths.push_back(file.lexically_relative(folder).generic_string());
  return paths;
}

nlohmann::ordered_json given(const Options& o) {
  Registry registry = Registry::built_in();
  const Model model = read_model(o.model, registry);
  const std::vector<std::string>& files = model.sources;  // what it includes and loads as well
  const std::vector<std::string> paths = short_paths(files);
  nlohmann::ordered_json out{{"file", paths[0]}, {"text", read_text(files[0])}};
  out["files"] = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < files.size(); ++i) out["files"][paths[i]] = read_text(files[i]);
  if (!o.recordings.empty())
    out["recordings"] = {{"file", fs::path(o.recordings).filename().string()},
                         {"text", write_recordings(read_recordings(o.recordings))}};
  return out;
}

void run(const Options& o) {
  std::string page = page_template();
  const std::string file = !o.out.empty()    ? o.out
                           : o.model.empty() ? "play.html"
                                             : fs::path(o.model).stem().string() + "-play.html";
  check_writable(file);
  check_apart(file, {o.model, o.recordings});
  if (!o.model.empty()) {
    std::string json = given(o).dump();
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
      json.replace(at, 1, "\\u003c");  // nothing in a script may end it
    const std::string place = "id=\"given\">";
    const std::size_t at = page.find(place + "null");
    if (at == std::string::npos) throw InputError("the teaching page's template is damaged");
    page.replace(at + place.size(), 4, json);
  }
  put(file, page);
  if (file != "-" && !o.common.quiet) show(fmt::format("Teaching page: {}\n", file));
}

}  // namespace

void add_play(CLI::App& app) {
  CLI::App* command =
      add_command(app, "play", "a page to learn with: edit a model and see what it does");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua); without it, the lessons");
  command->add_option("recordings", o->recordings, "recordings (.csv or .trc) to begin with");
  command->add_option("--out", o->out, "page to write (default: MODEL-play.html, here)")
      ->type_name("FILE.html");
  add_quiet(*command, o->common);
  add_color(*command);
  command->callback([o] { run(*o); });
}

}  // namespace talus
