#include "framework/diagnosis/diagnosis.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "framework/diagnosis/block_covariates.h"
#include "framework/diagnosis/blunders.h"
#include "framework/diagnosis/verdict.h"

namespace talus {
namespace {

constexpr double kNoBetter = 0.05;  // chance of gains as large: where on average there is a loss

constexpr double kImpossible = 1e-6;  // chance of a misfit

Eigen::VectorXd squares(const Problem::Residuals& r) {
  return r.whitened.size() > 0 ? Eigen::VectorXd(r.whitened.rowwise().squaredNorm())
                               : Eigen::VectorXd(0);
}

// One diagnosis in the making.
class Diagnoser {
 public:
  Diagnoser(const Model& model, const Registry& registry, const Recordings& recordings,
            const Split& split, const DiagnosisOptions& options)
      : model_(model),
        registry_(registry),
        options_(options),
        recordings_(recordings),
        split_(split) {}

  Diagnosis run() {
    const auto begin = std::chrono::steady_clock::now();
    progress("calibrating", 0);
    auto program = std::make_shared<Program>(compile(model_, registry_));
    d_.program = program;
    d_.extended_model = model_;
    ordinary();
    // Blunders are looked for again beside the first effect, before others could explain them, and
    // once more beside all.
    seek(1);
    if (!d_.search.best.effects.empty()) {
      reexamine();
      seek(options_.search.most_effects);
      if (reexamine() || by_loads()) seek(options_.search.most_effects);
    }
    claims();
    progress("judging", 0.9);
    judge();
    conclude(d_);
    d_.recordings = std::move(recordings_), d_.split = std::move(split_);
    d_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(d_);
  }

 private:
  void progress(const std::string& step, double share) const {
    if (options_.progress) options_.progress(step, share);
  }

  // Faults of columns and rows, then blunders.
  void ordinary() {
    std::optional<Fit> fit;
    try {
      fit = calibrate(*d_.program, recordings_, split_, options_.fit);
      d_.baseline = *fit;
    } catch (const InputError&) {
      // Perhaps a fault of a column; if none is found it is thrown again below.
    }
    Faults faults =
        find_faults(*d_.program, recordings_, split_, fit ? &*fit : nullptr, fault_options());
    d_.faults = faults.found;
    bool changed = faults.corrected || !faults.left_out.empty();
    if (faults.corrected) recordings_ = std::move(faults.recordings);
    std::erase_if(split_.fit, [&](std::size_t row) {
      return std::find(faults.left_out.begin(), faults.left_out.end(), row) !=
             faults.left_out.end();
    });
    if (!fit || changed) clean_ = calibrate(*d_.program, recordings_, split_, options_.fit);
    if (!fit) d_.baseline = clean_;
    if (fit && !changed) clean_ = *fit;
    whole_ = split_;
    d_.outliers = find_outliers(*d_.program, recordings_, whole_, clean_.x, outlier_options());
    if (!d_.outliers.found.empty()) leave_out(), changed = true;
    if (changed) d_.clean = clean_;
  }

  OutlierOptions outlier_options() const {
    OutlierOptions o;
    o.threads = options_.fit.threads;
    o.seed = options_.fit.seed;
    return o;
  }

  void leave_out() {
    split_ = whole_;
    split_.fit = d_.outliers.keep(whole_.fit);
    split_.check = d_.outliers.keep(whole_.check);
    clean_ = calibrate(*d_.program, recordings_, split_, options_.fit);
    d_.clean = clean_;
  }

  void seek(int most_effects) {
    known_ = with_circumstances(model_, registry_, *d_.program, recordings_, geometry());
    ground_ = {&model_, &registry_, &known_, split_.fit, options_.fit.threads, {}};
    ground_.scale = scale_of_rows(ground_, clean_);
    SearchOptions search_options = options_.search;
    search_options.progress = options_.progress;
    search_options.most_effects = most_effects;
    d_.search = search(ground_, trial_of(ground_, clean_), search_options);
  }

  bool by_loads() const {
    return std::any_of(d_.search.best.effects.begin(), d_.search.best.effects.end(),
                       [](const Accepted& e) {
                         const auto& needs = e.suspect.plugin->declaration.effect.needs;
                         return std::any_of(needs.begin(), needs.end(), [](Covariate c) {
                           return c == Covariate::load || c == Covariate::tip_load;
                         });
                       });
  }

  // At which loads are worked out: as fitted beside what was found; before anything was found, as
  // the model has it where the fit is impossible, since what is missing has bent it then.
  std::vector<double> geometry() const {
    std::vector<double> x;
    const bool bent = clean_.noise_known && clean_.chi2_p < kImpossible;
    for (std::size_t i = 0; i < d_.program->parameters.size(); ++i) {
      const Parameter& p = d_.program->parameters[i];
      const auto found = d_.search.best.values.find(p.name);
      x.push_back(!d_.search.best.effects.empty() && found != d_.search.best.values.end()
                      ? found->second
                  : bent ? p.nominal.value
                         : clean_.x[i]);
    }
    return x;
  }

  // With the physics found, are these still the blunders? True where others are.
  bool reexamine() {
    const Trial& best = d_.search.best;
    if (best.effects.empty()) return false;
    Outliers again = blunders_beside(ground_, best, whole_, outlier_options());
    auto rows = [](const Outliers& o) {
      std::vector<std::size_t> r;
      for (const Outlier& one : o.found) r.push_back(one.row);
      return r;
    };
    if (rows(again) == rows(d_.outliers)) {
      d_.outliers = std::move(again);
      return false;
    }
    d_.outliers = std::move(again);
    leave_out();
    return true;
  }

  FaultOptions fault_options() const {
    FaultOptions o;
    o.threads = options_.fit.threads;
    o.seed = options_.fit.seed;
    return o;
  }

  // What was found, before any row held out is looked at.
  void claims() {
    const Trial& best = d_.search.best;
    if (!best.effects.empty())
      note(without_correlated(
          ground_, judge_noise(*best.program, known_, split_.fit, best.x, fault_options()),
          d_.search, options_.search));
    Claims claims = claims_of(d_.search, split_.fit.size(), clean_.rows_fit, d_.program->units);
    d_.findings = std::move(claims.findings), d_.hints = std::move(claims.hints);
    note(claims.faults);
    claimed_ = !d_.findings.empty();
  }

  void note(const std::vector<Fault>& faults) {
    d_.faults.insert(d_.faults.end(), faults.begin(), faults.end());
  }

  // The extended model as a calibration, with the rows held out.
  void judge() {
    d_.after = clean_;
    d_.program_after = d_.program;
    if (claimed_) {
      if (by_loads())
        known_ = with_circumstances(model_, registry_, *d_.program, recordings_, geometry());
      const Trial& best = d_.search.best;
      d_.extended_model = extended(model_, best.effects, d_.program->units);
      auto after = std::make_shared<Program>(compile(d_.extended_model, registry_));
      FitOptions fit_options = options_.fit;
      fit_options.restarts = 0;
      fit_options.start = best.x;
      d_.after = calibrate(*after, known_, split_, fit_options);
      d_.program_after = std::move(after);
    }
    compare();
    const HeldOut& h = d_.heldout;
    if (claimed_ && (h.after_low > h.before || (h.after > h.before && h.p_value > kNoBetter))) {
      d_.withdrawn = true;
      d_.extended_model = model_;
      d_.after = clean_, d_.program_after = d_.program;
      compare();
    } else if (claimed_) {
      d_.blocks = blocks();
    }
    for (Finding& f : d_.findings) {
      f.heldout_before = clean_.heldout_rms;
      f.heldout_after = d_.after.heldout_rms;
    }
    // What is too small to be claimed is not noise either.
    const Trial& best = d_.search.best;
    const bool hinted = !claimed_ && !d_.hints.empty() &&
                        std::none_of(d_.faults.begin(), d_.faults.end(),
                                     [](const Fault& f) { return f.kind == "correlated-noise"; });
    d_.noise = judge_noise(hinted ? *best.program : *d_.program_after, known_, split_.fit,
                           hinted ? best.x : d_.after.x, fault_options());
    note(d_.noise.faults);
  }

  void compare() {
    const Eigen::VectorXd before = squares(clean_.residuals_check),
                          after = squares(d_.after.residuals_check);
    if (before.size() != after.size() || before.size() == 0) return;
    const double rows =
        before.sum() / std::pow(clean_.heldout_rms, 2) / static_cast<double>(before.size());
    d_.heldout = held_out(before, after, rows, options_.fit.seed);
  }

  // By region of what the findings depend on, and by session.
  std::vector<Block> blocks() const {
    std::vector<Accepted> effects;
    for (const Finding& f : d_.findings) effects.push_back(f.accepted);
    const Program fields = compile_with_fields(
        model_, registry_,
        [this](const std::string& column) { return known_.find(column) != nullptr; });
    return held_out_blocks(
        {d_.program.get(), clean_.x}, {d_.program_after.get(), d_.after.x}, known_, split_,
        block_covariates(effects, fields, known_, *d_.program_after, d_.after), options_.fit);
  }

  const Model& model_;
  const Registry& registry_;
  const DiagnosisOptions& options_;
  Recordings recordings_, known_;  // corrected; with covariates and loads
  Split split_, whole_;            // without blunders; with them
  Fit clean_;                      // the model as it was given, to what is right in the recordings
  Ground ground_;
  bool claimed_ = false;
  Diagnosis d_;
};

}  // namespace

Diagnosis diagnose(const Model& model, const Registry& registry, const Recordings& recordings,
                   const Split& split, const DiagnosisOptions& options) {
  return Diagnoser(model, registry, recordings, split, options).run();
}

}  // namespace talus
