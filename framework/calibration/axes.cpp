#include "framework/calibration/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

const Feature* measured_frame(const Program& program, const std::string& name) {
  std::vector<std::string> names;
  const Feature* found = nullptr;
  for (const Feature& f : program.features)
    if (f.kind == Kind::frame) {
      names.push_back(f.name);
      if (f.name == name || (name.empty() && !found)) found = &f;
    }
  const Place place{program.name, 0, 0};
  if (names.empty())
    throw InputError(place, "the model measures no frame", "<frame> of the body that moves");
  if (!found)
    throw InputError({"--of " + name, 0, 0}, fmt::format("no measured frame '{}'", name),
                     "one of: " + join(names), nearest(name, names));
  if (name.empty() && names.size() > 1)
    throw InputError(place, "the model measures several frames: " + join(names), "--of NAME");
  return found;
}

// The frames from `at` up to `in`, the other way round.
std::vector<int> path(const Program& program, int in, int at) {
  std::vector<int> frames;
  for (int f = at; f >= 0 && f != in; f = program.frames[f].parent) frames.push_back(f);
  std::reverse(frames.begin(), frames.end());
  return frames;
}

}  // namespace

std::array<double, 4> coordinates_of(const Line& line, const View& view) {
  const Eigen::Isometry3d to_view = view.frame.inverse();
  const Eigen::Vector3d p = to_view * line.point;
  Eigen::Vector3d u = to_view.linear() * line.direction;
  const int m = view.main, a = m == 0 ? 1 : 0, b = m == 2 ? 1 : 2;
  if (u[m] < 0) u = -u;
  const Eigen::Vector3d pierced = p - p[m] / u[m] * u;
  return {pierced[a], pierced[b], std::atan2(u[a], u[m]), std::atan2(u[b], u[m])};
}

std::array<std::string, 4> AxisLabels::of(int main) const {
  const int a = main == 0 ? 1 : 0, b = main == 2 ? 1 : 2;
  return {along[a], along[b], about[b], about[a]};
}

AxisFinder::AxisFinder(const Program& program, const std::string& feature,
                       const std::vector<std::string>& reverse)
    : program_(&program), feature_(measured_frame(program, feature)), posture_(program) {
  for (const Unknown& u : program.unknowns)
    if (!u.per.empty())
      throw InputError(u.place, fmt::format("unknown '{}' is shared by groups of rows", u.name),
                       "axes are those of one motion: unknowns of each pose alone (per=\"pose\")");
  const Chain& chain = program.chains[feature_->chain];
  in_ = program.frame(chain.in, feature_->place), end_ = program.frame(chain.at, feature_->place);
  std::vector<int> way = path(program, in_, end_);
  if (in_ != 0 && (way.empty() || program.frames[way.front()].parent != in_))
    throw InputError(feature_->place, fmt::format("'{}' does not hang on '{}'", chain.at, chain.in),
                     "a chain from the frame `in` to the frame measured");
  std::vector<double> rest(program.readings.size() + program.unknowns.size(), 0);
  posture_.set(rest);  // which joints turn does not depend on where they are
  for (std::size_t k = 0; k < posture_.axes().size(); ++k) {
    const JointAxis& axis = posture_.axes()[k];
    if (!axis.turns || std::find(way.begin(), way.end(), axis.frame) == way.end()) continue;
    const auto readings = static_cast<int>(program.readings.size());
    Hinge h{axis.joint, axis.coordinate < readings
                            ? program.readings[axis.coordinate].sensor
                            : program.unknowns[axis.coordinate - readings].name};
    h.axis = static_cast<int>(k), h.number = axis.coordinate;
    hinges_.push_back(std::move(h));
  }
  if (hinges_.empty())
    throw InputError(feature_->place,
                     fmt::format("no hinge moves between '{}' and '{}'", chain.in, chain.at),
                     "joints that turn, moved by an <unknown> per pose or by a sensor");
  for (std::size_t k = 0; k < hinges_.size(); ++k) {
    Hinge& h = hinges_[k];
    const bool first = k == 0, last = k + 1 == hinges_.size();
    h.body = last && !first ? end_ : in_;
    h.still = first || last;
    // A joint that turns about several axes: told apart by what moves them.
    if (std::count_if(hinges_.begin(), hinges_.end(), [&](const Hinge& o) {
          return posture_.axes()[o.axis].joint == posture_.axes()[h.axis].joint;
        }) > 1)
      h.name += "." + h.coordinate;
  }
  for (const std::string& name : reverse)
    hinges_[hinge(name, {"--reverse " + name, 0, 0})].sense *= -1;
}

int AxisFinder::hinge(const std::string& name, const Place& place) const {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < hinges_.size(); ++k) {
    if (hinges_[k].name == name || hinges_[k].coordinate == name) return static_cast<int>(k);
    names.push_back(hinges_[k].name);
  }
  throw InputError(place, fmt::format("no hinge '{}'", name), "one of: " + join(names),
                   nearest(name, names));
}

std::vector<Line> AxisFinder::lines(std::span<const double> parameters) {
  posture_.set(std::vector<double>(program_->readings.size() + program_->unknowns.size(), 0),
               parameters);
  const std::vector<JointAxis>& axes = posture_.axes();
  std::vector<Line> lines;
  for (const Hinge& h : hinges_) {
    const Eigen::Isometry3d to_body = posture_.frame(h.body).inverse();
    lines.push_back(
        {to_body * axes[h.axis].point, h.sense * (to_body.linear() * axes[h.axis].direction)});
  }
  return lines;
}

Located AxisFinder::locate(const Recordings& recordings, const std::vector<std::size_t>& rows,
                           const LocateOptions& options) {
  Split split;
  split.fit = rows;
  Located result;
  result.fit = calibrate(*program_, recordings, split, options.fit);
  const Fit& fit = result.fit;
  result.covariance = covariance(*program_, recordings, split, fit);
  // Where the stated noise explains the residuals it says more than their spread does.
  result.observed = options.observed || !fit.noise_known || fit.chi2_p < 1e-3;
  const auto poses = static_cast<Eigen::Index>(rows.size());
  result.coordinates.resize(poses, static_cast<Eigen::Index>(hinges_.size()));
  const std::size_t readings = program_->readings.size();
  std::vector<double> slots(program_->slots, 0);
  for (std::size_t i = 0; i < program_->parameters.size(); ++i)
    slots[program_->parameters[i].slot] = fit.x[i];
  const std::vector<Line> found = lines(fit.x);
  for (std::size_t k = 0; k < hinges_.size(); ++k) {
    const Hinge& h = hinges_[k];
    LocatedAxis axis{found[k]};
    const bool read = h.number < static_cast<int>(readings);
    auto column = result.coordinates.col(static_cast<Eigen::Index>(k));
    if (read) {
      const Reading& r = program_->readings[h.number];
      const auto& values = recordings.get(r.column, r.dimension).values;
      for (Eigen::Index i = 0; i < poses; ++i) {
        slots[r.slot] = values[rows[i]];
        column[i] = r.value.is_constant() ? r.value.constant()
                                          : program_->tape->evaluate(r.value.node(), slots);
      }
      axis.noise = r.sigma;
    } else {
      column = fit.residuals_fit.latent.col(h.number - static_cast<int>(readings));
      axis.noise = result.covariance.latent_std[h.number - readings];
    }
    axis.low = column.minCoeff(), axis.high = column.maxCoeff();
    result.axes.push_back(axis);
  }
  return result;
}

std::vector<double> AxisFinder::pose(const Recordings& recordings,
                                     const std::vector<std::size_t>& rows, const Located& located,
                                     std::size_t k) const {
  std::vector<double> out;
  for (const Reading& r : program_->readings)
    out.push_back(recordings.get(r.column, r.dimension).values[rows[k]]);
  const auto latent = located.fit.residuals_fit.latent.row(static_cast<Eigen::Index>(k));
  out.insert(out.end(), latent.begin(), latent.end());
  return out;
}

}  // namespace talus
