// talus: linkages in model files, calibrated and explained.
#include <fmt/format.h>

#include <algorithm>

#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"

int& talus::exit_code() {
  static int code = 0;
  return code;
}

// As it can be pasted into a shell.
static std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                              "0123456789-_=+:,./@%") == std::string::npos)
    return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

int main(int argc, char** argv) {
  talus::command_line() = "talus";
  for (int i = 1; i < argc; ++i) talus::command_line() += " " + quoted(argv[i]);
  CLI::App app{"Talus models, calibrates and explains linkages.", "talus"};
  app.set_version_flag("--version", std::string("talus ") + TALUS_VERSION);
  app.require_subcommand(1);
  talus::add_check(app);
  talus::add_calibrate(app);
  talus::add_diagnose(app);
  talus::add_simulate(app);
  talus::add_measure(app);
  talus::add_axes(app);
  talus::add_study(app);
  talus::add_motion(app);
  talus::add_plugins(app);
  talus::add_schema(app);
  talus::add_convert(app);
  talus::add_draw(app);
  talus::add_play(app);
  try {
    if (argc > 1 && argv[1][0] != '-') {  // a command that does not exist: the nearest one
      std::vector<std::string> names;
      for (const CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
        names.push_back(command->get_name());
      if (std::find(names.begin(), names.end(), argv[1]) == names.end())
        throw talus::InputError({"talus", 0, 0}, fmt::format("no command '{}'", argv[1]),
                                "one of: " + talus::join(names), talus::nearest(argv[1], names));
    }
    app.parse(argc, argv);
    return talus::exit_code();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    std::string command = "talus";
    for (const CLI::App* chosen : app.get_subcommands()) command += " " + chosen->get_name();
    talus::complain(command, fmt::format("{}\n  {} --help tells more", e.what(), command));
    return 2;
  } catch (const talus::InputError& e) {
    talus::complain(e);
    return 2;
  } catch (const std::exception& e) {
    talus::complain("talus", e.what());
    return 2;
  }
}
