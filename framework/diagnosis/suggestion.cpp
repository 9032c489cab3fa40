#include "framework/diagnosis/suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/covariate_axes.h"
#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"
#include "framework/dsl/read.h"

namespace talus {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kCells = 3000;
constexpr std::size_t kTold = 4;  // rivals named

// What the curve of a finding is a function of, and of what it is a correction.
struct Site {
  CovariateAxis axis;
  int part = -1;
  CurveEvidence evidence;
  Dimension corrects;
};

// The effect with one of its amounts at one, as a function of the circumstances.
std::vector<Expr> act_of(const Suspect& suspect, const Way& way, const EffectPlace& place,
                         const std::string& amount) {
  std::vector<Expr> inputs;
  for (const Input& i : suspect.plugin->declaration.inputs)
    if (i.role == Role::amount)
      inputs.emplace_back(i.name == amount ? 1 : 0);
    else if (i.role == Role::borrowed)
      inputs.push_back(place.inputs.at(i.name));
    else
      inputs.emplace_back(way.settings.contains(i.name) ? way.settings.at(i.name) : i.otherwise);
  return suspect.plugin->act(place.around, inputs, way.choices);
}

// The part of the correction that the curve is; -1 where it is several.
int part_of(const Accepted& e, const EffectPlace& place) {
  int part = -1;
  const std::vector<Expr> u = act_of(e.suspect, e.way, place, e.way.amounts.at(0));
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (u[i].is_constant()) continue;
    if (part >= 0) return -1;
    part = static_cast<int>(i);
  }
  return part;
}

// The columns of the effect's own amounts, and their priors' rows.
void take_out(Linearised& at, const Accepted& e) {
  Baseline& base = at.baseline;
  const std::string owner = e.suspect.plugin->declaration.tag + "_" + e.suspect.at;
  std::vector<int> columns, rows, pose;
  std::vector<bool> drop(static_cast<std::size_t>(base.rows.size()), false);
  for (std::size_t c = 0; c < at.parameters.size(); ++c) {
    const auto p = static_cast<std::size_t>(at.parameters[c]);
    const auto column = static_cast<Index>(c);
    if (p >= at.program->parameters.size() || at.program->parameters[p].element != owner) {
      columns.push_back(static_cast<int>(c));
      continue;
    }
    for (Index r = 0; r < base.rows.size(); ++r)
      if (base.pose[static_cast<std::size_t>(r)] < 0 && base.columns(r, column) != 0)
        drop[static_cast<std::size_t>(r)] = true;
  }
  for (std::size_t r = 0; r < drop.size(); ++r)
    if (!drop[r]) rows.push_back(static_cast<int>(r)), pose.push_back(base.pose[r]);
  base.rows = VectorXd(base.rows(rows));
  base.columns = MatrixXd(base.columns(rows, columns));
  base.pose = std::move(pose);
}

std::optional<Site> place_of(const Ground& ground, const Search& search, std::size_t i,
                             const UnitSystem& units) {
  // Linear where the fit with the curve ended; the curve is then taken out of the rows.
  const Accepted& e = search.best.effects.at(i);
  StageOptions options;
  options.suspects.only = {e.suspect.plugin->declaration.tag};
  Linearised at = linearised(ground, search.best, options);
  const Suspect* suspect = suspect_of(at, e);
  if (!suspect) return {};
  const EffectPlace& place = at.program->places[static_cast<std::size_t>(suspect->places[0])];
  const std::vector<CovariateAxis> axes = covariate_axes(e, place, *at.program, units);
  if (axes.size() != 1 || suspect->places.size() != 1) return {};
  Site r{axes[0], part_of(e, place), {}, place.dimension};
  if (r.part < 0) return {};
  if (parts_of(place.acts) == 6) r.corrects = r.part < 3 ? length : angle;
  CurveEvidence& c = r.evidence;
  c.of = r.axis.dimension;
  c.x = values_at(at, r.axis.value);
  if (!c.x.allFinite() || !(c.x.maxCoeff() > c.x.minCoeff())) return {};
  for (std::size_t w = 0; w < at.suspects.ways.size(); ++w) {
    const Way& way = at.suspects.ways[w];
    if (&at.suspects.suspects[static_cast<std::size_t>(way.suspect)] != suspect ||
        way.choices != e.way.choices)
      continue;
    MatrixXd pieces(c.x.size(), static_cast<Index>(way.amounts.size()));
    for (std::size_t a = 0; a < way.amounts.size(); ++a)
      pieces.col(static_cast<Index>(a)) = values_at(
          at, act_of(*suspect, way, place, way.amounts[a])[static_cast<std::size_t>(r.part)]);
    c.curves.push_back(std::move(pieces));
    c.typical = way.typical.at(0);
  }
  VectorXd curve = VectorXd::Zero(c.x.size());
  for (std::size_t a = 0; a < e.way.amounts.size(); ++a)
    curve +=
        e.amounts[a] * values_at(at, act_of(*suspect, e.way, place,
                                            e.way.amounts[a])[static_cast<std::size_t>(r.part)]);
  const VectorXd f = at.columns.col(place.first_field + r.part);
  for (Index k = 0; k < f.size(); ++k)
    at.baseline.rows[k] -= f[k] * curve[at.baseline.pose[static_cast<std::size_t>(k)]];
  take_out(at, e);
  Candidates none;
  none.columns.resize(f.size(), 0);
  const Screen screen(std::move(at.baseline), std::move(none));
  const Screen::Inside& in = screen.inside();
  c.weight = c.wanted = VectorXd::Zero(c.x.size());
  c.absorbed = MatrixXd::Zero(in.Q.cols(), c.x.size());
  for (std::size_t s = 0; s < in.order.size(); ++s) {
    const int k = in.pose[s];
    const double column = f[in.order[s]];
    c.weight[k] += column * column;
    c.wanted[k] -= column * in.rest[static_cast<Index>(s)];
    c.absorbed.col(k) += column * in.Q.row(static_cast<Index>(s)).transpose();
  }
  c.chi2 = screen.chi2(), c.freedom = screen.freedom();
  c.rows = static_cast<double>(in.order.size());
  c.noise_known = in.noise_known;
  c = in_cells(c, kCells);
  return r;
}

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

std::vector<Part> parts_of_formula(const FormulaFit& f, const Site& place) {
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
  Suggester(const Ground& ground, const Diagnosis& d, std::size_t i, const Site& place)
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
  const Site& place_;
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
  const std::optional<Site> place = place_of(ground, diagnosis.search, i, diagnosis.program->units);
  if (!place) return {};
  return Suggester(ground, diagnosis, i, *place).run();
}

}  // namespace talus
