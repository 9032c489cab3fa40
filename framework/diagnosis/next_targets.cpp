#include "framework/diagnosis/next_targets.h"

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/blind_spots.h"
#include "framework/diagnosis/next_table.h"
#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

constexpr std::size_t kMostTargets = 100;
constexpr double kNamedRival = 0.05;  // rivals as probable as this are to be told apart

// Poses say nothing of what depends on when they are recorded.
bool by_poses(const EffectTraits& effect) {
  return !effect.unknown && effect.onset.empty() &&
         !depends_on(effect,
                     {Covariate::time, Covariate::session, Covariate::pose, Covariate::temperature,
                      Covariate::rate, Covariate::travel, Covariate::since});
}

bool share_none(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return std::none_of(a.begin(), a.end(), [&](const std::string& name) {
    return std::find(b.begin(), b.end(), name) != b.end();
  });
}

}  // namespace

bool depends_on(const EffectTraits& effect, std::initializer_list<Covariate> any) {
  return std::any_of(effect.needs.begin(), effect.needs.end(), [&](Covariate c) {
    return std::find(any.begin(), any.end(), c) != any.end();
  });
}

std::string place_of(const std::string& effect, const std::string& location) {
  return spoken(effect) + " at " + location;
}

NextTargets::NextTargets(const Diagnosis& diagnosis, const Seen& seen, const Pool& pool,
                         int mounting)
    : candidates(pool.suspects.candidates), d_(diagnosis), seen_(seen), pool_(pool) {
  for (std::size_t i = 0; i < pool.poses.size(); ++i)
    if (const int m = pool.origins[i].mounting; m < 0 || m == mounting) {
      which.push_back(i);
      poses.push_back(pool.poses[i]);
    }
  const Screen::Inside& stage = d_.search.stage->screen.inside();
  if (d_.search.first.threshold < 0)
    needed.seen = needed_noncentrality(d_.search.first.threshold, 2, 0.8) * stage.noise;
  to_tell();
  telling = !wanted.empty();
  if (!telling) to_see();
}

// The form of the pool that is this way of this suspect; -1: there is none.
int NextTargets::form_of(const Suspect& suspect, const Way& way) const {
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

const Suspect& NextTargets::suspect(int form) const {
  const auto made = made_.find(form);
  const Way& way =
      pool_.suspects.ways[static_cast<std::size_t>(made == made_.end() ? form : made->second)];
  return pool_.suspects.suspects[static_cast<std::size_t>(way.suspect)];
}

// What acts from a recorded pose or session on: nothing before, and all that is recorded next is
// after.
int NextTargets::from_onset(int form, const Accepted& e) {
  const EffectTraits& effect = e.suspect.plugin->declaration.effect;
  const auto from = e.way.settings.find(effect.onset);
  if (form < 0 || effect.onset.empty() || from == e.way.settings.end()) return form;
  const RecordedColumn* session =
      effect.onset_of == Covariate::session ? d_.recordings.find("session") : nullptr;
  Form made = candidates.forms[static_cast<std::size_t>(form)];
  const Eigen::Index first = candidates.columns.cols(),
                     count = static_cast<Eigen::Index>(made.columns.size());
  const std::vector<int> own = made.columns;
  Eigen::MatrixXd columns = candidates.columns(Eigen::all, own);
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
  for (PoolPose& p : poses) append(p.candidates, Eigen::MatrixXd(p.candidates(Eigen::all, own)));
  append(candidates.columns, columns);
  const Eigen::VectorXd typical = candidates.typical(own);
  candidates.typical.conservativeResize(first + count);
  candidates.typical.tail(count) = typical;
  for (std::size_t i = 0; i < own.size(); ++i)
    made.columns[i] = static_cast<int>(first) + static_cast<int>(i);
  candidates.forms.push_back(made);
  const int index = static_cast<int>(candidates.forms.size()) - 1;
  made_[index] = form;
  return index;
}

void NextTargets::target(const Suspect& suspect, const Way& way, const Eigen::VectorXd& amounts,
                         const std::vector<const Accepted*>& rivals, const Accepted* found) {
  if (wanted.size() >= kMostTargets) return;
  int form = form_of(suspect, way);
  if (found) form = from_onset(form, *found);
  if (form < 0) return;
  // Typical sizes are those that the recorded poses stand for.
  const Form& columns = candidates.forms[static_cast<std::size_t>(form)];
  for (std::size_t a = 0; a < columns.columns.size(); ++a)
    candidates.typical[columns.columns[a]] = way.typical[a];
  Target t{form, amounts, {}};
  NextTarget words{suspect.effect, suspect.location, "", ""};
  for (const Accepted* r : rivals)
    if (const int other = from_onset(form_of(r->suspect, r->way), *r); other >= 0) {
      t.rivals.push_back(other);
      words.rivals.push_back(place_of(r->suspect.effect, r->suspect.location));
    }
  for (const SeenSuspect& s : seen_.suspects)
    if (s.effect == suspect.effect && s.location == suspect.location)
      words.amount = s.amount, words.unit = s.unit, words.typical = s.typical;
  wanted.push_back(std::move(t));
  named.push_back(std::move(words));
}

void NextTargets::to_tell() {
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
}

void NextTargets::to_see() {
  std::vector<const SeenSuspect*> hidden;
  for (const SeenSuspect& s : seen_.suspects)
    if (s.in_typical() > 1) hidden.push_back(&s);
  std::stable_sort(hidden.begin(), hidden.end(),
                   [](const auto* a, const auto* b) { return a->in_typical() < b->in_typical(); });
  const Suspects& all = d_.search.stage->suspects;
  auto suspect_of = [&](const SeenSuspect& s) -> const Suspect& {
    return all.suspects[static_cast<std::size_t>(s.sensitivity.suspect)];
  };
  auto way_of = [&](const SeenSuspect& s) -> const Way& {
    return all.ways[static_cast<std::size_t>(s.sensitivity.pick.form)];
  };
  for (const SeenSuspect* s : hidden)
    if (by_poses(suspect_of(*s).plugin->declaration.effect))
      target(suspect_of(*s), way_of(*s), {}, {});
  // Of what may follow one circumstance or another, the way that is not the one best seen.
  const std::size_t sure = wanted.size();
  for (const SeenSuspect& s : seen_.suspects) {
    const EffectTraits& effect = suspect_of(s).plugin->declaration.effect;
    if (!by_poses(effect) || effect.needs.size() < 2) continue;
    for (const Way& way : all.ways)
      if (way.suspect == s.sensitivity.suspect && share_none(way.amounts, way_of(s).amounts))
        target(suspect_of(s), way, {}, {});
  }
  if (wanted.size() == sure) return;
  const auto added = static_cast<std::ptrdiff_t>(sure);
  NextPosesOptions none = needed;
  none.count = 0;
  const NextPoses now =
      next_poses(pool_.baseline, candidates, {}, {wanted.begin() + added, wanted.end()}, none);
  for (std::size_t t = wanted.size(); t-- > sure;)
    if (now.targets[t - sure].seen_before >= needed.seen) {
      wanted.erase(wanted.begin() + static_cast<std::ptrdiff_t>(t));
      named.erase(named.begin() + static_cast<std::ptrdiff_t>(t));
    }
}

}  // namespace talus
