#include <fmt/format.h>

#include <memory>

#include "framework/cli/commands.h"
#include "framework/report/dh_model.h"
#include "framework/report/report.h"

namespace talus {

void add_convert(CLI::App& app) {
  CLI::App* command =
      add_command(app, "convert", "write a model in the other syntax, or with other joints");
  auto common = std::make_shared<Common>();
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("model", files->first, "model file (.xml or .lua)")->required();
  command->add_option("out", files->second, "file to write (.xml or .lua)")->required();
  auto joints = std::make_shared<std::string>();
  command
      ->add_option("--joints", *joints,
                   "write a chain of hinges with these joints instead: dh (Denavit-Hartenberg)")
      ->type_name("dh");
  add_common(*command, *common, true, false);
  command->callback([=] {
    Registry registry = common->registry();
    Model model = open_model(files->first, registry, *common);
    const bool lua = files->second.ends_with(".lua");
    if (!lua && !files->second.ends_with(".xml"))
      throw InputError({files->second, 0, 0}, "unknown ending", ".xml or .lua");
    if (!joints->empty() && *joints != "dh")
      throw InputError({"--joints " + *joints, 0, 0}, "no such conversion", "dh",
                       nearest(*joints, {"dh"}));
    if (!joints->empty()) model = dh_model(model, registry);
    move_plugin_paths(model, files->first, files->second);
    write_file(files->second, lua ? write_lua(model) : write_xml(model));
  });
}

}  // namespace talus
