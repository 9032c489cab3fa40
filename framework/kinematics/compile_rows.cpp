#include <fmt/format.h>

#include <algorithm>

#include "framework/kinematics/compiler.h"

namespace talus {
namespace {

bool accepts(const Declaration& residual, Kind kind) {
  return std::find(residual.kinds.begin(), residual.kinds.end(), kind) != residual.kinds.end();
}

double positive_number(const Attribute& word, const char* what) {
  const Quantity q = parse_quantity(word.text, number, UnitSystem{}, word.place);
  if (q.value < 0)
    throw InputError(word.place, fmt::format("{} '{}'", what, word.text), "zero or more");
  return q.value;
}

}  // namespace

void Compiler::add_rows(const std::string& residual, int feature, const std::vector<Expr>& inputs,
                        double weight, int term) {
  const Plugin& plugin = *registry_.find(residual, Family::residual);
  const Feature& f = program_.features[feature];
  const int first = program_.chains[f.chain].first_slot;
  Matrix3<Expr> R;
  Vector3<Expr> p;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R[i][j] = leaf(first + 3 * i + j);
    p[i] = leaf(first + 9 + i);
  }
  const std::vector<Expr> values = plugin.rows(as_measured(feature, R, p), f.observed, inputs, {});
  const std::vector<Column>& columns = plugin.declaration.columns;
  if (values.size() != columns.size())
    throw InputError({plugin.origin, 0, 0},
                     fmt::format("residual '{}' gives {} rows, its declaration has {}", residual,
                                 values.size(), columns.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Row row{f.kind == Kind::scalar ? f.name
            : f.observed.angles    ? columns[i].suffix
                                   : f.name + "." + columns[i].suffix};
    row.dimension = columns[i].dimension;
    row.value = values[i];
    row.feature = feature;
    row.term = term;
    row.sigma = row.dimension == length  ? f.sigma_length
                : row.dimension == angle ? f.sigma_angle
                                         : f.sigma_number;
    row.weight = weight;
    program_.rows.push_back(std::move(row));
  }
  const bool turned = f.kind == Kind::frame || (f.kind == Kind::direction && !f.observed.angles);
  if (plugin.declaration.dependent && turned && f.sigma_angle)
    program_.features[feature].carried = true;
}

void Compiler::calibrate(const Element& element) {
  CalibrationSettings& s = program_.settings;
  const Attribute* residual = element.find("residual");
  if (!residual)
    throw InputError(element.place, "<calibrate> names no residual", "residual=\"position, ...\"");
  const auto residuals = split_list(*residual);
  std::vector<double> weights(residuals.size(), 1);
  if (const Attribute* w = element.find("weight")) {
    const auto words = split_list(*w);
    if (words.size() != residuals.size())
      throw InputError(w->place,
                       fmt::format("{} weights for {} residuals", words.size(), residuals.size()),
                       "one weight per residual");
    for (std::size_t i = 0; i < words.size(); ++i) weights[i] = positive_number(words[i], "weight");
    s.weighted = true;
    if (std::all_of(weights.begin(), weights.end(), [](double v) { return v == 0; }))
      throw InputError(w->place, "all weights are zero", "one above zero");
  } else if (s.weighted) {
    throw InputError(element.place, "one <calibrate> has weights, this one has none",
                     "weights in all or in none");
  }
  if (const Attribute* g = element.find("group"))
    for (const Attribute& word : split_list(*g)) s.groups.push_back(word.text);
  auto one_of = [&](const char* attribute, const std::vector<std::string>& words) -> int {
    const Attribute* a = element.find(attribute);
    if (!a) return -1;
    const std::string word = a->text.substr(0, a->text.find(' '));
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i] == word) return static_cast<int>(i);
    throw InputError(a->place, fmt::format("{}=\"{}\"", attribute, a->text),
                     "one of: " + join(words), nearest(word, words));
  };
  if (int i = one_of("objective", {"least_squares", "as_published"}); i >= 0)
    s.objective = static_cast<Objective>(i);
  if (int i = one_of("normalise", {"none", "fsr"}); i >= 0) s.full_scale = i == 1;
  if (int i = one_of("loss", {"none", "huber", "cauchy"}); i >= 0) {
    s.loss = static_cast<LossKind>(i);
    const Attribute& a = *element.find("loss");
    if (const std::size_t space = a.text.find(' '); space != std::string::npos)
      s.loss_scale = positive_number({a.name, a.text.substr(space + 1), a.place}, "loss scale");
    if (s.loss_scale == 0)
      throw InputError(a.place, fmt::format("loss=\"{}\"", a.text),
                       "a scale above zero, in sigmas");
  }
  for (std::size_t r = 0; r < residuals.size(); ++r) {
    const std::string& tag = residuals[r].text;
    const Plugin* plugin = registry_.find(tag, Family::residual);
    if (!plugin)
      throw InputError(residuals[r].place, fmt::format("no residual '{}'", tag),
                       "one of: " + join(registry_.tags(Family::residual)),
                       nearest(tag, registry_.tags(Family::residual)));
    std::vector<Expr> values;
    for (const Input& i : plugin->declaration.inputs) values.push_back(input(element, i).value);
    const int term = static_cast<int>(program_.terms.size());
    program_.terms.push_back(tag);
    int used = 0;
    auto use = [&](int f) {
      if (!taken_.emplace(tag, f).second && values.empty())
        throw InputError(
            residuals[r].place,
            fmt::format("residual '{}' of '{}' is taken twice", tag, program_.features[f].name),
            "each residual of a feature once");
      add_rows(tag, f, values, weights[r], term), ++used;
    };
    if (const Attribute* of = element.find("of")) {
      for (const Attribute& word : split_list(*of)) {
        std::vector<std::string> names;
        int found = -1;
        for (std::size_t f = 0; f < program_.features.size(); ++f) {
          names.push_back(program_.features[f].name);
          if (program_.features[f].name == word.text) found = static_cast<int>(f);
        }
        if (found < 0)
          throw InputError(word.place, fmt::format("no measured feature '{}'", word.text),
                           "one of: " + join(names), nearest(word.text, names));
        if (accepts(plugin->declaration, program_.features[found].kind))
          use(found);
        else if (split_list(*of).size() == 1) {
          std::vector<std::string> kinds;
          for (Kind k : plugin->declaration.kinds) kinds.push_back(to_string(k));
          throw InputError(residuals[r].place,
                           fmt::format("residual '{}' cannot be taken of '{}', which is a {}", tag,
                                       word.text, to_string(program_.features[found].kind)),
                           "a feature of kind " + join(kinds, " or "));
        }
      }
    } else {
      for (std::size_t f = 0; f < program_.features.size(); ++f)
        if (accepts(plugin->declaration, program_.features[f].kind)) use(static_cast<int>(f));
    }
    if (!used) {
      std::vector<std::string> measured, fitting;
      for (const Feature& f : program_.features)
        measured.push_back(f.name + " (" + to_string(f.kind) + ")");
      for (const std::string& other : registry_.tags(Family::residual))
        for (const Feature& f : program_.features)
          if (accepts(registry_.find(other, Family::residual)->declaration, f.kind)) {
            fitting.push_back(other);
            break;
          }
      throw InputError(residuals[r].place,
                       fmt::format("residual '{}' fits none of the measured features", tag),
                       fmt::format("for {}: {}", join(measured), join(fitting)));
    }
  }
}

void Compiler::default_rows() {
  for (std::size_t f = 0; f < program_.features.size(); ++f) {
    const Feature& feature = program_.features[f];
    for (const std::string& tag : registry_.find(feature.tag)->declaration.residuals) {
      const Plugin* plugin = registry_.find(tag, Family::residual);
      if (!plugin)
        throw InputError(
            feature.place,
            fmt::format("feature '{}' is judged by residual '{}', which is not registered",
                        feature.tag, tag));
      std::vector<Expr> values;
      for (const Input& i : plugin->declaration.inputs) values.push_back(Expr(i.otherwise));
      program_.terms.push_back(tag);
      add_rows(tag, static_cast<int>(f), values, 1, static_cast<int>(program_.terms.size()) - 1);
    }
  }
}

void Compiler::check_seen() const {
  std::set<int> seen;
  for (const auto& slots : row_support(program_)) seen.insert(slots.begin(), slots.end());
  for (const Parameter& p : program_.parameters)
    if (!seen.contains(p.slot))
      throw InputError(
          p.place, fmt::format("free parameter '{}' is seen by no residual", p.name),
          "it to be fixed (no tolerance, no '?'), or a measured feature whose chain it moves");
  for (const Unknown& u : program_.unknowns)
    if (!seen.contains(u.slot))
      throw InputError(u.place, fmt::format("unknown '{}' is seen by no residual", u.name),
                       "a measured feature whose chain it moves");
}

std::vector<std::vector<int>> row_support(const Program& program) {
  auto add = [](std::set<int>& slots, const Expr& e) {
    for (int slot : support(e)) slots.insert(slot);
  };
  std::vector<std::set<int>> of_chain(program.chains.size());
  for (std::size_t c = 0; c < program.chains.size(); ++c)
    for (const Motion<Expr>& m : program.chains[c].motions.motions()) {
      add(of_chain[c], m.amount);
      for (int i = 0; i < 3; ++i) {
        add(of_chain[c], m.translation[i]);
        for (int j = 0; j < 3; ++j) add(of_chain[c], m.rotation[i][j]);
      }
    }
  std::vector<std::vector<int>> result;
  for (const Row& row : program.rows) {
    std::set<int> own, all;
    add(own, row.value);
    for (int slot : own) {
      auto chain = std::find_if(program.chains.begin(), program.chains.end(), [&](const Chain& c) {
        return slot >= c.first_slot && slot < c.first_slot + 12;
      });
      if (chain == program.chains.end())
        all.insert(slot);
      else
        all.insert(of_chain[chain - program.chains.begin()].begin(),
                   of_chain[chain - program.chains.begin()].end());
    }
    result.emplace_back(all.begin(), all.end());
  }
  return result;
}

// Of one feature, rows with and without a sigma cannot be weighed against each other.
void Compiler::check_sigmas() const {
  if (program_.settings.weighted) return;
  for (const Row& row : program_.rows) {
    const Feature& f = program_.features[row.feature];
    if (!row.sigma && (f.sigma_length || f.sigma_angle || f.sigma_number))
      throw InputError(f.place,
                       fmt::format("'{}' has no sigma for {}, but one of another kind", f.name,
                                   describe(row.dimension)),
                       "a sigma of each kind, such as sigma=\"0.005 mm, 0.002 deg\", or none");
  }
}

Program Compiler::run() {
  collect_effects();
  frames();
  for (const Element& e : model_.root.children) {
    if (e.tag == "parameter" || e.tag == "unknown" || registry_.find(e.tag, Family::sensor))
      resolve(e.name(), e.place);
    else if (e.tag == "constant")
      resolve(e.name(), e.place);
  }
  for (const Element& e : model_.root.children)
    if (registry_.find(e.tag, Family::shape)) shape(e);
  for (const Element& e : model_.root.children)
    if (e.tag == "datum") datum(e);
  for (const Element& e : model_.root.children)
    if (e.tag == "limb") limb(e);
  for (const Element& e : model_.root.children) {
    if (e.tag == "chain")
      for (const Element& joint : e.children) link(joint);
    if (e.tag == "gravity") gravity(e);
    if (e.tag == "payload") payload(e);
  }
  for (const Element& e : model_.root.children)
    if (registry_.find(e.tag, Family::feature)) feature(e);
  bool any = false;
  for (const Element& e : model_.root.children)
    if (e.tag == "calibrate") calibrate(e), any = true;
  if (!any) default_rows();
  check_effects();
  if (!recorded_) check_seen(), forget_unused_covariates();
  check_sigmas();
  return std::move(program_);
}

Program compile(const Model& model, const Registry& registry) {
  return Compiler(model, registry).run();
}

Program compile_with_fields(const Model& model, const Registry& registry,
                            const Recorded& recorded) {
  Compiler compiler(model, registry);
  compiler.with_fields(recorded);
  return compiler.run();
}

}  // namespace talus
