#include "framework/report/draw.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/report/draw_page.h"

namespace talus {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

// Told apart from each other and from the triads' colours.
constexpr Colour ghost_colours[] = {0xaa3377, 0x6b7a00, 0x5e4fa2, 0xa0522d};

std::string value_text(double value, const Unit& unit) {
  const double written = value / unit.factor;
  const bool common = unit.text == "deg" || unit.text == "mm";
  std::string text = common ? fmt::format("{:.1f}", written) : fmt::format("{:.4g}", written);
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') text.erase(0, 1);
  return unit.text.empty() || unit.text == "1" ? text : text + " " + unit.text;
}

std::string coordinates_text(const Program& program, const std::vector<double>& pose) {
  std::vector<std::string> words;
  const std::vector<Coordinate> list = coordinates(program);
  for (std::size_t i = 0; i < pose.size(); ++i)
    words.push_back(list[i].name + " " + value_text(pose[i], program.units.of(list[i].dimension)));
  return join(words);
}

// One linkage with what is needed to know where everything is.
struct Shown {
  const Program* program;
  const Settings* settings;
  std::string label;
  Posture posture;
  Skeleton skeleton;
  SceneOptions options;

  explicit Shown(const DrawnLinkage& linkage)
      : program(linkage.program),
        settings(&linkage.settings),
        label(linkage.label.empty() ? linkage.program->name : linkage.label),
        posture(*linkage.program),
        skeleton(*linkage.program) {}

  void set(std::size_t pose) {
    posture.set(settings->poses[pose]);
    for (std::size_t f = 0; f < program->frames.size(); ++f)
      if (!posture.frame(static_cast<int>(f)).matrix().allFinite())
        throw InputError({program->frames[f].place},
                         fmt::format("frame '{}' has no place at {}", program->frames[f].name,
                                     coordinates_text(*program, settings->poses[pose])),
                         "coordinates that the linkage can reach");
    skeleton.set(posture);
  }
};

class Drawing {
 public:
  Drawing(const DrawnLinkage& linkage, const std::vector<DrawnLinkage>& ghosts,
          const DrawOptions& options)
      : o_(options), page_{options.width, options.height} {
    shown_.emplace_back(linkage);
    for (const DrawnLinkage& ghost : ghosts) shown_.emplace_back(ghost);
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      shown_[i].options.triads = triads(shown_[i], i == 0);
      if (i > 0) shown_[i].options.ghost = ghost_colours[(i - 1) % std::size(ghost_colours)];
    }
  }

  std::vector<Picture> run() {
    const Camera camera = parse_camera(o_.view, o_.up);
    const std::size_t count = shown_[0].settings->poses.size();
    if (count == 0) return {};
    nearer_roots();
    Points3 extent;
    std::size_t lines = 0;
    for (std::size_t k = 0; k < count; ++k) {
      set(k);
      for (Shown& s : shown_) extend(extent, *s.program, s.posture, s.skeleton, s.options);
      lines = std::max(lines, caption(k).size());
    }
    const Projection projection = fit(extent, camera, page_, lines);
    const bool sized = size_of(extent) > 0;  // otherwise all is at one point: signs alone, large
    for (Shown& s : shown_) s.options.unit = (sized ? 1 : 3) * page_.unit() / projection.scale;
    NamePlaces places;
    std::vector<Picture> pictures;
    for (std::size_t k = 0; k < count; ++k) {
      set(k);
      Scene scene;
      for (Shown& s : shown_) add_linkage(scene, *s.program, s.posture, s.skeleton, s.options);
      auto below = caption(k);
      while (below.size() < lines) below.push_back({});
      pictures.push_back(paint(scene, projection, page_, below, sized, places));
      if (o_.progress) o_.progress(static_cast<double>(k + 1) / static_cast<double>(count));
    }
    return pictures;
  }

 private:
  static double size_of(const Points3& points) {
    Vector3d low = Vector3d::Constant(INFINITY), high = -low;
    for (const Vector3d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return points.empty() ? 0 : (high - low).norm();
  }

  // Judged by the first pose, where what hangs on the root by a fixed joint keeps its place.
  void nearer_roots() {
    set(0);
    for (Shown& s : shown_) {
      SceneOptions without = s.options;
      without.near_root =
          s.skeleton.bones().empty() ? Vector3d(0, 0, 0) : s.skeleton.bones()[0].points.back();
      Points3 rest;
      extend(rest, *s.program, s.posture, s.skeleton, without);
      s.options.near_root = nearer_root(s.skeleton, size_of(rest));
    }
  }

  std::vector<int> triads(const Shown& s, bool first) const {
    if (o_.frames.empty()) return main_frames(*s.program, s.skeleton);
    std::vector<int> result;
    for (const std::string& name : o_.frames) {
      if (name == "all" && !s.program->frame_index.contains("all"))
        for (std::size_t f = 0; f < s.program->frames.size(); ++f)
          result.push_back(static_cast<int>(f));
      else if (first || s.program->frame_index.contains(name))
        result.push_back(s.program->frame(name, {"--frames " + name, 0, 0}));
    }
    return result;
  }

  // Puts the linkage and its ghosts where the held frame stands still: a ghost by its frame of the
  // same name, or else by its root.
  void set(std::size_t pose) {
    for (Shown& s : shown_) {
      s.set(pose);
      s.options.placement = shown_[0].options.placement;
      if (o_.hold.empty()) continue;
      const bool first = &s == &shown_[0];
      if (first || s.program->frame_index.contains(o_.hold))
        s.options.placement =
            s.posture.frame(s.program->frame(o_.hold, {"--hold " + o_.hold, 0, 0})).inverse();
    }
  }

  std::vector<CaptionLine> caption(std::size_t pose) const {
    const Program& program = *shown_[0].program;
    std::vector<CaptionLine> lines;
    if (!program.name.empty()) lines.push_back({program.name, true});
    std::string text = pose < o_.titles.size() ? o_.titles[pose] + ": " : "";
    text += coordinates_text(program, shown_[0].settings->poses[pose]);
    if (!text.empty()) lines.push_back({text});
    for (std::size_t i = 1; i < shown_.size(); ++i)
      lines.push_back({shown_[i].label, false, shown_[i].options.ghost});
    return wrap(lines, page_);
  }

  const DrawOptions& o_;
  Page page_;
  std::vector<Shown> shown_;
};

}  // namespace

std::vector<Picture> draw(const DrawnLinkage& linkage, const std::vector<DrawnLinkage>& ghosts,
                          const DrawOptions& options) {
  return Drawing(linkage, ghosts, options).run();
}

}  // namespace talus
