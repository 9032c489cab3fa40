#include "framework/report/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "framework/kinematics/pose_values.h"

namespace talus {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// A frame to be shown, and what its columns' names begin with.
struct Shown {
  std::string prefix;
  Rigid<Expr> transform;
};

// "E" of the columns E.x, E.y, ...
std::string prefix_of(const Program& program, const Feature& feature) {
  if (feature.columns.empty()) return feature.name;
  const std::string& column = program.columns[feature.columns[0]].name;
  return column.substr(0, column.rfind('.'));
}

std::vector<Shown> shown_frames(const Program& program, const std::vector<FramePair>& wanted) {
  std::vector<Shown> list;
  std::set<std::string> taken, measured;
  std::set<std::array<std::string, 2>> done;
  for (const Feature& f : program.features) measured.insert(prefix_of(program, f));
  auto add = [&](std::string prefix, const std::string& in, Rigid<Expr> transform, bool measures) {
    if (taken.contains(prefix) || (!measures && measured.contains(prefix))) prefix += "_in_" + in;
    if (taken.insert(prefix).second) list.push_back({prefix, std::move(transform)});
  };
  // A frame as it is measured has the name of its columns.
  auto measuring = [&](const std::string& of, const std::string& in) {
    for (const Feature& f : program.features)
      if (f.kind == Kind::frame &&
          program.frame_index.at(program.chains[f.chain].at) == program.frame_index.at(of) &&
          program.chains[f.chain].in == program.frames[program.frame_index.at(in)].name)
        return &f;
    return static_cast<const Feature*>(nullptr);
  };
  for (const FramePair& pair : wanted) {
    const Feature* f = measuring(pair.of, pair.in);
    add(f ? prefix_of(program, *f) : pair.of, pair.in,
        program.between(program.frame(pair.in, pair.place), program.frame(pair.of, pair.place)),
        f != nullptr);
  }
  if (!wanted.empty()) return list;
  for (const Feature& f : program.features) {
    const Chain& chain = program.chains[f.chain];
    if (f.kind == Kind::frame || f.kind == Kind::point)
      add(prefix_of(program, f), chain.in, chain.motions, true);
    else if (!measuring(chain.at, chain.in) && done.insert(chain.key()).second)
      add(chain.at, chain.in,
          program.between(program.frame(chain.in, f.place), program.frame(chain.at, f.place)),
          false);
  }
  if (list.empty())
    add(program.frames.back().name, program.frames[0].name,
        program.between(0, static_cast<int>(program.frames.size()) - 1), true);
  return list;
}

// The points of a limb, as their columns are named.
std::array<std::string, 12> point_names() {
  return {"v1", "v2", "v3", "v4", "v5", "v6", "v7", "v8", "centre", "end_x", "end_y", "end_z"};
}

class Table {
 public:
  explicit Table(const Program& program) : program_(program) {}
  bool has(const std::string& name) const { return table_.find(name); }
  void add(const std::string& name, Dimension dimension) {
    Unit unit = program_.units.of(dimension);
    if (dimension == number) unit.text.clear();  // no bracket in the header
    table_.columns.push_back({name, unit, {}, {}});
  }
  void put(double value) { table_.columns[next_++].values.push_back(value); }
  void end_row() {
    next_ = 0;
    table_.lines.push_back(static_cast<int>(table_.lines.size()) + 2);
  }
  Recordings take() { return std::move(table_); }

 private:
  const Program& program_;
  Recordings table_;
  std::size_t next_ = 0;
};

}  // namespace

FramePair parse_frame_pair(const std::string& text, const Program& program, const Place& place) {
  const std::size_t in = text.find(" in ");
  FramePair pair{trimmed(text.substr(0, in)), program.frames[0].name, place};
  if (in != std::string::npos) pair.in = trimmed(text.substr(in + 4));
  program.frame(pair.of, place);
  program.frame(pair.in, place);
  return pair;
}

NamedAngles parse_named_angles(const std::string& text, const Place& place) {
  std::vector<std::string> names;
  std::string axes;
  if (text.find('=') == std::string::npos) {
    const NamedAngles short_form{parse_axis_sequence(trimmed(text), place), {}};
    NamedAngles result = short_form;
    for (int n = 0; n < 3; ++n) {
      const char axis = static_cast<char>('x' + result.sequence.axes[n]);
      const bool twice = result.sequence.axes[0] == result.sequence.axes[2] && n != 1;
      result.names[n] = fmt::format("r{}{}", axis, twice ? n == 0 ? "1" : "2" : "");
    }
    return result;
  }
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, comma - at);
    const std::size_t equals = part.find('=');
    const std::string name = trimmed(part.substr(0, equals));
    const std::string axis = equals == std::string::npos ? "" : trimmed(part.substr(equals + 1));
    if (name.empty() || axis.size() != 1 || name.find_first_of("[]#\"") != std::string::npos)
      throw InputError(place, fmt::format("'{}'", trimmed(part)),
                       "NAME=x, NAME=y or NAME=z, as in \"flexion=z, internal=x, inversion=y\"");
    if (name == "x" || name == "y" || name == "z" || name == "qw" || name == "qx" || name == "qy" ||
        name == "qz")
      throw InputError(place,
                       fmt::format("'{}' is the name of a position's or quaternion's column", name),
                       "another name for this angle");
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw InputError(place, fmt::format("the name '{}' twice", name), "three different names");
    names.push_back(name);
    axes += axis;
    at = comma + 1;
  }
  const NamedAngles result{parse_axis_sequence(axes, place), {names[0], names[1], names[2]}};
  return result;
}

Recordings motion_table(const Program& program, const Settings& settings,
                        const MotionOptions& options, const Recordings* from) {
  const std::vector<Coordinate> list = coordinates(program);
  const std::vector<Shown> frames = shown_frames(program, options.frames);
  Table table(program);
  // What is taken over from the recordings.
  std::vector<const RecordedColumn*> kept;
  auto keep = [&](const std::string& name) {
    const RecordedColumn* column = from ? from->find(name) : nullptr;
    if (!column || table.has(name)) return;
    table.add(name, column->unit.dimension);
    kept.push_back(column);
  };
  keep("pose");
  const bool counted = kept.empty();
  if (counted) table.add("pose", number);
  keep("time");
  for (const Unknown& u : program.unknowns)
    for (const std::string& name : u.per) keep(name);
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!table.has(list[i].column)) {
      table.add(list[i].column, list[i].dimension);
      moving.push_back(i);
    }
  std::vector<PoseValues> poses;
  for (const Shown& f : frames) {
    for (const char* axis : {".x", ".y", ".z"}) table.add(f.prefix + axis, length);
    if (options.angles)
      for (const std::string& name : options.angles->names) table.add(f.prefix + "." + name, angle);
    else
      for (const char* part : {".qw", ".qx", ".qy", ".qz"}) table.add(f.prefix + part, number);
    poses.emplace_back(program, f.transform);
  }
  std::vector<PoseValues> bodies;
  if (options.limbs)
    for (const Limb& limb : program.limbs) {
      for (const std::string& point : point_names())
        for (const char* axis : {".x", ".y", ".z"})
          table.add(limb.name + "." + point + axis, length);
      bodies.emplace_back(program, program.between(0, limb.frame));
    }
  for (std::size_t k = 0; k < settings.poses.size(); ++k) {
    if (counted) table.put(static_cast<double>(k + 1));
    for (const RecordedColumn* column : kept) table.put(column->values[k]);
    for (std::size_t i : moving) table.put(settings.poses[k][i]);
    const std::vector<double> slots = slots_at(program, settings.poses[k]);
    for (PoseValues& values : poses) {
      const PlainPose pose = values(slots);
      for (double v : pose.translation) table.put(v);
      if (options.angles) {
        Eigen::Matrix3d R;
        for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = pose.rotation[i / 3][i % 3];
        for (double v : angles_of(R, options.angles->sequence)) table.put(v);
      } else {
        for (double v : quaternion(pose.rotation)) table.put(v);
      }
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const PlainPose pose = bodies[b](slots);
      const LimbPoints local = points(program.limbs[b]);
      for (int n = 0; n < local.cols(); ++n)
        for (int i = 0; i < 3; ++i) {
          double v = pose.translation[i];
          for (int j = 0; j < 3; ++j) v += pose.rotation[i][j] * local(j, n);
          table.put(v);
        }
    }
    table.end_row();
  }
  return table.take();
}

}  // namespace talus
