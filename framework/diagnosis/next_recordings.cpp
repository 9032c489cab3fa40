#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/advice.h"
#include "framework/diagnosis/blind_spots.h"
#include "framework/diagnosis/next_table.h"
#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr std::size_t kMostTargets = 100;
constexpr double kNamedRival = 0.05;  // rivals as probable as this are to be told apart
constexpr std::size_t kPurposes = 2;

// Poses say nothing of what depends on when they are recorded.
bool by_poses(const EffectTraits& effect) {
  if (effect.unknown || !effect.onset.empty()) return false;
  return std::none_of(effect.needs.begin(), effect.needs.end(), [](Covariate c) {
    return c == Covariate::time || c == Covariate::session || c == Covariate::pose ||
           c == Covariate::temperature || c == Covariate::rate || c == Covariate::travel ||
           c == Covariate::since;
  });
}

std::string place_of(const std::string& effect, const std::string& location) {
  return spoken(effect) + " at " + location;
}

class Chooser {
 public:
  Chooser(const Diagnosis& diagnosis, const Seen& seen, const Pool& pool,
          const AdviceOptions& options)
      : d_(diagnosis),
        seen_(seen),
        pool_(pool),
        options_(options),
        candidates_(pool.suspects.candidates) {}

  NextRecordings run() {
    targets();
    describe_coordinates();
    if (wanted_.empty()) {
      out_.statement = "No further poses are needed for the usual suspects that poses can show.";
      return std::move(out_);
    }
    NextPosesOptions options;
    options.count = options_.poses;
    options.threads = options_.threads;
    const Screen::Inside& stage = d_.search.stage->screen.inside();
    if (d_.search.first.threshold < 0)
      options.seen = needed_noncentrality(d_.search.first.threshold, 2, 0.8) * stage.noise;
    const NextPoses chosen = next_poses(pool_.baseline, candidates_, pool_.poses, wanted_, options);
    out_.before = chosen.before, out_.after = chosen.after;
    for (std::size_t t = 0; t < wanted_.size(); ++t) gain(t, chosen.targets[t], options);
    for (const int pose : chosen.chosen) add(chosen, pose, options);
    statement();
    return std::move(out_);
  }

 private:
  // The form of the pool that is this way of this suspect; -1: there is none.
  int form_of(const Suspect& suspect, const Way& way) const {
    int best = -1;
    double nearest = INFINITY;
    const Suspects& all = pool_.suspects;
    for (std::size_t f = 0; f < all.ways.size(); ++f) {
      const Way& w = all.ways[f];
      const Suspect& s = all.suspects[static_cast<std::size_t>(w.suspect)];
      if (s.plugin != suspect.plugin || s.at != suspect.at || w.driver != way.driver ||
          w.choices != way.choices || w.amounts != way.amounts)
        continue;
      double away = 0;
      for (const auto& [name, value] : w.settings)
        if (auto it = way.settings.find(name); it != way.settings.end())
          away += std::abs(value - it->second) / (1e-9 + std::abs(value) + std::abs(it->second));
      if (away < nearest) nearest = away, best = static_cast<int>(f);
    }
    return best;
  }

  void target(const Suspect& suspect, const Way& way, const Eigen::VectorXd& amounts,
              const std::vector<const Accepted*>& rivals) {
    if (wanted_.size() >= kMostTargets) return;
    const int form = form_of(suspect, way);
    if (form < 0) return;
    // Typical sizes are those that the recorded poses stand for.
    const Form& columns = candidates_.forms[static_cast<std::size_t>(form)];
    for (std::size_t a = 0; a < columns.columns.size(); ++a)
      candidates_.typical[columns.columns[a]] = way.typical[a];
    Target t{form, amounts, {}};
    NextTarget named{suspect.effect, suspect.location, "", ""};
    for (const Accepted* r : rivals)
      if (const int other = form_of(r->suspect, r->way); other >= 0) {
        t.rivals.push_back(other);
        named.rivals.push_back(place_of(r->suspect.effect, r->suspect.location));
      }
    for (const SeenSuspect& s : seen_.suspects)
      if (s.effect == suspect.effect && s.location == suspect.location)
        named.amount = s.amount, named.unit = s.unit, named.typical = s.typical;
    wanted_.push_back(std::move(t));
    out_.targets.push_back(std::move(named));
  }

  void targets() {
    if (d_.verdict == Verdict::ambiguous || !d_.hints.empty())
      for (std::size_t i = 0; i < d_.search.best.effects.size(); ++i) {
        const Accepted& e = d_.search.best.effects[i];
        std::vector<const Accepted*> rivals;
        for (const Alternative& a : d_.search.members[i].alternatives)
          if (a.probability >= kNamedRival && a.effect.suspect.effect != "unknown" &&
              !(a.effect.suspect.plugin == e.suspect.plugin && a.effect.suspect.at == e.suspect.at))
            rivals.push_back(&a.effect);
        const bool known =
            e.suspect.effect != "unknown" && e.suspect.plugin->declaration.effect.onset.empty();
        if (known && !rivals.empty())
          target(e.suspect, e.way,
                 Eigen::Map<const Eigen::VectorXd>(e.amounts.data(),
                                                   static_cast<Eigen::Index>(e.amounts.size())),
                 rivals);
      }
    telling_ = !wanted_.empty();
    if (telling_) return;
    std::vector<const SeenSuspect*> hidden;
    for (const SeenSuspect& s : seen_.suspects)
      if (s.in_typical() > 1) hidden.push_back(&s);
    std::stable_sort(hidden.begin(), hidden.end(), [](const auto* a, const auto* b) {
      return a->in_typical() < b->in_typical();
    });
    const Stage& stage = *d_.search.stage;
    for (const SeenSuspect* s : hidden) {
      const Suspect& suspect =
          stage.suspects.suspects[static_cast<std::size_t>(s->sensitivity.suspect)];
      if (by_poses(suspect.plugin->declaration.effect))
        target(suspect, stage.suspects.ways[static_cast<std::size_t>(s->sensitivity.pick.form)], {},
               {});
    }
  }

  void describe_coordinates() {
    for (std::size_t i = 0; i < pool_.coordinates.size(); ++i) {
      out_.names.push_back(pool_.coordinates[i].name);
      out_.dimensions.push_back(pool_.coordinates[i].dimension);
      out_.moves.push_back(pool_.coordinates[i].range.has_value());
      if (pool_.assumed[i]) out_.assumed.push_back(pool_.coordinates[i].name);
    }
  }

  void gain(std::size_t t, const TargetGain& g, const NextPosesOptions& options) {
    NextTarget& named = out_.targets[t];
    double size = 1;  // of the amounts that the chi-square belongs to, in typical ones
    if (wanted_[t].amounts.size() > 0) {
      double sum = 0;
      const Form& form = candidates_.forms[static_cast<std::size_t>(wanted_[t].form)];
      for (std::size_t a = 0; a < form.columns.size(); ++a)
        sum += std::pow(
            wanted_[t].amounts[static_cast<Eigen::Index>(a)] / candidates_.typical[form.columns[a]],
            2);
      size = std::sqrt(sum);
    }
    auto smallest = [&](double chi2) {
      return chi2 > 1e-6 ? named.typical * size * std::sqrt(options.seen / chi2) : INFINITY;
    };
    named.smallest_before = smallest(g.seen_before), named.smallest_after = smallest(g.seen_after);
    named.told_before = g.told_before, named.told_after = g.told_after;
    named.attainable = g.attainable;
  }

  // What is lost most without the pose is what it is for.
  void add(const NextPoses& chosen, int pose, const NextPosesOptions& options) {
    std::vector<PoolPose> others;
    for (const int p : chosen.chosen)
      if (p != pose) others.push_back(pool_.poses[static_cast<std::size_t>(p)]);
    std::vector<std::pair<double, std::size_t>> loss;
    for (std::size_t t = 0; t < wanted_.size(); ++t) {
      if (!chosen.targets[t].attainable) continue;
      loss.emplace_back(0, t);
    }
    std::vector<Target> attainable;
    for (const auto& [l, t] : loss) attainable.push_back(wanted_[t]);
    NextPosesOptions rest = options;
    rest.count = 0;  // the design with the others, nothing further
    const Baseline with = extended_baseline(others);
    const Candidates columns = extended_candidates(others);
    const NextPoses without = next_poses(with, columns, {}, attainable, rest);
    for (std::size_t i = 0; i < loss.size(); ++i) {
      const TargetGain &full = chosen.targets[loss[i].second], &less = without.targets[i];
      const bool told = !wanted_[loss[i].second].rivals.empty();
      const double a = told ? full.told_after : full.seen_after,
                   b = told ? less.told_before : less.seen_before;
      loss[i].first = a > 0 ? (a - b) / a : 0;
    }
    std::stable_sort(loss.begin(), loss.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    NextPose next;
    next.row = pool_.rows[static_cast<std::size_t>(pose)];
    next.coordinates = pool_.settings.poses[static_cast<std::size_t>(pose)];
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
    out_.poses.push_back(std::move(next));
  }

  Baseline extended_baseline(const std::vector<PoolPose>& others) const {
    Baseline b = pool_.baseline;
    const Eigen::Index data = pool_.suspects.candidates.columns.rows(),
                       priors = b.columns.rows() - data;
    Eigen::Index more = 0;
    for (const PoolPose& p : others) more += p.columns.rows();
    Eigen::MatrixXd columns(b.columns.rows() + more, b.columns.cols());
    columns.topRows(data) = b.columns.topRows(data);
    columns.bottomRows(priors) = b.columns.bottomRows(priors);
    Eigen::Index at = data;
    for (const PoolPose& p : others) {
      columns.middleRows(at, p.columns.rows()) = p.columns;
      at += p.columns.rows();
    }
    Eigen::VectorXd rows = Eigen::VectorXd::Zero(columns.rows());
    rows.head(data) = b.rows.head(data);
    b.columns = std::move(columns), b.rows = std::move(rows);
    return b;
  }

  Candidates extended_candidates(const std::vector<PoolPose>& others) const {
    Candidates c = candidates_;
    for (const PoolPose& p : others) {
      const Eigen::Index at = c.columns.rows();
      c.columns.conservativeResize(at + p.candidates.rows(), Eigen::NoChange);
      c.columns.bottomRows(p.candidates.rows()) = p.candidates;
    }
    return c;
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
          telling_
              ? "No poses within the ranges of the sensors tell what was found from its rivals; "
                "another load, mounting or design would have to."
              : "No poses within the ranges of the sensors would show more.";
    else if (telling_)
      out_.statement =
          fmt::format("{} poses that tell what was found from its rivals best.", count);
    else
      out_.statement = fmt::format(
          "{} poses for what these recordings would not show at its usual size: of {} such "
          "suspects {} would then be seen.",
          count, attainable, reached);
  }

  const Diagnosis& d_;
  const Seen& seen_;
  const Pool& pool_;
  const AdviceOptions& options_;
  Candidates candidates_;  // of the pool
  std::vector<Target> wanted_;
  bool telling_ = false;
  NextRecordings out_;
};

}  // namespace

NextRecordings next_recordings(const Ground& ground, const Diagnosis& diagnosis, const Seen& seen,
                               const AdviceOptions& options) {
  NextRecordings none;
  if (options.pool <= 0 || options.poses <= 0) return none;
  try {
    const Pool pool =
        pool_of(ground, diagnosis.recordings, diagnosis.search.null, fit_before(diagnosis).x,
                options.pool, options.seed, options.suspects);
    if (pool.poses.empty()) {
      none.statement = "No next poses: none within the ranges of the sensors can be simulated.";
      return none;
    }
    return Chooser(diagnosis, seen, pool, options).run();
  } catch (const InputError& error) {
    none.statement = std::string("No next poses: ") + error.what();
    return none;
  }
}

}  // namespace talus
