#include "framework/diagnosis/shown.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class Shower {
 public:
  Shower(const Accepted& effect, const UnitSystem& units)
      : e_(effect), d_(effect.suspect.plugin->declaration), units_(units) {}

  std::vector<ShownValue> run() {
    std::vector<std::string> done;
    for (const Figure& f : d_.effect.figures) {
      if (!std::all_of(f.amounts.begin(), f.amounts.end(), [&](auto& a) { return index(a) >= 0; }))
        continue;
      figure(f);
      done.insert(done.end(), f.amounts.begin(), f.amounts.end());
    }
    for (const std::string& a : e_.way.amounts)
      if (std::find(done.begin(), done.end(), a) == done.end())
        add(a, unit(a), e_.amounts[index(a)], e_.std[index(a)]);
    for (const auto& [name, value] : e_.way.settings) {
      const Input& i = *d_.find_input(name);
      add(name, units_.of(i.relative ? i.dimension * e_.suspect.dimension : i.dimension), value,
          kNone);
    }
    return std::move(out_);
  }

 private:
  int index(const std::string& amount) const {
    const auto at = std::find(e_.way.amounts.begin(), e_.way.amounts.end(), amount);
    return at == e_.way.amounts.end() ? -1 : static_cast<int>(at - e_.way.amounts.begin());
  }

  Unit unit(const std::string& amount) const {
    const Input& i = *d_.find_input(amount);
    return units_.of(i.relative ? i.dimension * e_.suspect.dimension : i.dimension);
  }

  void add(const std::string& name, const Unit& unit, double value, double std) {
    out_.push_back({name, unit.text, value / unit.factor, std / unit.factor});
  }

  // The first of the units, parted by '|', that fits the amount.
  Unit chosen(const Figure& f) const {
    const Unit own = unit(f.amounts[0]);
    for (std::size_t start = 0; start < f.unit.size();) {
      const std::size_t end = std::min(f.unit.find('|', start), f.unit.size());
      if (auto u = parse_unit(f.unit.substr(start, end - start));
          u && u->dimension == own.dimension)
        return *u;
      start = end + 1;
    }
    return own;
  }

  void figure(const Figure& f) {
    std::vector<double> v, s;
    for (const std::string& a : f.amounts)
      v.push_back(e_.amounts[index(a)]), s.push_back(e_.std[index(a)]);
    const Unit u = chosen(f), degrees = *parse_unit("deg");
    if (f.kind == Figure::Kind::scaled) return add(f.name, u, v[0], s[0]);
    if (f.kind == Figure::Kind::ellipse) {
      Eigen::Matrix2d M;
      M << v[0], v[1], v[2], v[3];
      const Eigen::JacobiSVD<Eigen::Matrix2d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const double std = (s[0] + s[1] + s[2] + s[3]) / 4;
      double direction = std::atan2(svd.matrixU()(1, 0), svd.matrixU()(0, 0)),
             phase = std::atan2(svd.matrixV()(1, 0), svd.matrixV()(0, 0));
      if (direction < 0) direction += 180 * deg, phase += 180 * deg;
      if (phase < 0) phase += 360 * deg;
      const double amplitude = svd.singularValues()[0],
                   turn = amplitude > 0 ? std / amplitude : kNone;
      add(f.name, u, amplitude, std);
      add("minor", u, svd.singularValues()[1], std);
      add(f.second, degrees, std::fmod(phase, 360 * deg), turn);
      return add("direction", degrees, direction, turn);
    }
    double square = 0, weighted = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
      square += v[i] * v[i], weighted += v[i] * v[i] * s[i] * s[i];
    const double size = std::sqrt(square), std = size > 0 ? std::sqrt(weighted) / size : s[0];
    add(f.name, u, size, std);
    if (v.size() == 2 && !f.second.empty()) {
      double a = std::atan2(v[1], v[0]);
      if (a < 0) a += 360 * deg;
      add(f.second, degrees, a,
          size > 0 ? std::sqrt(v[1] * v[1] * s[0] * s[0] + v[0] * v[0] * s[1] * s[1]) / square
                   : kNone);
    } else if (v.size() == 3) {
      for (std::size_t i = 0; i < 3; ++i) add(f.amounts[i], unit(f.amounts[i]), v[i], s[i]);
    }
  }

  const Accepted& e_;
  const Declaration& d_;
  UnitSystem units_;
  std::vector<ShownValue> out_;
};

}  // namespace

std::vector<ShownValue> shown_values(const Accepted& effect, const UnitSystem& units) {
  return Shower(effect, units).run();
}

}  // namespace talus
