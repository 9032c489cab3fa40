#include "framework/diagnosis/suspects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "framework/kinematics/covariates.h"
#include "framework/kinematics/tape_values.h"
#include "framework/registry/choices.h"

namespace talus {
namespace {

// Columns whose parts cancel so far are zero but for rounding (square of their size).
constexpr double kRounding = 1e-20;

bool knows(const EffectPlace& place, Covariate c) {
  return std::find(place.known.begin(), place.known.end(), c) != place.known.end();
}

// Does a plugin fit a place, whatever is recorded?
bool fits(const Declaration& d, const EffectPlace& place) {
  if (d.effect.acts != place.acts) return false;
  const auto& on = d.effect.on;
  if (!on.empty() && std::find(on.begin(), on.end(), place.dimension) == on.end()) return false;
  return std::all_of(d.inputs.begin(), d.inputs.end(), [&](const Input& i) {
    return i.role != Role::borrowed || place.inputs.contains(i.name);
  });
}

// 10, 20, 30, 60, 90, 120 deg: whichever is nearest to half of a range.
double excursion(double range) {
  double best = 30 * deg;
  for (double step : {10., 20., 30., 60., 90., 120.})
    if (std::abs(std::log(step * deg / (range / 2))) < std::abs(std::log(best / (range / 2))))
      best = step * deg;
  return range > 0 ? best : 30 * deg;
}

class Enumerator {
 public:
  Enumerator(const Program& program, const Registry& registry, const PoseSlots& slots,
             const Problem::Linear& linear, const SuspectOptions& options)
      : program_(program), slots_(slots), columns_(linear.columns), pose_(linear.pose) {
    for (const std::string& tag : registry.tags(Family::effect))
      if (options.only.empty() ||
          std::find(options.only.begin(), options.only.end(), tag) != options.only.end())
        plugin(*registry.find(tag, Family::effect));
  }

  Suspects run() {
    evaluate();
    return std::move(out_);
  }

 private:
  void plugin(const Plugin& p) {
    const Declaration& d = p.declaration;
    if (!d.effect.same_as.empty()) return;
    const bool whole = d.effect.everywhere || d.effect.acts == Acts::fixture ||
                       d.effect.acts == Acts::tip || d.effect.acts == Acts::measured;
    Suspect all{&p, d.tag, ""};
    for (std::size_t i = 0; i < program_.places.size(); ++i) {
      const EffectPlace& place = program_.places[i];
      if (!fits(d, place)) continue;
      if (whole) {
        all.places.push_back(static_cast<int>(i));
        all.dimension = place.dimension;
        continue;
      }
      Suspect one{
          &p, d.tag, place.location, place.location, {static_cast<int>(i)}, place.dimension};
      if (d.effect.at_joint && place.dimension == angle && !place.joint.empty())
        one.location = one.at = place.joint;
      suspect(std::move(one));
    }
    if (all.places.empty()) return;
    // Of several features each may move by itself, too.
    if (d.effect.acts == Acts::tip && all.places.size() > 1)
      for (const int i : all.places) {
        const EffectPlace& place = program_.places[i];
        const std::string& feature = program_.features[place.feature].name;
        suspect({&p, d.tag, feature, feature, {i}, place.dimension});
      }
    const Acts acts = d.effect.acts;
    all.location = acts == Acts::lengths   ? "links"
                   : acts == Acts::fixture ? "fixture"
                                           : "measurement";
    suspect(std::move(all));
  }

  void suspect(Suspect s) {
    const Declaration& d = s.plugin->declaration;
    if (d.effect.unknown) s.effect = "unknown";
    const EffectPlace& place = program_.places[s.places[0]];
    std::vector<std::string> lacking;
    for (Covariate c : d.effect.needs)
      if (!knows(place, c)) lacking.push_back(to_string(c));
    if (!d.effect.needs.empty() && lacking.size() == d.effect.needs.size()) {
      out_.untestable.push_back({s.effect, s.location, lacking[0]});
      return;
    }
    std::vector<EffectForm> forms = d.effect.forms;
    if (forms.empty()) {
      forms.emplace_back();
      for (const Input& i : d.inputs)
        if (i.role == Role::amount) forms.back().amounts.push_back(i.name);
    }
    if (!d.effect.everywhere) s.joint = place.joint;
    out_.suspects.push_back(std::move(s));
    const int index = static_cast<int>(out_.suspects.size()) - 1;
    for (const EffectForm& form : forms) {
      if (form.finer) continue;
      const Driven driven = form.driven == Driven::no ? d.effect.driven : form.driven;
      for (const auto& [name, expr] : drivers(driven, place))
        for (const auto& choices : combinations(d.choices)) {
          Way way{index, form.amounts, {}, name, {}, choices, !d.effect.onset.empty()};
          settings(way, d, place, expr, 0);
        }
    }
  }

  std::vector<std::pair<std::string, Expr>> drivers(Driven driven, const EffectPlace& place) const {
    std::vector<std::pair<std::string, Expr>> result;
    if (driven == Driven::no) return {{"", Expr(0)}};
    for (const EffectPlace& other : program_.places) {
      if (other.acts != Acts::coordinate || !(other.dimension == angle)) continue;
      const bool own = other.joint == place.joint;
      if ((driven == Driven::by_other && own) || (driven == Driven::by_own && !own)) continue;
      result.emplace_back(other.joint, other.around.coordinate);
    }
    return result;
  }

  // Every combination of the settings from input `next` on.
  void settings(const Way& way, const Declaration& d, const EffectPlace& place, const Expr& driver,
                std::size_t next) {
    if (next == d.inputs.size()) return columns(way, d, driver);
    const Input& i = d.inputs[next];
    auto with = [&](double value) {
      Way more = way;
      more.settings[i.name] = value;
      settings(more, d, place, driver, next + 1);
    };
    if (i.role != Role::setting) return settings(way, d, place, driver, next + 1);
    if (i.name == d.effect.onset) return with(-1e9);
    if (!i.tries.empty()) {
      for (double value : i.tries) with(value);
      return;
    }
    if (d.effect.unknown) {
      if (i.name == "pieces") return with(static_cast<double>(way.amounts.size()) - 3);
      const bool time = knows(place, Covariate::time) && i.dimension == duration;
      const auto [lowest, highest] = range(time                          ? place.around.time
                                           : place.acts == Acts::reading ? place.around.reading
                                                                         : place.around.coordinate);
      return with(i.name == "from" ? lowest : highest);
    }
    if (i.relative) {
      with(i.otherwise);
      std::vector<double> sorted = values(place.around.reading);
      std::sort(sorted.begin(), sorted.end());
      for (int k = 2; k <= 8; ++k)
        if (!sorted.empty()) with(sorted[sorted.size() * k / 10]);
      return;
    }
    if (i.dimension == angle) {
      const auto [lowest, highest] = range(driver.is_constant() ? place.around.coordinate : driver);
      return with(excursion(highest - lowest));
    }
    with(i.otherwise);
  }

  std::vector<double> values(const Expr& e) {
    std::vector<double> result;
    if (e.is_constant()) return result;
    TapeValues tape(*program_.tape, {e.node()});
    for (const auto& slots : slots_)
      if (const double v = tape(slots)[0]; std::isfinite(v)) result.push_back(v);
    return result;
  }

  std::pair<double, double> range(const Expr& e) {
    const std::vector<double> all = values(e);
    if (all.empty()) return {0, 1};
    const auto [a, b] = std::minmax_element(all.begin(), all.end());
    return {*a, *b > *a ? *b : *a + 1};
  }

  // Traces the effect and notes the factors of its columns.
  void columns(const Way& way, const Declaration& d, const Expr& driver) {
    const Suspect& s = out_.suspects[way.suspect];
    Work work{way, {}};
    for (const std::string& amount : way.amounts) {
      const Input& i = *d.find_input(amount);
      work.way.typical.push_back(i.relative && s.dimension == length ? i.typical_length
                                                                     : i.typical);
    }
    const int first = amount_slot(way.amounts.size());
    for (int index : s.places) {
      const EffectPlace& place = program_.places[index];
      EffectPlace here = place;
      here.around.driver = driver;
      if (!knows(place, Covariate::temperature))
        here.around.temperature = Expr(usual_value("temperature"));  // says nothing
      std::vector<Expr> inputs;
      for (const Input& i : d.inputs) {
        const auto amount = std::find(way.amounts.begin(), way.amounts.end(), i.name);
        if (amount != way.amounts.end())
          inputs.push_back(
              Expr::leaf(*program_.tape, first + static_cast<int>(amount - way.amounts.begin())));
        else if (i.role == Role::amount)
          inputs.push_back(Expr(0));
        else if (i.role == Role::borrowed)
          inputs.push_back(here.inputs.at(i.name));
        else if (way.settings.contains(i.name))
          inputs.push_back(Expr(way.settings.at(i.name)));
        else
          inputs.push_back(Expr(i.otherwise));
      }
      const std::vector<Expr> u = s.plugin->act(here.around, inputs, way.choices);
      for (std::size_t part = 0; part < u.size(); ++part) {
        if (u[part].is_constant()) continue;
        const auto slopes = gradient(u[part]);
        for (std::size_t a = 0; a < way.amounts.size(); ++a)
          if (auto it = slopes.find(first + static_cast<int>(a)); it != slopes.end())
            work.factors.push_back(
                {index, static_cast<int>(part), static_cast<int>(a), it->second});
      }
    }
    work_.push_back(std::move(work));
  }

  // Slots for amounts, behind all those of the program.
  int amount_slot(std::size_t count) {
    most_amounts_ = std::max(most_amounts_, count);
    return program_.slots;
  }

  // All factors at all poses, then the columns.
  void evaluate() {
    std::vector<std::int32_t> nodes;
    for (Work& w : work_)
      for (Factor& f : w.factors) {
        f.at = static_cast<int>(nodes.size());
        nodes.push_back(f.value.node_on(*program_.tape));
      }
    TapeValues tape(*program_.tape, nodes);
    Eigen::MatrixXd phi(slots_.size(), nodes.size());
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      std::vector<double> at = slots_[k];
      at.resize(program_.slots + most_amounts_, 0);
      const auto& v = tape(at);
      for (std::size_t i = 0; i < nodes.size(); ++i) phi(k, i) = std::isfinite(v[i]) ? v[i] : 0;
    }
    Eigen::Index total = 0;
    std::set<int> first_of;
    for (const Work& w : work_) total += static_cast<Eigen::Index>(w.way.amounts.size());
    Candidates& c = out_.candidates;
    c.columns.resize(columns_.rows(), total);
    c.typical.resize(total);
    Eigen::Index next = 0;
    for (Work& w : work_) {
      const Suspect& s = out_.suspects[w.way.suspect];
      const EffectTraits& effect = s.plugin->declaration.effect;
      const auto p = static_cast<Eigen::Index>(w.way.amounts.size());
      auto block = c.columns.middleCols(next, p);
      block.setZero();
      Eigen::VectorXd parts = Eigen::VectorXd::Zero(p);  // sums of squares before they cancel
      std::vector<double> largest_shift(p, 0), largest_turn(p, 0);
      for (const Factor& f : w.factors) {
        const EffectPlace& place = program_.places[f.place];
        const int field = place.first_field + f.part;
        for (Eigen::Index r = 0; r < columns_.rows(); ++r)
          block(r, f.amount) += columns_(r, field) * phi(pose_[r], f.at);
        for (Eigen::Index r = 0; r < columns_.rows(); ++r)
          parts[f.amount] += std::pow(columns_(r, field) * phi(pose_[r], f.at), 2);
        const bool turn = parts_of(effect.acts) == 6 ? f.part >= 3 : place.dimension == angle;
        double& largest = (turn ? largest_turn : largest_shift)[f.amount];
        largest = std::max(largest, phi.col(f.at).cwiseAbs().maxCoeff());
      }
      // Amounts that move no row are left out: what they depend on is not recorded or does not
      // vary, or they are of a kind that is not measured (lengths, where directions are).
      std::vector<Eigen::Index> seen;
      for (Eigen::Index a = 0; a < p; ++a)
        if (block.col(a).squaredNorm() > kRounding * parts[a]) seen.push_back(a);
      if (effect.unknown && !seen.empty())  // of a curve all
        for (seen.clear(); static_cast<Eigen::Index>(seen.size()) < p;)
          seen.push_back(static_cast<Eigen::Index>(seen.size()));
      if (seen.empty()) continue;
      for (Eigen::Index a = 0; a < p; ++a) {
        // The usual size of the correction, but no more than a plausible amount.
        double& typical = w.way.typical[a];
        if (effect.typical_angle > 0 && largest_turn[a] > 0)
          typical = std::min(typical, effect.typical_angle / largest_turn[a]);
        if (effect.typical_length > 0 && largest_shift[a] > 0)
          typical = std::min(typical, effect.typical_length / largest_shift[a]);
      }
      Way way = w.way;
      way.amounts.clear(), way.typical.clear();
      Form form;
      form.suspect = way.suspect;
      for (const Eigen::Index a : seen) {
        c.columns.col(next) = block.col(a).eval();
        c.typical[next] = w.way.typical[a];
        way.amounts.push_back(w.way.amounts[a]), way.typical.push_back(w.way.typical[a]);
        form.columns.push_back(static_cast<int>(next++));
      }
      form.onset = way.onset;
      c.forms.push_back(std::move(form));
      out_.ways.push_back(std::move(way));
    }
    c.columns.conservativeResize(Eigen::NoChange, next);
    c.typical.conservativeResize(next);
  }

  struct Factor {
    int place, part, amount;
    Expr value;
    int at = -1;
  };
  struct Work {
    Way way;
    std::vector<Factor> factors;
  };

  const Program& program_;
  const PoseSlots& slots_;
  const Eigen::MatrixXd& columns_;
  const std::vector<int>& pose_;
  std::vector<Work> work_;
  std::size_t most_amounts_ = 0;
  Suspects out_;
};

}  // namespace

Suspects suspects(const Program& program, const Registry& registry, const PoseSlots& slots,
                  const Problem::Linear& linear, const SuspectOptions& options) {
  return Enumerator(program, registry, slots, linear, options).run();
}

Element element_of(const Suspect& suspect, const Way& way, const std::vector<AmountValue>& amounts,
                   const UnitSystem& units) {
  const Declaration& d = suspect.plugin->declaration;
  Element e;
  e.tag = d.tag;
  if (!suspect.at.empty()) e.set("at", suspect.at);
  if (!way.driver.empty()) e.set("driver", way.driver);
  for (std::size_t i = 0; i < d.choices.size(); ++i)
    e.set(d.choices[i].name, d.choices[i].words[way.choices[i]]);
  for (const Input& i : d.inputs) {
    const Dimension dimension = i.relative ? i.dimension * suspect.dimension : i.dimension;
    if (auto s = way.settings.find(i.name); s != way.settings.end())
      e.set(i.name, write_quantity({.value = s->second}, dimension, units));
    const auto a = std::find(way.amounts.begin(), way.amounts.end(), i.name);
    if (a == way.amounts.end()) continue;
    const AmountValue& amount = amounts[static_cast<std::size_t>(a - way.amounts.begin())];
    Quantity q{.value = amount.value, .free = true, .tolerance = amount.tolerance};
    if (i.not_negative) {
      q.value = std::max(0.0, q.value);
      q.bounds = {0, std::numeric_limits<double>::infinity()};
    }
    e.set(i.name, write_quantity(q, dimension, units));
  }
  return e;
}

}  // namespace talus
