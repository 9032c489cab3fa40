#include "framework/diagnosis/block_covariates.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

class Collector {
 public:
  Collector(const Program& fields, const Recordings& recordings, const Program& program,
            const Fit& fit)
      : fields_(fields), recordings_(recordings), program_(program), fit_(fit) {}

  void effect(const Accepted& e) {
    if (!e.suspect.joint.empty()) joint(e.suspect.joint);
    if (!e.way.driver.empty()) joint(e.way.driver);
    const EffectTraits& traits = e.suspect.plugin->declaration.effect;
    for (const Covariate c : traits.needs) covariate(c);
    if (!traits.onset.empty()) covariate(traits.onset_of);
  }

  std::vector<BlockCovariate> run() { return std::move(found_); }

 private:
  void covariate(Covariate c) {
    if (c == Covariate::time || c == Covariate::since || c == Covariate::pose)
      column(recordings_.find("time") ? "time" : "pose");
    if (c == Covariate::temperature) column("temperature");
    if (c == Covariate::load || c == Covariate::tip_load)
      for (const Payload& p : fields_.payloads) column(p.column);
  }

  // The readings that correct or make a joint's coordinate, and the unknowns that it is made of.
  void joint(const std::string& name) {
    for (const EffectPlace& place : fields_.places) {
      if (place.joint != name) continue;
      if (place.acts == Acts::reading) column(place.column);
      if (place.acts != Acts::coordinate || place.around.coordinate.is_constant()) continue;
      const std::vector<std::int32_t> slots = support(place.around.coordinate);
      for (const Unknown& u : fields_.unknowns)
        if (u.per.empty() && std::find(slots.begin(), slots.end(), u.slot) != slots.end())
          unknown(u);
    }
  }

  void column(const std::string& name) {
    if (const RecordedColumn* c = recordings_.find(name)) add(block_covariate(*c));
  }

  void unknown(const Unknown& u) {
    const std::vector<int> latent = Groups(program_, recordings_).latent;
    const auto of = std::find_if(latent.begin(), latent.end(), [&](int i) {
      return program_.unknowns[static_cast<std::size_t>(i)].name == u.name;
    });
    if (of == latent.end()) return;
    const auto at = static_cast<Eigen::Index>(of - latent.begin());
    const Unit unit = fields_.units.of(u.dimension);
    BlockCovariate c{u.name, unit.text, unit.factor,
                     std::vector<double>(recordings_.rows(), std::nan(""))};
    for (const Problem::Residuals* r : {&fit_.residuals_fit, &fit_.residuals_check})
      for (std::size_t k = 0; k < r->poses.size(); ++k)
        c.values[r->poses[k]] = r->latent(static_cast<Eigen::Index>(k), at);
    add(std::move(c));
  }

  void add(BlockCovariate c) {
    if (std::none_of(found_.begin(), found_.end(),
                     [&](const BlockCovariate& known) { return known.name == c.name; }))
      found_.push_back(std::move(c));
  }

  const Program& fields_;
  const Recordings& recordings_;
  const Program& program_;
  const Fit& fit_;
  std::vector<BlockCovariate> found_;
};

}  // namespace

std::vector<BlockCovariate> block_covariates(const std::vector<Accepted>& effects,
                                             const Program& fields, const Recordings& recordings,
                                             const Program& program, const Fit& fit) {
  Collector collector(fields, recordings, program, fit);
  for (const Accepted& e : effects) collector.effect(e);
  return collector.run();
}

}  // namespace talus
