#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/diagnosis/next_table.h"
#include "framework/diagnosis/next_targets.h"

namespace talus {
namespace {

constexpr std::size_t kPurposes = 2;

class Chooser {
 public:
  Chooser(const Diagnosis& diagnosis, const Seen& seen, const Pool& pool,
          const AdviceOptions& options, int count, int mounting = -1)
      : d_(diagnosis), pool_(pool), to_(diagnosis, seen, pool, mounting), choice_(to_.needed) {
    choice_.count = count;
    choice_.threads = options.threads;
    if (!to_.wanted.empty())
      chosen_ = next_poses(pool_.baseline, to_.candidates, to_.poses, to_.wanted, choice_);
  }

  // Targets that the chosen poses show or tell apart; the least share of what is needed, up to one.
  std::pair<int, double> reached() const {
    int count = 0;
    for (std::size_t t = 0; t < to_.wanted.size(); ++t) count += share(t) >= 1;
    return {count, std::min(1.0, chosen_.after)};
  }

  bool telling() const { return to_.telling; }

  // Targets that all poses of the pool together would show or tell.
  int attainable() const {
    return static_cast<int>(std::count_if(chosen_.targets.begin(), chosen_.targets.end(),
                                          [](const TargetGain& t) { return t.attainable; }));
  }

  // Is a target out of reach that other loads could change?
  bool wants_other_loads() const {
    for (std::size_t t = 0; t < to_.wanted.size(); ++t) {
      if (share(t) >= 1) continue;
      std::vector<int> forms = to_.wanted[t].rivals;
      forms.push_back(to_.wanted[t].form);
      for (const int f : forms)
        if (depends_on(to_.suspect(f).plugin->declaration.effect,
                       {Covariate::load, Covariate::tip_load}))
          return true;
    }
    return false;
  }

  NextRecordings run() {
    describe_coordinates();
    if (to_.wanted.empty()) {
      out_.statement = "No further poses are needed for the usual suspects that poses can show.";
      return std::move(out_);
    }
    out_.before = chosen_.before, out_.after = chosen_.after;
    for (std::size_t t = 0; t < to_.wanted.size(); ++t) gain(t, chosen_.targets[t]);
    for (std::size_t i = 0; i < chosen_.chosen.size(); ++i) add(i);
    statement();
    return std::move(out_);
  }

 private:
  void describe_coordinates() {
    out_.targets = to_.named;
    out_.loops = pool_.loops;
    for (std::size_t i = 0; i < pool_.coordinates.size(); ++i) {
      out_.names.push_back(pool_.coordinates[i].name);
      out_.dimensions.push_back(pool_.coordinates[i].dimension);
      out_.moves.push_back(pool_.coordinates[i].range.has_value());
      if (pool_.assumed[i]) out_.assumed.push_back(pool_.coordinates[i].name);
    }
  }

  // Of what is needed, how much the chosen poses give.
  double share(std::size_t t) const {
    const TargetGain& g = chosen_.targets[t];
    const double seen = g.seen_after / choice_.seen;
    return to_.wanted[t].rivals.empty() ? seen : std::min(seen, g.told_after / choice_.told);
  }

  // Joints whose sense of approach the targets or their rivals depend on.
  std::set<std::string> sides() const {
    std::set<std::string> result;
    for (std::size_t t = 0; t < to_.wanted.size(); ++t) {
      if (!chosen_.targets[t].attainable) continue;
      std::vector<int> forms = to_.wanted[t].rivals;
      forms.push_back(to_.wanted[t].form);
      for (const int f : forms)
        if (depends_on(to_.suspect(f).plugin->declaration.effect, {Covariate::approach}))
          result.insert(to_.suspect(f).joint);
    }
    return result;
  }

  void gain(std::size_t t, const TargetGain& g) {
    NextTarget& named = out_.targets[t];
    double size = 1;  // of the amounts that the chi-square belongs to, in typical ones
    if (to_.wanted[t].amounts.size() > 0) {
      double sum = 0;
      const Form& form = to_.candidates.forms[static_cast<std::size_t>(to_.wanted[t].form)];
      for (std::size_t a = 0; a < form.columns.size(); ++a)
        sum += std::pow(to_.wanted[t].amounts[static_cast<Eigen::Index>(a)] /
                            to_.candidates.typical[form.columns[a]],
                        2);
      size = std::sqrt(sum);
    }
    auto smallest = [&](double chi2) {
      return chi2 > 1e-6 ? named.typical * size * std::sqrt(choice_.seen / chi2) : INFINITY;
    };
    named.smallest_before = smallest(g.seen_before), named.smallest_after = smallest(g.seen_after);
    named.told_before = g.told_before, named.told_after = g.told_after;
    named.attainable = g.attainable;
  }

  // What is lost most without the pose is what it is for.
  void add(std::size_t nth) {
    std::vector<std::pair<double, std::size_t>> loss;
    for (std::size_t t = 0; t < to_.wanted.size(); ++t)
      if (chosen_.targets[t].attainable) loss.emplace_back(chosen_.loss[nth][t], t);
    std::stable_sort(loss.begin(), loss.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    NextPose next;
    const std::size_t at = to_.which[static_cast<std::size_t>(chosen_.chosen[nth])];
    const Origin& origin = pool_.origins[at];
    next.row = pool_.rows[at];
    if (origin.again >= 0)
      next.again = pose_number(d_.recordings, static_cast<std::size_t>(origin.again));
    next.coordinates = pool_.settings.poses[at];
    if (!loss.empty()) next.gain = loss[0].first;
    for (const auto& [l, t] : loss) {
      if (next.purposes.size() == kPurposes || (!next.purposes.empty() && l < loss[0].first / 2))
        break;
      const NextTarget& n = out_.targets[t];
      std::string words = (n.rivals.empty() ? "see " : "tell ") + place_of(n.effect, n.location);
      if (!n.rivals.empty()) words += " from " + join(n.rivals, " and ");
      next.purposes.push_back(std::move(words));
    }
    add_to_table(out_.table, *d_.program, pool_, next.coordinates, next.row);
    next.row = out_.table.rows() - 1;
    next.how = how_to_record(out_.table, *d_.program, pool_, origin, sides());
    if (origin.mounting >= 0)
      out_.mounting = pool_.mountings[static_cast<std::size_t>(origin.mounting)].words;
    out_.poses.push_back(std::move(next));
  }

  void statement() {
    std::size_t attainable = 0, reached = 0;
    for (const NextTarget& t : out_.targets) {
      attainable += t.attainable;
      reached += t.attainable && t.smallest_after <= t.typical;
    }
    const std::size_t count = out_.poses.size();
    if (count == 0)
      out_.statement =
          to_.telling
              ? "No poses within the ranges of the sensors tell what was found from its rivals; "
                "another load, mounting or design would have to."
              : "No poses within the ranges of the sensors would show more.";
    else if (to_.telling)
      out_.statement =
          fmt::format("{} poses that tell what was found from its rivals best.", count);
    else
      out_.statement = fmt::format(
          "{} poses for what these recordings would not show at its usual size: of {} such "
          "suspects {} would then be seen.",
          count, attainable, reached);
  }

  const Diagnosis& d_;
  const Pool& pool_;
  NextTargets to_;
  NextPosesOptions choice_;
  NextPoses chosen_;
  NextRecordings out_;
};

}  // namespace

NextRecordings next_recordings(const Ground& ground, const Diagnosis& diagnosis, const Seen& seen,
                               const AdviceOptions& options) {
  NextRecordings none;
  if (options.pool <= 0 || options.poses <= 0) return none;
  try {
    PoolOptions drawn{options.pool, options.seed, false, options.suspects};
    auto pool = [&] {
      return pool_of(ground, diagnosis.recordings, diagnosis.search.null, fit_before(diagnosis).x,
                     drawn);
    };
    const Pool standing = pool();
    if (standing.poses.empty()) {
      none.statement =
          standing.loops.empty()
              ? "No next poses: none within the ranges of the sensors can be simulated."
              : "No next poses: none within the ranges of the sensors closes " +
                    join(standing.loops) + ".";
      return none;
    }
    Chooser best(diagnosis, seen, standing, options, options.poses);
    NextRecordings result = best.run();
    if (!best.wants_other_loads()) return result;
    drawn.turned = true;
    const Pool turned = pool();
    const int mountings = static_cast<int>(turned.mountings.size());
    int found = -1;
    // Turning a linkage is work: it is proposed where poses and payloads do not tell what was found
    // from its rivals, and otherwise what it would show is but said.
    if (best.telling()) {
      auto most = best.reached();
      for (int m = 0; m < mountings; ++m)
        if (const auto now = Chooser(diagnosis, seen, turned, options, options.poses, m).reached();
            now.first > most.first || (found >= 0 && now > most))
          most = now, found = m;
      if (found < 0) return result;
      return Chooser(diagnosis, seen, turned, options, options.poses, found).run();
    }
    int most = best.attainable();
    for (int m = 0; m < mountings; ++m)
      if (const int now = Chooser(diagnosis, seen, turned, options, 0, m).attainable(); now > most)
        most = now, found = m;
    if (found >= 0)
      result.statement += fmt::format(" With {}, poses could show {} more.",
                                      turned.mountings[static_cast<std::size_t>(found)].words,
                                      most - best.attainable());
    return result;
  } catch (const InputError& error) {
    none.statement = std::string("No next poses: ") + error.what();
    return none;
  }
}

}  // namespace talus
