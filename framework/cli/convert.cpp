#include <fmt/format.h>

#include <memory>

#include "framework/cli/commands.h"
#include "framework/report/report.h"

namespace talus {

void add_convert(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("convert", "write a model in the other syntax: .xml or .lua");
  auto common = std::make_shared<Common>();
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("model", files->first, "model file (.xml or .lua)")->required();
  command->add_option("out", files->second, "file to write (.xml or .lua)")->required();
  add_common(*command, *common, true, false);
  command->callback([=] {
    Registry registry = common->registry();
    Model model = open_model(files->first, registry, *common);
    const bool lua = files->second.ends_with(".lua");
    if (!lua && !files->second.ends_with(".xml"))
      throw InputError({files->second, 0, 0}, "unknown ending", ".xml or .lua");
    move_plugin_paths(model, files->first, files->second);
    write_file(files->second, lua ? write_lua(model) : write_xml(model));
  });
}

}  // namespace talus
