// The commands of `talus`, one file each. Each adds its subcommand and what it does when chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "framework/calibration/settings.h"
#include "framework/dsl/dsl.h"
#include "framework/kinematics/program.h"
#include "framework/metrology/measure.h"
#include "framework/page/page.h"

namespace talus {

struct Common {
  std::vector<std::string> plugins, sets;
  std::string out, json;
  std::uint64_t seed = 1;
  int threads = 0;
  bool quiet = false;

  bool report_wanted() const { return !quiet && json != "-"; }  // on standard output
  Registry registry() const;  // built-in plugins and those named with --plugin
  int thread_count() const;   // as asked, or one per core
};

// A subcommand. Made here alone: a file that makes one compiles much of CLI11 anew.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description);
// --plugin, --color; with `model` also --set; with `results` also all that follow, and --out.
void add_common(CLI::App& command, Common& common, bool model, bool results);
void add_color(CLI::App& command);
void add_quiet(CLI::App& command, Common& common);  // where something is printed beside the result
void add_json(CLI::App& command, Common& common);
void add_seed(CLI::App& command, Common& common);
void add_threads(CLI::App& command, Common& common);

// Recordings, with what is probed worked out from its points: those of `points_file`, else of
// points.csv beside the recordings.
Measured open_recordings(const Program& program, const std::string& file,
                         const std::string& points_file);
void add_points(CLI::App& command, std::string& points_file);  // --points

// --html FILE: the report as a page. InputError early where it could not be written; the content
// with what every page says of its command.
void add_html(CLI::App& command, std::string& file);
void check_html(const std::string& file, const std::vector<std::string>& inputs);
PageContent page_content(const std::string& command, const Model& model, const Common& common,
                         const std::vector<std::string>& files);
void put_page(const std::string& file, const PageContent& content);
std::string& command_line();  // as it was given

// Which rows are held out: --check, --group.
void add_split(CLI::App& command, double& check, std::vector<std::string>& groups);
// Columns whose equal rows must stay on one side: what unknowns are shared by, sessions where there
// are enough, and what the user names.
SplitOptions split_options(const Program& program, const Recordings& recordings, double check,
                           const std::vector<std::string>& groups, std::uint64_t seed);

// Reads a model and applies --set NAME=VALUE (element.attribute=..., or an attribute of
// <calibrate>).
Model open_model(const std::string& file, Registry& registry, const Common& common);

// Every combination of `grid`, or as many random poses as `poses` says; nothing where `poses` is
// the name of a table.
std::optional<Settings> drawn_settings(const Program& program, const std::string& poses,
                                       const std::string& grid, std::uint64_t seed);

// Writes to a file beside which nothing is left half done, or to standard output for "-".
// Early, before anything is computed: InputError where `file` could not be written.
void check_writable(const std::string& file);
// InputError where the file to write is one of those read.
void check_apart(const std::string& out, const std::vector<std::string>& inputs);
void put(const std::string& file, const std::string& text);

void add_measure(CLI::App& app);
void add_check(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_simulate(CLI::App& app);
void add_motion(CLI::App& app);
void add_plugins(CLI::App& app);
void add_schema(CLI::App& app);
void add_convert(CLI::App& app);
void add_axes(CLI::App& app);
void add_study(CLI::App& app);
void add_draw(CLI::App& app);
void add_play(CLI::App& app);

// What the chosen command ended with: 0 done, 1 not converged or nothing usable.
int& exit_code();

}  // namespace talus
