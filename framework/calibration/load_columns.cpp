#include "framework/calibration/load_columns.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/kinematics/covariates.h"

namespace talus {
namespace {

constexpr const char* prefix = "load:";
constexpr const char* components[] = {"x", "y", "z"};

// By frame: its motion depends on an unknown, one of each pose or a shared one.
std::vector<bool> unknown_motions(const Program& program) {
  std::set<int> unknown;
  for (const Unknown& u : program.unknowns) unknown.insert(u.slot);
  auto depends = [&](const Expr& e) {
    const auto slots = support(e);
    return std::any_of(slots.begin(), slots.end(), [&](int s) { return unknown.contains(s); });
  };
  std::vector<bool> result;
  for (const Frame& frame : program.frames) {
    const auto& motions = frame.motion.motions();
    result.push_back(std::any_of(motions.begin(), motions.end(), [&](const Motion<Expr>& m) {
      bool any = depends(m.amount);
      for (int i = 0; i < 3; ++i) {
        any = any || depends(m.translation[i]);
        for (int j = 0; j < 3; ++j) any = any || depends(m.rotation[i][j]);
      }
      return any;
    }));
  }
  return result;
}

// A column of the recordings, or one value in all rows.
struct Source {
  const RecordedColumn* column = nullptr;
  double otherwise = 0;
  double operator[](std::size_t row) const { return column ? column->values[row] : otherwise; }
};

struct Sources {
  std::vector<Source> coordinates, payloads, gravity;

  Sources(const Program& program, const Recordings& recordings) {
    for (const Reading& r : program.readings) {
      const bool recorded = recordings.find(r.column);
      coordinates.push_back({recorded ? &recordings.get(r.column, r.dimension) : nullptr,
                             r.covariate ? usual_value(r.column) : std::nan("")});
    }
    for (const Unknown& u : program.unknowns) coordinates.push_back({nullptr, u.start.value});
    for (const Payload& p : program.payloads) {
      const bool recorded = !p.column.empty() && recordings.find(p.column);
      payloads.push_back({recorded ? &recordings.get(p.column, mass) : nullptr, p.mass});
    }
    if (std::any_of(gravity_columns.begin(), gravity_columns.end(),
                    [&](const char* name) { return recordings.find(name); }))
      for (const char* name : gravity_columns)
        gravity.push_back({&recordings.get(name, number), 0});
  }

  // Where the row says nothing, gravity is the model's.
  Eigen::Vector3d down(const Program& program, const Recordings& recordings,
                       std::size_t row) const {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) v[i] = gravity[i][row];
    if (v.array().isNaN().all()) {
      const auto& d = program.gravity->direction;
      return {d[0], d[1], d[2]};
    }
    if (v.norm() == 0)
      throw InputError(
          {recordings.file, recordings.lines[row], 0}, "gravity has no direction",
          "components of a vector that points down, or empty cells: as the model says");
    return v;
  }
};

template <class Use>
void for_each_row(const Program& program, const Recordings& recordings,
                  std::span<const double> parameters, const Use& use) {
  const Sources sources(program, recordings);
  Loads loads(program);
  std::vector<double> coordinates(sources.coordinates.size()), payloads(sources.payloads.size());
  for (std::size_t row = 0; row < recordings.rows(); ++row) {
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      coordinates[i] = sources.coordinates[i][row];
    for (std::size_t i = 0; i < payloads.size(); ++i) payloads[i] = sources.payloads[i][row];
    if (!sources.gravity.empty()) loads.turn(sources.down(program, recordings, row));
    loads.set(coordinates, parameters, payloads);
    use(row, loads);
  }
}

// A vector of a load, in the columns <name>x, <name>y, <name>z.
struct Part {
  const char *name, *unit;
  const Eigen::Vector3d& (*of)(const LinkLoad&);
};

const Eigen::Vector3d& axis_force(const LinkLoad& l) { return l.axis.force; }
const Eigen::Vector3d& axis_moment(const LinkLoad& l) { return l.axis.moment; }
const Eigen::Vector3d& tip_force(const LinkLoad& l) { return l.tip.force; }
const Eigen::Vector3d& tip_moment(const LinkLoad& l) { return l.tip.moment; }
const Eigen::Vector3d& weight(const LinkLoad& l) { return l.weight; }
const Eigen::Vector3d& own_moment(const LinkLoad& l) { return l.own_moment; }
const Eigen::Vector3d& link_span(const LinkLoad& l) { return l.span; }

constexpr std::array<Part, 7> parts{{{"f", "N", axis_force},
                                     {"m", "N*mm", axis_moment},
                                     {"tip_f", "N", tip_force},
                                     {"tip_m", "N*mm", tip_moment},
                                     {"weight_", "N", weight},
                                     {"own_m", "N*mm", own_moment},
                                     {"span_", "mm", link_span}}};

}  // namespace

bool has_loads(const Program& program) {
  return program.gravity && !(program.links.empty() && program.payloads.empty());
}

std::vector<int> loaded_frames(const Program& program) {
  if (!has_loads(program)) return {};
  const int n = static_cast<int>(program.frames.size());
  const std::vector<bool> unknown = unknown_motions(program);
  const bool any = std::any_of(unknown.begin(), unknown.end(), [](bool u) { return u; });
  std::vector<bool> heavy(n), reaches(n);  // it or a frame beyond it has weight; unknown on the way
  for (const Link& link : program.links) heavy[link.frame] = true;
  for (const Payload& payload : program.payloads) heavy[payload.frame] = true;
  for (int f = n; f-- > 1;) {
    const int parent = program.frames[f].parent;
    if (heavy[f]) heavy[parent] = true;
    if (heavy[f] && (unknown[f] || reaches[f])) reaches[parent] = true;
  }
  auto above = [&](int f) {  // frames from f up to the root
    std::vector<int> path;
    for (; f >= 0; f = program.frames[f].parent) path.push_back(f);
    return path;
  };
  const std::vector<int> to_gravity = above(program.gravity->frame);
  std::vector<int> result;
  for (int f = 1; f < n; ++f) {
    bool blurred = reaches[f] || (any && program.gravity->held_at >= 0);
    // Between the frame in which gravity is given and this one.
    std::vector<int> path = above(f);
    const std::set<int> here(path.begin(), path.end()), there(to_gravity.begin(), to_gravity.end());
    for (int g = 1; g < n; ++g)
      blurred = blurred || (unknown[g] && here.contains(g) != there.contains(g));
    blurred = blurred || unknown[f];
    if (!blurred) result.push_back(f);
  }
  return result;
}

std::vector<std::string> missing_payloads(const Program& program, const Recordings& recordings) {
  std::vector<std::string> result;
  for (const Payload& p : program.payloads)
    if (!p.column.empty() && !recordings.find(p.column)) result.push_back(p.column);
  return result;
}

std::vector<std::vector<LinkLoad>> recorded_loads(const Program& program,
                                                  const Recordings& recordings,
                                                  std::span<const double> parameters) {
  std::vector<std::vector<LinkLoad>> result;
  for_each_row(program, recordings, parameters,
               [&](std::size_t, const Loads& loads) { result.push_back(loads.links()); });
  return result;
}

Recordings with_loads(const Program& program, const Recordings& recordings,
                      std::span<const double> parameters) {
  const std::vector<int> frames = loaded_frames(program);
  if (frames.empty()) return recordings;
  Recordings result = recordings;
  std::erase_if(result.columns, [](const RecordedColumn& c) { return c.name.starts_with(prefix); });
  const std::size_t first = result.columns.size();
  for (const int f : frames)
    for (const Part& part : parts)
      for (const char* component : components)
        result.columns.push_back({prefix + program.frames[f].name + "." + part.name + component,
                                  *parse_unit(part.unit), std::vector<double>(recordings.rows()),
                                  Place{recordings.file}});
  for_each_row(program, recordings, parameters, [&](std::size_t row, const Loads& loads) {
    std::size_t column = first;
    for (const int f : frames)
      for (const Part& part : parts)
        for (int i = 0; i < 3; ++i)
          result.columns[column++].values[row] = part.of(loads.link(f))[i];
  });
  return result;
}

}  // namespace talus
