#include "framework/diagnosis/blind_spots.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/calibration/load_columns.h"
#include "framework/diagnosis/tails.h"
#include "framework/kinematics/tape_values.h"

namespace talus {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kShortArc = 120 * deg;  // less of a turn hides what repeats once a turn
constexpr double kBlind = 0.1;           // share of a signal left by the geometry: as good as none
constexpr std::size_t kNamed = 4;        // examples in a sentence

// What the geometry leaves of a signal.
struct Left {
  double share = 0;     // of its size
  double smallest = 0;  // multiple of the signal that would be seen
};

class Blind {
 public:
  Blind(const Seen& seen, const Program& program, const Linearised& null,
        const Recordings& recordings, double log_threshold, double noise)
      : seen_(seen),
        program_(program),
        null_(null),
        recordings_(recordings),
        threshold_(log_threshold),
        noise_(noise) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(null.baseline.columns);
    Q_ = qr.householderQ() * MatrixXd::Identity(null.baseline.columns.rows(), qr.rank());
    pose_.assign(null.baseline.pose.begin(), null.baseline.pose.begin() + null.columns.rows());
  }

  std::vector<BlindSpot> run() {
    return {{"scale", scale()},
            {"short arc", short_arcs()},
            {"rotor", rotor()},
            {"constant", constant()},
            {"twins", twins()}};
  }

 private:
  Left left_of(const MatrixXd& signal) const {
    MatrixXd whole = MatrixXd::Zero(Q_.rows(), signal.cols());
    whole.topRows(signal.rows()) = signal;
    whole -= Q_ * (Q_.transpose() * whole).eval();
    const double all = signal.squaredNorm(), rest = whole.squaredNorm();
    if (!(all > 0)) return {0, INFINITY};
    const double freedom = static_cast<double>(signal.cols());
    return {std::sqrt(rest / all), rest > 1e-12 * all
                                       ? std::sqrt(needed_noncentrality(threshold_, freedom, 0.8) *
                                                   noise_ / (rest / freedom))
                                       : INFINITY};
  }

  VectorXd field(const EffectPlace& place, int part) const {
    return null_.columns.col(place.first_field + part);
  }

  // Of each row the value at its pose.
  VectorXd at_rows(const VectorXd& of_poses) const {
    VectorXd rows(static_cast<Eigen::Index>(pose_.size()));
    for (std::size_t r = 0; r < pose_.size(); ++r)
      rows[static_cast<Eigen::Index>(r)] = of_poses[pose_[r]];
    return rows;
  }

  VectorXd values(const Expr& e) const {
    VectorXd v = VectorXd::Zero(static_cast<Eigen::Index>(null_.slots.size()));
    if (e.is_constant()) return v;
    TapeValues tape(*null_.program->tape, {e.node()});
    for (std::size_t k = 0; k < null_.slots.size(); ++k) {
      const double value = tape(null_.slots[k])[0];
      v[static_cast<Eigen::Index>(k)] = std::isfinite(value) ? value : 0;
    }
    return v;
  }

  std::string in_units(double value, Dimension dimension) const {
    const Unit unit = program_.units.of(dimension);
    return fmt::format("{:.2g} {}", value / unit.factor, unit.text);
  }

  std::string scale() const {
    MatrixXd signal = MatrixXd::Zero(null_.columns.rows(), 1);
    double parts = 0;
    for (const EffectPlace& place : null_.program->places)
      if (place.acts == Acts::measured)
        for (const int axis : {0, 4, 8}) {
          signal += field(place, axis);
          parts += field(place, axis).squaredNorm();
        }
    if (signal.squaredNorm() <= 1e-20 * parts)  // directions only: the three cancel
      return "A common scale error of the measurement and a common factor of all lengths are the "
             "same thing; here no lengths are measured that could be scaled.";
    const Left left = left_of(signal);
    std::string text =
        "A common scale error of the measured coordinates and a common factor of all lengths are "
        "the same thing";
    text += left.share < kBlind
                ? fmt::format(": the calibrated geometry takes up {} of it",
                              left.share < 0.02
                                  ? "all"
                                  : fmt::format("{:.1f} %", 100 * (1 - left.share * left.share)))
                : fmt::format(", but for lengths that the model holds: they leave {:.2g} % of it",
                              100 * left.share * left.share);
    if (left.smallest < 0.1)
      text += fmt::format("; below {:.2g} ppm it is not seen", left.smallest * 1e6);
    return text + ". An artefact of known length would tell.";
  }

  std::string short_arcs() const {
    struct Arc {
      std::string joint;
      double travel, smallest;
    };
    std::vector<Arc> arcs;
    std::size_t joints = 0;
    for (const EffectPlace& place : null_.program->places) {
      if (place.acts != Acts::coordinate || !(place.dimension == angle)) continue;
      const VectorXd q = values(place.around.coordinate);
      ++joints;
      const double travel = q.size() > 0 ? q.maxCoeff() - q.minCoeff() : 0;
      if (travel >= kShortArc) continue;
      MatrixXd signal(null_.columns.rows(), 2);
      const VectorXd u = field(place, 0), rows = at_rows(q);
      signal << u.cwiseProduct(rows.array().sin().matrix()),
          u.cwiseProduct(rows.array().cos().matrix());
      arcs.push_back({place.joint, travel, left_of(signal).smallest});
    }
    const std::string head =
        "An error that repeats once per turn looks like a zero, a gain or neighbouring geometry "
        "where a joint turns little.";
    if (joints == 0) return head + " No joint turns here.";
    if (arcs.empty())
      return head +
             fmt::format(" All {} joints turn {:.0f} deg or more here.", joints, kShortArc / deg);
    std::stable_sort(arcs.begin(), arcs.end(),
                     [](const Arc& a, const Arc& b) { return a.smallest > b.smallest; });
    std::vector<std::string> words;
    for (const Arc& a : arcs) {
      if (words.size() == 6) break;
      words.push_back(fmt::format(
          "{} turns {:.0f} deg ({})", a.joint, a.travel / deg,
          a.smallest < 180 * deg ? "unseen below " + in_units(a.smallest, angle) : "unseen"));
    }
    return head + " Here " + join(words) + (arcs.size() > words.size() ? ", and others" : "") + ".";
  }

  std::string rotor() const {
    std::vector<std::string> taken, shown;
    double least = 1;
    for (const EffectPlace& place : null_.program->places) {
      if (place.acts != Acts::axis || !(place.dimension == angle)) continue;
      const VectorXd q = at_rows(values(place.around.coordinate));
      const VectorXd c = q.array().cos(), s = q.array().sin();
      double share = 0;
      for (const int part : {0, 3}) {
        const VectorXd x = field(place, part), y = field(place, part + 1);
        MatrixXd signal(null_.columns.rows(), 2);
        signal << x.cwiseProduct(c) + y.cwiseProduct(s), y.cwiseProduct(c) - x.cwiseProduct(s);
        share = std::max(share, std::pow(left_of(signal).share, 2));
      }
      if (share < kBlind) {
        taken.push_back(place.joint);
        least = std::min(least, 1 - share);
      } else {
        shown.push_back(place.joint);
      }
    }
    std::string text =
        "An error motion that goes round with its joint, once per turn, is a displaced or tilted "
        "axis, that is geometry";
    if (!taken.empty())
      text += fmt::format(": the calibration takes up {} of it at {}",
                          least > 0.9995 ? "all" : fmt::format("{:.1f} % or more", 100 * least),
                          join(taken));
    if (!shown.empty())
      text += fmt::format("{} at {} geometry that the model holds lets some of it be seen",
                          taken.empty() ? ", but" : ";", join(shown));
    return text + ". Only what goes round the other way, or faster, can be told from it.";
  }

  bool varies(const RecordedColumn& c) const {
    std::set<double> seen;
    for (const std::size_t row : null_.rows)
      if (!std::isnan(c.values[row])) seen.insert(c.values[row]);
    return seen.size() > 1;
  }

  // Were there several mountings? An empty cell is the model's.
  bool turned() const {
    std::set<std::array<double, 3>> seen;
    for (const std::size_t row : null_.rows) {
      std::array<double, 3> down = program_.gravity->direction;
      for (std::size_t i = 0; i < 3; ++i)
        if (const RecordedColumn* c = recordings_.find(gravity_columns[i]);
            c && !std::isnan(c->values[row]))
          down[i] = c->values[row];
      seen.insert(down);
    }
    return seen.size() > 1;
  }

  std::string constant() const {
    std::string text =
        "What never varies has no signature: a constant error of a reading is its zero, one of a "
        "pose is a mount.";
    std::vector<std::string> still;
    for (const RecordedColumn& c : recordings_.columns) {
      const bool circumstance = c.name == "temperature" || c.name == "time" ||
                                c.name == "session" || c.name.starts_with("approach_") ||
                                std::any_of(program_.payloads.begin(), program_.payloads.end(),
                                            [&](const Payload& p) { return p.column == c.name; });
      if (circumstance && !varies(c)) still.push_back(c.name);
    }
    if (!still.empty()) text += " Recorded, but always the same: " + join(still) + ".";
    std::map<std::string, std::set<std::string>> lacking;
    for (const Untestable& u : seen_.untestable)
      if (u.effect != "unknown") lacking[u.lacks].insert(spoken(u.effect));
    std::vector<std::string> words;
    for (const auto& [covariate, effects] : lacking)
      words.push_back(fmt::format("{} ({})", covariate,
                                  join(std::vector<std::string>(effects.begin(), effects.end()))));
    if (!words.empty())
      text += " Not known here, so that these could not be tested: " + join(words, "; ") + ".";
    if (std::none_of(recordings_.columns.begin(), recordings_.columns.end(),
                     [](const RecordedColumn& c) { return c.name.starts_with("approach_"); }))
      text +=
          " The sense in which joints were moved (approach) was not recorded, so that play shows "
          "at most where loads close it.";
    if (program_.gravity && !turned())
      text += " Gravity has one direction in the recordings: loads vary by posture" +
              std::string(program_.payloads.empty() ? "" : " and payload") + " only.";
    return text;
  }

  std::string twins() const {
    auto name = [&](int i) {
      const SeenSuspect& s = seen_.suspects[static_cast<std::size_t>(i)];
      return spoken(s.effect) + " at " + s.location;
    };
    if (!seen_.twins.empty()) {
      std::vector<std::string> words;
      for (const std::vector<int>& group : seen_.twins) {
        if (words.size() == kNamed) break;
        std::vector<std::string> members;
        for (const int i : group)
          if (members.size() < kNamed) members.push_back(name(i));
        words.push_back(join(members, " = ") + (group.size() > kNamed ? " = ..." : ""));
      }
      return "Twins, which these poses cannot tell apart whatever their size: " +
             join(words, "; ") +
             (seen_.twins.size() > words.size()
                  ? fmt::format("; and {} more groups", seen_.twins.size() - words.size())
                  : "") +
             ".";
    }
    int closest = -1;
    for (std::size_t i = 0; i < seen_.suspects.size(); ++i) {
      const SeenSuspect& s = seen_.suspects[i];
      if (s.unknown() || s.rival.empty() || s.rival == "unknown") continue;
      if (closest < 0 || s.imitates > seen_.suspects[static_cast<std::size_t>(closest)].imitates)
        closest = static_cast<int>(i);
    }
    if (closest < 0) return "Twins: no two effects share a signature here.";
    const SeenSuspect& s = seen_.suspects[static_cast<std::size_t>(closest)];
    return fmt::format(
        "Twins: no two effects that would be seen share their signature entirely; nearest is {}, "
        "{:.3g} % of which {} at {} imitates.",
        name(closest), 100 * s.imitates, spoken(s.rival), s.rival_location);
  }

  const Seen& seen_;
  const Program& program_;
  const Linearised& null_;
  const Recordings& recordings_;
  double threshold_, noise_;
  MatrixXd Q_;
  std::vector<int> pose_;
};

}  // namespace

std::string spoken(std::string id) {
  std::replace(id.begin(), id.end(), '_', ' ');
  return id;
}

std::vector<BlindSpot> blind_spots(const Seen& seen, const Program& program, const Linearised& null,
                                   const Recordings& recordings, double log_threshold,
                                   double noise) {
  return Blind(seen, program, null, recordings, log_threshold, noise).run();
}

}  // namespace talus
