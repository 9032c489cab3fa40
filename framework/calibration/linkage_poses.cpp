#include "framework/calibration/linkage_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

const Feature& same_feature(const Program& linkage, const Feature& wanted) {
  std::vector<std::string> names;
  for (const Feature& f : linkage.features)
    if (f.kind == Kind::frame) {
      if (f.name == wanted.name) return f;
      names.push_back(f.name);
    }
  throw InputError({linkage.name, 0, 0},
                   fmt::format("the linkage measures no frame '{}'", wanted.name),
                   names.empty() ? "a <frame> of that name" : "one of: " + join(names),
                   nearest(wanted.name, names));
}

}  // namespace

LinkagePoses::LinkagePoses(const Program& linkage, const Feature& wanted)
    : linkage_(&linkage), columns_(wanted.columns), posture_(linkage) {
  const Feature& feature = same_feature(linkage, wanted);
  if (!linkage.unknowns.empty())
    throw InputError(linkage.unknowns[0].place,
                     fmt::format("the linkage has an unknown, '{}'", linkage.unknowns[0].name),
                     "a linkage whose readings alone give its pose");
  const Chain& chain = linkage.chains[feature.chain];
  in_ = linkage.frame(chain.in, feature.place), at_ = linkage.frame(chain.at, feature.place);
}

Eigen::Isometry3d LinkagePoses::operator()(std::span<const double> readings) {
  posture_.set(readings);
  return posture_.between(in_, at_);
}

Recordings LinkagePoses::measured(const Recordings& recordings, const Program& program) {
  std::vector<const std::vector<double>*> readings;
  for (const Reading& r : linkage_->readings)
    readings.push_back(&recordings.get(r.column, r.dimension).values);
  std::vector<Eigen::Isometry3d> poses;
  std::vector<double> at(readings.size());
  for (std::size_t k = 0; k < recordings.rows(); ++k) {
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = (*readings[i])[k];
    if (std::any_of(at.begin(), at.end(), [](double v) { return std::isnan(v); })) {
      Eigen::Isometry3d missing;
      missing.matrix().setConstant(std::nan(""));
      poses.push_back(missing);
    } else {
      poses.push_back((*this)(at));
    }
  }
  Recordings out = recordings;
  set_frame_columns(out, program, columns_, poses);
  return out;
}

void set_frame_columns(Recordings& recordings, const Program& program,
                       const std::vector<int>& columns,
                       const std::vector<Eigen::Isometry3d>& poses) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const MeasuredColumn& column = program.columns[columns[c]];
    std::erase_if(recordings.columns,
                  [&](const RecordedColumn& old) { return old.name == column.name; });
    std::vector<double> values;
    for (const Eigen::Isometry3d& T : poses) {
      if (!T.matrix().allFinite()) {
        values.push_back(std::nan(""));
      } else if (c < 3) {
        values.push_back(T.translation()[static_cast<Eigen::Index>(c)]);
      } else {
        const Eigen::Quaterniond q(T.linear());
        values.push_back(c == 3 ? q.w() : q.vec()[static_cast<Eigen::Index>(c) - 4]);
      }
    }
    Unit unit = program.units.of(column.dimension);
    if (column.dimension == number) unit.text.clear();
    recordings.columns.push_back({column.name, unit, std::move(values), {}});
  }
}

}  // namespace talus
