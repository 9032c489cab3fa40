#include "framework/report/motion.h"

#include <fmt/format.h>

#include <memory>

#include "framework/calibration/inverse.h"
#include "framework/cli/commands.h"
#include "framework/report/progress.h"

namespace talus {
namespace {

struct Options {
  Common common;
  std::string model, recordings, poses = "65", grid, of, in, angles, file = "-";
  std::vector<std::string> frames;
  bool limbs = false;
};

MotionOptions motion_options(const Options& o, const Program& program) {
  MotionOptions result;
  if (!o.of.empty())
    result.frames.push_back(
        parse_frame_pair(o.in.empty() ? o.of : o.of + " in " + o.in, program, {"--of", 0, 0}));
  for (const std::string& text : o.frames)
    result.frames.push_back(parse_frame_pair(text, program, {"--frame " + text, 0, 0}));
  if (!o.angles.empty())
    result.angles = parse_named_angles(o.angles, {"--angles " + o.angles, 0, 0});
  result.limbs = o.limbs;
  if (o.limbs && program.limbs.empty())
    throw InputError({o.model, 0, 0}, "the model has no limb, so --limbs has nothing to show",
                     "<limb name=... length=... width=... height=.../>");
  return result;
}

void run(const Options& o) {
  check_writable(o.file);
  check_apart(o.file, {o.recordings, o.poses, o.model});
  Registry registry = o.common.registry();
  Program program = compile(open_model(o.model, registry, o.common), registry);
  const MotionOptions options = motion_options(o, program);
  std::string head = fmt::format("# motion of {} by talus {}\n", o.model, TALUS_VERSION);
  Recordings table;
  auto bar = std::make_unique<Progress>(!o.common.quiet, "motion");
  if (auto drawn = drawn_settings(program, o.recordings.empty() ? o.poses : o.recordings, o.grid,
                                  o.common.seed)) {
    table = motion_table(program, *drawn, options);
  } else {
    const Recordings from = read_recordings(o.recordings.empty() ? o.poses : o.recordings);
    const Recovered found = recover(program, from, Reach::nearest, o.common.thread_count());
    if (!found.solved.empty())
      head += fmt::format(
          "# found from the measured features of {}: {}; weighted residuals left: {:.3g} "
          "(root mean square)\n",
          from.file, join(found.solved), found.misfit);
    table = motion_table(program, found.settings, options, &from);
  }
  bar.reset();
  put(o.file, head + write_recordings(table));
}

}  // namespace

void add_motion(CLI::App& app) {
  CLI::App* command =
      add_command(app, "motion",
                  "a table of coordinates and of frames' positions and orientations, pose by pose");
  auto o = std::make_shared<Options>();
  command->add_option("model", o->model, "model file (.xml or .lua)")->required();
  CLI::Option* recordings = command->add_option(
      "recordings", o->recordings,
      "table with the readings, or with measured features from which they are found");
  CLI::Option* poses = command->add_option("--poses", o->poses,
                                           "without recordings: how many random poses, or a table");
  poses->capture_default_str()->excludes(recordings);
  command
      ->add_option("--grid", o->grid, "every combination: \"encoder1=-20:20:10; encoder2=0,30,60\"")
      ->excludes(recordings)
      ->excludes(poses);
  command
      ->add_option("--frame", o->frames,
                   "frame to show: \"E in B\"; can be repeated (default: what is measured)")
      ->type_name("FRAME")
      ->allow_extra_args(false);
  CLI::Option* of = command->add_option("--of", o->of, "the same in two words: --of E --in B");
  command->add_option("--in", o->in, "frame it is seen from (default: the root)")->needs(of);
  command->add_option("--angles", o->angles,
                      "ordered rotations instead of quaternions, in (-180, 180] deg: zxy, or "
                      "\"flexion=z, internal=x, inversion=y\"");
  command->add_flag("--limbs", o->limbs,
                    "and the vertices, centre and axes' ends of all limbs, in the root frame");
  command->add_option("--table", o->file, "file to write (- for standard output)")
      ->capture_default_str();
  add_common(*command, o->common, true, false);
  add_seed(*command, o->common);
  add_quiet(*command, o->common);
  add_threads(*command, o->common);
  command->callback([o] { run(*o); });
}

}  // namespace talus
