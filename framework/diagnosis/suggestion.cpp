#include "framework/diagnosis/suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/curve_place.h"
#include "framework/diagnosis/tails.h"
#include "framework/dsl/read.h"

namespace talus {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr std::size_t kTold = 4;  // rivals named

// Names of a term's inputs: those of the second term end with a 2.
std::string suffix(std::size_t term) { return term == 0 ? "" : std::to_string(term + 1); }

std::string written(const FormulaFit& f, const std::string& x, const std::string& before) {
  std::string text;
  for (std::size_t t = 0; t < f.terms.size(); ++t)
    text += (t > 0 ? " + " : "") + named(f.terms[t].shape->lua, [&](const std::string& n) {
              return n == "x" ? x : before + n + suffix(t);
            });
  return text;
}

Dimension dimension_of(const ShapeSetting& s, Dimension x) {
  using Kind = ShapeSetting::Kind;
  return s.kind == Kind::order || s.kind == Kind::whole ? number : x;
}

// An amount or a setting of the formula.
struct Part {
  std::string name;
  Dimension dimension;
  double value = 0, loose = 0;  // loose: prior of a free one
  bool free = true, amount = true, told = true;
};

std::vector<Part> parts_of_formula(const FormulaFit& f, const CurvePlace& place) {
  std::vector<Part> parts;
  Index next = 0;
  const double range = place.evidence.x.maxCoeff() - place.evidence.x.minCoeff();
  for (std::size_t t = 0; t < f.terms.size(); ++t) {
    for (const std::string& a : f.terms[t].shape->amounts) {
      const double value = f.amounts[next++];
      parts.push_back({a + suffix(t), place.corrects, value,
                       std::max(100 * place.evidence.typical, 10 * std::abs(value))});
    }
    const auto& settings = f.terms[t].shape->settings;
    for (std::size_t k = 0; k < settings.size(); ++k) {
      const double value = f.terms[t].settings[k];
      const bool centre = settings[k].kind == ShapeSetting::Kind::centre;
      parts.push_back({settings[k].name + suffix(t),
                       dimension_of(settings[k], place.axis.dimension), value,
                       centre ? range : std::abs(value), settings[k].fitted(), false});
    }
  }
  return parts;
}

// In Lua: the dimension's name, a value with its unit.
std::string lua_dimension(Dimension d) {
  return d == number     ? "number"
         : d == length   ? "length"
         : d == angle    ? "angle"
         : d == duration ? "duration"
         : d == mass     ? "mass"
                         : "temperature";
}

std::string lua_value(double value, Dimension d, const UnitSystem& units) {
  const Unit unit = units.of(d);
  const std::string text = fmt::format("{:.6g}", value / unit.factor);
  return d == number ? text : fmt::format("\"{} {}\"", text, unit.text);
}

class Suggester {
 public:
  Suggester(const Ground& ground, const Diagnosis& d, std::size_t i, const CurvePlace& place)
      : ground_(ground),
        d_(d),
        index_(i),
        e_(d.search.best.effects.at(i)),
        place_(place),
        units_(d.program->units) {}

  Suggestion run() {
    s_.choice = choose_formula(place_.evidence);
    const EffectTraits& effect = e_.suspect.plugin->declaration.effect;
    const bool reading = effect.acts == Acts::reading && effect.needs.empty();
    symbol_ = !effect.needs.empty() && effect.needs[0] == Covariate::time ? "t"
              : reading                                                   ? "r"
              : effect.needs.empty()                                      ? "q"
                                                                          : "x";
    around_ = !effect.needs.empty() ? to_string(effect.needs[0])
              : reading             ? "reading"
                                    : "coordinate";
    s_.circumstance = reading                ? "reading of " + place_.axis.name
                      : effect.needs.empty() ? "coordinate of " + place_.axis.name
                                             : place_.axis.name;
    if (!s_.choice.ranked.empty()) {
      const FormulaFit& best = s_.choice.ranked[0];
      s_.expression = expression_of(best, symbol_);
      for (const FormulaFit& f : s_.choice.ranked)
        s_.by.emplace_back(name_of(f), std::exp(std::max(-700.0, (best.bic - f.bic) / 2)));
      show(nullptr);
      if (s_.choice.outcome == FormulaChoice::Outcome::wins) fit();
    }
    s_.wins = s_.choice.outcome == FormulaChoice::Outcome::wins;
    say();
    return std::move(s_);
  }

 private:
  // The formula as an effect, fitted with all parameters free.
  void fit() {
    const FormulaFit& f = s_.choice.ranked[0];
    const std::vector<Part> parts = parts_of_formula(f, place_);
    s_.tag = "formula_" + e_.suspect.location;
    s_.lua = lua(f, parts);
    Registry registry = *ground_.registry;
    run_lua_plugins(s_.lua, s_.tag + ".lua", registry);
    std::vector<Accepted> rest = d_.search.best.effects;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(index_));
    s_.model = extended(*ground_.model, rest, units_);
    Element element;
    element.tag = s_.tag;
    if (!e_.suspect.at.empty()) element.set("at", e_.suspect.at);
    if (!e_.way.driver.empty()) element.set("driver", e_.way.driver);
    for (const Part& p : parts) {
      Quantity q{.value = p.value, .free = p.free};
      if (p.free) q.tolerance = p.loose;
      element.set(p.name, write_quantity(q, p.dimension, units_));
    }
    s_.model.root.children.push_back(element);
    auto program = std::make_shared<Program>(compile(s_.model, registry));
    FitOptions options;
    options.threads = ground_.threads, options.restarts = 0;
    const auto& values = d_.search.best.values;
    for (const Parameter& p : program->parameters) {
      const auto known = values.find(p.name);
      options.start.push_back(known == values.end() ? p.nominal.value : known->second);
    }
    for (const FittedValue& v : fit_before(d_).shared) options.start.push_back(values.at(v.name));
    s_.fit = calibrate(*program, *ground_.recordings, d_.split, options);
    s_.program = std::move(program);
    show(&s_.fit);
    // What the linear picture promised must hold of the real fit.
    const double worse = (s_.fit.chi2 - d_.search.best.chi2) / s_.choice.noise,
                 fewer = std::max(1, s_.choice.curve_parameters - f.parameters);
    if (worse > 0 && log_chi2_tail(worse, fewer) < std::log(kFormulaBeside))
      s_.choice.outcome = FormulaChoice::Outcome::misfit;
  }

  std::string lua(const FormulaFit& f, const std::vector<Part>& parts) const {
    const EffectTraits& effect = e_.suspect.plugin->declaration.effect;
    static constexpr const char* kTwist[] = {"x", "y", "z", "rx", "ry", "rz"};
    std::string text = fmt::format(
        "-- Suggested by talus diagnose in the place of a smooth curve at {}: {}.\n"
        "-- {} is the {}. The formula says how, not why: its cause is not known.\neffect \"{}\" "
        "{{\n",
        e_.suspect.location, name_of(f), symbol_, s_.circumstance, s_.tag);
    text += fmt::format("  summary = \"{}\",\n  acts = \"{}\",", expression_of(f, symbol_),
                        to_string(effect.acts));
    if (place_.corrects == length || place_.corrects == angle) {
      const Dimension on = effect.acts == Acts::reading ? place_.corrects
                           : effect.on.empty()          ? place_.corrects
                                                        : effect.on[0];
      text += fmt::format(" on = {},", lua_dimension(on));
    }
    std::vector<std::string> needs;
    for (const Covariate c : effect.needs) needs.push_back("\"" + to_string(c) + "\"");
    if (!needs.empty()) text += fmt::format(" needs = {{ {} }},", join(needs));
    text += "\n";
    for (const Part& p : parts)
      text +=
          fmt::format("  {} = {}({}, {}, \"{}\"),\n", p.name, p.amount ? "amount" : "setting",
                      lua_dimension(p.dimension),
                      lua_value(p.amount ? place_.evidence.typical : p.value, p.dimension, units_),
                      p.amount ? "size"
                      : p.free ? "shapes it"
                               : "fixed");
    const std::string value = written(f, symbol_, "p.");
    text += fmt::format(
        "  value = function(around, p)\n    local {} = around.{}\n    return {}\n"
        "  end,\n}}\n",
        symbol_, around_,
        parts_of(effect.acts) == 6 ? fmt::format("{{ {} = {} }}", kTwist[place_.part], value)
                                   : value);
    return text;
  }

  void show(const Fit* fit) {
    s_.values.clear();
    for (const Part& p : parts_of_formula(s_.choice.ranked[0], place_)) {
      const Unit unit = p.dimension == place_.axis.dimension && !p.amount
                            ? Unit{place_.axis.unit, p.dimension, place_.axis.factor, 0}
                            : units_.of(p.dimension);
      ShownValue v{p.name, unit.text, p.value / unit.factor, std::nan("")};
      if (fit)
        for (const FittedValue& found : fit->parameters)
          if (found.name.starts_with(s_.tag) && found.name.ends_with("." + p.name))
            v.value = found.value / unit.factor, v.std = found.std / unit.factor;
      s_.values.push_back(std::move(v));
    }
  }

  std::string rivals(std::size_t from) const {
    std::vector<std::string> words;
    for (std::size_t i = from; i < s_.by.size() && words.size() < kTold; ++i)
      if (s_.by[i].second > 1 / kFormulaOdds &&
          std::find(words.begin(), words.end(), s_.by[i].first) == words.end())
        words.push_back(s_.by[i].first);
    return join(words, ", ");
  }

  void say() {
    using Outcome = FormulaChoice::Outcome;
    const FormulaChoice& c = s_.choice;
    const std::string best = s_.by.empty() ? "" : s_.by[0].first;
    switch (c.outcome) {
      case Outcome::wins:
        s_.statement = fmt::format(
            "{} ({}), {} the {}. Odds against the next formula{}: {}; a free curve beside it finds "
            "nothing more (p = {:.2g}). Up to what the geometry takes up.",
            s_.expression, best, symbol_, s_.circumstance,
            s_.by.size() > 1 ? " (" + s_.by[1].first + ")" : "",
            c.odds < 1e4 ? fmt::format("{:.0f}", c.odds) : "over 10000", c.beside_p);
        break;
      case Outcome::rivals:
        s_.statement = fmt::format("No formula wins: these do about as well: {}.", rivals(0));
        break;
      case Outcome::misfit:
        s_.statement = fmt::format(
            "No formula wins: the best of those tried ({}) leaves what a free curve explains ({}).",
            best,
            c.beside_p < kFormulaBeside
                ? fmt::format("p = {:.2g}", c.beside_p)
                : fmt::format("chi-square {:.4g} instead of {:.4g}, all refitted", s_.fit.chi2,
                              d_.search.best.chi2));
        break;
      case Outcome::curve:
        s_.statement = fmt::format(
            "No formula wins: the free curve is better than the best of those tried ({}).", best);
        break;
      case Outcome::nothing:
        s_.statement = "No formula wins: none can be tried on these recordings.";
        break;
    }
  }

  const Ground& ground_;
  const Diagnosis& d_;
  std::size_t index_;
  const Accepted& e_;
  const CurvePlace& place_;
  const UnitSystem& units_;
  std::string symbol_, around_;
  Suggestion s_;
};

}  // namespace

std::string expression_of(const FormulaFit& formula, const std::string& x) {
  return written(formula, x, "");
}

std::string name_of(const FormulaFit& formula) {
  std::vector<std::string> words;
  for (const FormulaTerm& t : formula.terms) words.push_back(t.shape->name);
  return join(words, " and ");
}

std::optional<Suggestion> suggest_formula(const Ground& ground, const Diagnosis& diagnosis,
                                          std::size_t i) {
  const Accepted& e = diagnosis.search.best.effects.at(i);
  if (!e.suspect.plugin->declaration.effect.unknown || e.way.amounts.empty()) return {};
  const std::optional<CurvePlace> place =
      curve_place(ground, diagnosis.search, i, diagnosis.program->units);
  if (!place) return {};
  return Suggester(ground, diagnosis, i, *place).run();
}

}  // namespace talus
