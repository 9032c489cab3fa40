#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

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

bool needs(const EffectTraits& effect, std::initializer_list<Covariate> any) {
  return std::any_of(effect.needs.begin(), effect.needs.end(), [&](Covariate c) {
    return std::find(any.begin(), any.end(), c) != any.end();
  });
}

std::string place_of(const std::string& effect, const std::string& location) {
  return spoken(effect) + " at " + location;
}

class Chooser {
 public:
  // `mounting`: poses of the pool that are turned so may be chosen beside those that are not.
  Chooser(const Diagnosis& diagnosis, const Seen& seen, const Pool& pool,
          const AdviceOptions& options, int mounting = -1)
      : d_(diagnosis),
        seen_(seen),
        pool_(pool),
        options_(options),
        candidates_(pool.suspects.candidates) {
    for (std::size_t i = 0; i < pool.poses.size(); ++i)
      if (const int m = pool.origins[i].mounting; m < 0 || m == mounting) {
        which_.push_back(i);
        poses_.push_back(pool.poses[i]);
      }
    targets();
    choice_.count = options_.poses;
    choice_.threads = options_.threads;
    const Screen::Inside& stage = d_.search.stage->screen.inside();
    if (d_.search.first.threshold < 0)
      choice_.seen = needed_noncentrality(d_.search.first.threshold, 2, 0.8) * stage.noise;
    if (!wanted_.empty())
      chosen_ = next_poses(pool_.baseline, candidates_, poses_, wanted_, choice_);
  }

  // Targets that the chosen poses show or tell apart; the least share of what is needed, up to one.
  std::pair<int, double> reached() const {
    int count = 0;
    for (std::size_t t = 0; t < wanted_.size(); ++t) count += share(t) >= 1;
    return {count, std::min(1.0, chosen_.after)};
  }

  bool telling() const { return telling_; }

  // Is a target out of reach that other loads could change?
  bool wants_other_loads() const {
    for (std::size_t t = 0; t < wanted_.size(); ++t) {
      if (share(t) >= 1) continue;
      std::vector<int> forms = wanted_[t].rivals;
      forms.push_back(wanted_[t].form);
      for (const int f : forms)
        if (needs(trait(f), {Covariate::load, Covariate::tip_load})) return true;
    }
    return false;
  }

  NextRecordings run() {
    describe_coordinates();
    if (wanted_.empty()) {
      out_.statement = "No further poses are needed for the usual suspects that poses can show.";
      return std::move(out_);
    }
    out_.before = chosen_.before, out_.after = chosen_.after;
    for (std::size_t t = 0; t < wanted_.size(); ++t) gain(t, chosen_.targets[t]);
    for (const int pose : chosen_.chosen) add(pose);
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

  const EffectTraits& trait(int form) const {
    const Way& way = pool_.suspects.ways[static_cast<std::size_t>(origin_of(form))];
    return pool_.suspects.suspects[static_cast<std::size_t>(way.suspect)]
        .plugin->declaration.effect;
  }
  int origin_of(int form) const {
    const auto it = made_.find(form);
    return it == made_.end() ? form : it->second;
  }

  // What acts from a recorded pose or session on: nothing before, and all that is recorded next is
  // after.
  int from_onset(int form, const Accepted& e) {
    const EffectTraits& effect = e.suspect.plugin->declaration.effect;
    const auto from = e.way.settings.find(effect.onset);
    if (form < 0 || effect.onset.empty() || from == e.way.settings.end()) return form;
    const RecordedColumn* session =
        effect.onset_of == Covariate::session ? d_.recordings.find("session") : nullptr;
    Form made = candidates_.forms[static_cast<std::size_t>(form)];
    const Eigen::Index first = candidates_.columns.cols(),
                       count = static_cast<Eigen::Index>(made.columns.size());
    const std::vector<int> own = made.columns;
    Eigen::MatrixXd columns = candidates_.columns(Eigen::all, own);
    for (Eigen::Index r = 0; r < columns.rows(); ++r) {
      const int pose = pool_.baseline.pose[static_cast<std::size_t>(r)];
      const std::size_t row = pool_.recorded[static_cast<std::size_t>(pose)];
      const double when = session ? session->values[row] : pose_number(d_.recordings, row);
      if (when < from->second) columns.row(r).setZero();
    }
    auto append = [&](Eigen::MatrixXd& all, const Eigen::MatrixXd& more) {
      all.conservativeResize(Eigen::NoChange, first + count);
      all.rightCols(count) = more;
    };
    for (PoolPose& p : poses_) append(p.candidates, Eigen::MatrixXd(p.candidates(Eigen::all, own)));
    append(candidates_.columns, columns);
    const Eigen::VectorXd typical = candidates_.typical(own);
    candidates_.typical.conservativeResize(first + count);
    candidates_.typical.tail(count) = typical;
    for (std::size_t i = 0; i < own.size(); ++i)
      made.columns[i] = static_cast<int>(first) + static_cast<int>(i);
    candidates_.forms.push_back(made);
    const int index = static_cast<int>(candidates_.forms.size()) - 1;
    made_[index] = form;
    return index;
  }

  void target(const Suspect& suspect, const Way& way, const Eigen::VectorXd& amounts,
              const std::vector<const Accepted*>& rivals, const Accepted* found = nullptr) {
    if (wanted_.size() >= kMostTargets) return;
    int form = form_of(suspect, way);
    if (found) form = from_onset(form, *found);
    if (form < 0) return;
    // Typical sizes are those that the recorded poses stand for.
    const Form& columns = candidates_.forms[static_cast<std::size_t>(form)];
    for (std::size_t a = 0; a < columns.columns.size(); ++a)
      candidates_.typical[columns.columns[a]] = way.typical[a];
    Target t{form, amounts, {}};
    NextTarget named{suspect.effect, suspect.location, "", ""};
    for (const Accepted* r : rivals)
      if (const int other = from_onset(form_of(r->suspect, r->way), *r); other >= 0) {
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
        if (e.suspect.effect != "unknown" && !rivals.empty())
          target(e.suspect, e.way,
                 Eigen::Map<const Eigen::VectorXd>(e.amounts.data(),
                                                   static_cast<Eigen::Index>(e.amounts.size())),
                 rivals, &e);
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
    return wanted_[t].rivals.empty() ? seen : std::min(seen, g.told_after / choice_.told);
  }

  // Joints whose sense of approach the targets or their rivals depend on.
  std::set<std::string> sides() const {
    std::set<std::string> result;
    for (std::size_t t = 0; t < wanted_.size(); ++t) {
      if (!chosen_.targets[t].attainable) continue;
      std::vector<int> forms = wanted_[t].rivals;
      forms.push_back(wanted_[t].form);
      for (const int f : forms)
        if (needs(trait(f), {Covariate::approach})) {
          const Way& way = pool_.suspects.ways[static_cast<std::size_t>(origin_of(f))];
          result.insert(pool_.suspects.suspects[static_cast<std::size_t>(way.suspect)].joint);
        }
    }
    return result;
  }

  void gain(std::size_t t, const TargetGain& g) {
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
      return chi2 > 1e-6 ? named.typical * size * std::sqrt(choice_.seen / chi2) : INFINITY;
    };
    named.smallest_before = smallest(g.seen_before), named.smallest_after = smallest(g.seen_after);
    named.told_before = g.told_before, named.told_after = g.told_after;
    named.attainable = g.attainable;
  }

  // What is lost most without the pose is what it is for.
  void add(int pose) {
    std::vector<PoolPose> others;
    for (const int p : chosen_.chosen)
      if (p != pose) others.push_back(poses_[static_cast<std::size_t>(p)]);
    std::vector<std::pair<double, std::size_t>> loss;
    for (std::size_t t = 0; t < wanted_.size(); ++t) {
      if (!chosen_.targets[t].attainable) continue;
      loss.emplace_back(0, t);
    }
    std::vector<Target> attainable;
    for (const auto& [l, t] : loss) attainable.push_back(wanted_[t]);
    NextPosesOptions rest = choice_;
    rest.count = 0;  // the design with the others, nothing further
    const Baseline with = extended_baseline(others);
    const Candidates columns = extended_candidates(others);
    const NextPoses without = next_poses(with, columns, {}, attainable, rest);
    for (std::size_t i = 0; i < loss.size(); ++i) {
      const TargetGain &full = chosen_.targets[loss[i].second], &less = without.targets[i];
      const bool told = !wanted_[loss[i].second].rivals.empty();
      const double a = told ? full.told_after : full.seen_after,
                   b = told ? less.told_before : less.seen_before;
      loss[i].first = a > 0 ? (a - b) / a : 0;
    }
    std::stable_sort(loss.begin(), loss.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    NextPose next;
    const std::size_t at = which_[static_cast<std::size_t>(pose)];
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
  Candidates candidates_;           // of the pool, and what acts from a pose on
  std::map<int, int> made_;         // such a form, and the one it was made of
  std::vector<std::size_t> which_;  // of the pool
  std::vector<PoolPose> poses_;     // these
  std::vector<Target> wanted_;
  NextPosesOptions choice_;
  NextPoses chosen_;
  bool telling_ = false;
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
    Chooser best(diagnosis, seen, standing, options);
    if (standing.poses.empty() && standing.loops.empty())
      none.statement = "No next poses: none within the ranges of the sensors can be simulated.";
    else if (standing.poses.empty())
      none.statement =
          "No next poses: none was found within the ranges of the sensors that closes " +
          join(standing.loops) + ".";
    if (standing.poses.empty()) return none;
    NextRecordings result = best.run();
    if (!best.wants_other_loads()) return result;
    // Turning a linkage is work: only where poses and payloads do not tell what was found from its
    // rivals. What it would show beside is but said.
    drawn.turned = true;
    const Pool turned = pool();
    int found = -1;
    auto most = best.reached();
    for (int m = 0; m < static_cast<int>(turned.mountings.size()); ++m)
      if (const auto now = Chooser(diagnosis, seen, turned, options, m).reached();
          now.first > most.first || (found >= 0 && now > most))
        most = now, found = m;
    if (found < 0) return result;
    if (best.telling()) return Chooser(diagnosis, seen, turned, options, found).run();
    result.statement +=
        fmt::format(" As many poses, some with {}, would show {}.",
                    turned.mountings[static_cast<std::size_t>(found)].words, most.first);
    return result;
  } catch (const InputError& error) {
    none.statement = std::string("No next poses: ") + error.what();
    return none;
  }
}

}  // namespace talus
