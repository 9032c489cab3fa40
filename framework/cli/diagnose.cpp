// talus diagnose: what physics is missing, where, how sure; and the model that has it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "framework/calibration/circumstances.h"
#include "framework/cli/commands.h"
#include "framework/cli/terminal.h"
#include "framework/dsl/dsl.h"
#include "framework/page/contents.h"
#include "framework/report/diagnosis_report.h"
#include "framework/report/progress.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, points, next, html;
  double check = 0.3;
  std::vector<std::string> groups, only;
  DiagnosisOptions diagnosis;
  DiagnosisTextOptions text;
  int next_count = 8;
};

// The formulas suggested, each as a Lua effect and a model that has it beside it; the models.
std::vector<std::string> write_formulas(const Options& o, const Advice& advice,
                                        const std::filesystem::path& folder) {
  std::vector<std::string> files;
  const bool lua = o.model.ends_with(".lua");
  for (const std::optional<Suggestion>& s : advice.formulas) {
    files.emplace_back();
    if (!s || !s->wins) continue;
    const std::string stem = std::filesystem::path(o.model).stem().string() + "-" + s->tag;
    files.back() = (folder / (stem + (lua ? "-model.lua" : ".xml"))).string();
    Model model = calibrated_model(s->model, *s->program, s->fit);
    move_plugin_paths(model, o.model, files.back());
    Element plugin;
    plugin.tag = "plugin";
    plugin.set("file", stem + ".lua");
    model.root.children.insert(model.root.children.begin(), plugin);
    write_file((folder / (stem + ".lua")).string(), s->lua);
    write_file(files.back(), lua ? write_lua(model) : write_xml(model));
  }
  return files;
}

void run(Options& o) {
  const std::filesystem::path folder = o.common.out.empty() ? "." : o.common.out;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw InputError({folder.string(), 0, 0}, "is no folder", "--out DIR");
  check_writable(o.common.json);
  check_html(o.html, {o.model, o.recordings, o.points});
  check_writable(o.next);
  check_apart(o.next, {o.model, o.recordings});
  Registry registry = o.common.registry();
  const Model model = open_model(o.model, registry, o.common);
  const Program program = compile(model, registry);
  const Measured measured = open_recordings(program, o.recordings, o.points);
  const Recordings recordings = with_derived(program, measured.recordings);
  const Split split =
      split_rows(recordings, split_options(program, recordings, o.check, o.groups, o.common.seed));
  for (const std::string& tag : o.only)
    if (!registry.find(tag, Family::effect))
      throw InputError({"--only " + tag, 0, 0}, "no such effect",
                       "one of: " + join(registry.tags(Family::effect)),
                       nearest(tag, registry.tags(Family::effect)));
  o.diagnosis.fit.threads = o.common.thread_count();
  o.diagnosis.fit.seed = o.diagnosis.search.seed = o.common.seed;
  o.diagnosis.search.suspects.only = o.only;
  auto bar = std::make_unique<Progress>(!o.common.quiet, "calibrating");
  o.diagnosis.progress = bar->teller();
  const Diagnosis d = diagnose(model, registry, recordings, split, o.diagnosis);
  AdviceOptions advice_options;
  advice_options.suspects = o.diagnosis.search.suspects;
  advice_options.threads = o.diagnosis.fit.threads;
  advice_options.seed = o.common.seed;
  advice_options.poses = o.next_count;
  advice_options.progress = o.diagnosis.progress;
  const Advice advice = advise(model, registry, d, advice_options);
  bar.reset();

  DiagnosisFiles files;
  std::string& file = files.extended_model;
  if (!d.findings.empty()) {
    Model extended = calibrated_model(d.extended_model, *d.program_after, d.after);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
      throw InputError({folder.string(), 0, 0}, "cannot be made: " + error.message(), "--out DIR");
    const bool lua = o.model.ends_with(".lua");
    file = (folder / (std::filesystem::path(o.model).stem().string() +
                      (lua ? "-extended.lua" : "-extended.xml")))
               .string();
    move_plugin_paths(extended, o.model, file);
    write_file(file, lua ? write_lua(extended) : write_xml(extended));
  }
  files.formula_models = write_formulas(o, advice, folder);
  if (!o.next.empty() && !advice.next.poses.empty()) {
    std::string head =
        fmt::format("# poses to record next, for {} after {}\n", o.model, o.recordings);
    for (std::size_t k = 0; k < advice.next.poses.size(); ++k)
      if (const std::string& how = advice.next.poses[k].how; !how.empty())
        head += fmt::format("# {}: {}\n", k + 1, how);
    put(o.next, head + write_recordings(advice.next.table));
    files.next_poses = o.next;
  }
  const ReportContext context{"diagnose", o.model, o.recordings, &measured};
  if (!o.common.json.empty()) put(o.common.json, diagnosis_json(d, advice, context, files));
  if (!o.html.empty()) {
    PageContent page =
        page_content("diagnose", model, o.common, {o.recordings, measured.points_file});
    page.report_json = diagnosis_json(d, advice, context, files);
    page.report_text = diagnosis_text(d, advice, context, files, {true, true});
    const Recordings before = with_derived(*d.program, d.recordings, fit_before(d).x),
                     after = with_derived(*d.program_after, d.recordings, d.after.x);
    page_of_diagnosis(page, d, advice, before, after);
    put_page(o.html, page);
  }
  if (o.common.report_wanted()) show(diagnosis_text(d, advice, context, files, o.text));
  for (const std::string& warning : d.warnings) warn(warning);
  exit_code() = d.baseline.converged ? 0 : 1;
}

}  // namespace

void add_diagnose(CLI::App& app) {
  CLI::App* command = add_command(
      app, "diagnose",
      "locate what simulation and recordings differ by, name it, model it, prove it on rows held "
      "out; writes the extended model");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  command->add_option("recordings", o->recordings, "recordings (.csv or .trc)")->required();
  add_split(*command, o->check, o->groups);
  command->add_option("--only", o->only, "effects to consider, instead of all that are registered")
      ->delimiter(',');
  command->add_option("--next", o->next, "table to write the poses to record next to")
      ->type_name("FILE");
  command->add_option("--next-count", o->next_count, "how many such poses (0: none)")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command->add_flag("--details", o->text.details,
                    "curves of the findings, all rivals and parameters, what each pose is for");
  command->add_flag("--sensitivity", o->text.sensitivity,
                    "the smallest magnitude that would have been seen, of every suspect");
  add_points(*command, o->points);
  add_html(*command, o->html);
  add_common(*command, o->common, true, true);
  command->callback([o] { run(*o); });
}

}  // namespace talus
