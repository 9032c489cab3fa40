#include "framework/diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "framework/diagnosis/block_covariates.h"
#include "framework/diagnosis/tails.h"

namespace talus {
namespace {

// Below so many sigmas of a pose, what was found is a hint: nobody would notice it in one
// recording.
constexpr double kNoticeable = 1;
constexpr double kSure = 0.8;  // a name is claimed from this probability on
// A misfit that cannot be chance nor a small error of the stated noise.
constexpr double kImpossible = 1e-6, kPlain = 1.5;

Eigen::VectorXd squares(const Problem::Residuals& r) {
  return r.whitened.size() > 0 ? Eigen::VectorXd(r.whitened.rowwise().squaredNorm())
                               : Eigen::VectorXd(0);
}

// Two effects of one joint: of its sensor, axis or link.
bool one_place(const Accepted& a, const Accepted& b) {
  return !a.suspect.joint.empty() && a.suspect.joint == b.suspect.joint;
}

}  // namespace

std::string to_string(Verdict verdict) {
  static constexpr const char* names[] = {"nothing-missing", "explained", "ambiguous",
                                          "unknown-physics", "bad-data"};
  return names[static_cast<int>(verdict)];
}

namespace {

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
      if (reexamine()) seek(options_.search.most_effects);
    }
    findings();
    progress("judging", 0.9);
    judge();
    verdict();
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
    FaultOptions fault_options;
    fault_options.threads = options_.fit.threads;
    fault_options.seed = options_.fit.seed;
    Faults faults =
        find_faults(*d_.program, recordings_, split_, fit ? &*fit : nullptr, fault_options);
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
    known_ = with_circumstances(model_, registry_, *d_.program, recordings_, clean_.x);
    ground_ = {&model_, &registry_, &known_, split_.fit, options_.fit.threads};
    SearchOptions search_options = options_.search;
    search_options.progress = options_.progress;
    search_options.most_effects = most_effects;
    d_.search = search(ground_, trial_of(ground_, clean_), search_options);
  }

  // With the physics found, are these still the blunders? True where others are.
  bool reexamine() {
    const Trial& best = d_.search.best;
    if (best.effects.empty()) return false;
    std::vector<double> x;
    for (const Parameter& p : best.program->parameters) x.push_back(best.values.at(p.name));
    for (const FittedValue& v : clean_.shared) x.push_back(best.values.at(v.name));
    Outliers again = find_outliers(*best.program, known_, whole_, x, outlier_options());
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

  // What was found, before any row held out is looked at.
  void findings() {
    const Search& found = d_.search;
    const double poses = static_cast<double>(std::max<std::size_t>(1, split_.fit.size()));
    const double gain = found.null.cost2 - found.best.cost2;
    const double left = std::max(1.0, found.best.cost2 / std::max(1.0, found.last->dof));
    claimed_ = !found.best.effects.empty() &&
               std::sqrt(std::max(0.0, gain) / left / poses) > kNoticeable && !drifting();
    for (std::size_t i = 0; i < found.best.effects.size(); ++i)
      (claimed_ ? d_.findings : d_.hints)
          .push_back(finding(found.best.effects[i], found.members[i], poses));
  }

  // Several things that wander with the time, each by itself and some in no known way: that is
  // noise which is not independent from pose to pose.
  bool drifting() {
    const std::vector<Accepted>& effects = d_.search.best.effects;
    bool curve = false;
    for (const Accepted& e : effects) {
      const EffectTraits& effect = e.suspect.plugin->declaration.effect;
      if (effect.needs.empty() ||
          !std::all_of(effect.needs.begin(), effect.needs.end(), [](Covariate c) {
            return c == Covariate::time || c == Covariate::pose || c == Covariate::since;
          }))
        return false;
      curve |= effect.unknown;
    }
    if (effects.size() < 2 || (!curve && effects.size() < 3)) return false;
    d_.faults.push_back(
        {"correlated-noise", "measurement",
         fmt::format("The noise is not independent from pose to pose: it takes {} separate drifts "
                     "and steps to follow it.",
                     effects.size())});
    return true;
  }

  Finding finding(const Accepted& e, const Member& m, double poses) const {
    Finding f;
    f.accepted = e;
    f.effect = e.suspect.effect, f.location = e.suspect.location;
    f.driver = e.way.driver;
    f.parameters = shown_values(e, d_.program->units);
    f.delta_chi2 = m.gain;
    f.delta_bic = m.gain - static_cast<double>(e.amounts.size()) *
                               std::log(std::max<double>(2, static_cast<double>(clean_.rows_fit)));
    f.p_value = m.gate.family_p;
    f.sigmas = std::sqrt(std::max(0.0, m.gain) / poses);
    for (const Alternative& a : m.alternatives) {
      const Suspect& s = a.effect.suspect;
      if (s.plugin == e.suspect.plugin && s.at == e.suspect.at)
        f.probability = a.probability;
      else if (a.probability > 1e-4)
        f.rivals.push_back({s.effect, s.location, a.probability});
    }
    return f;
  }

  // The extended model as a calibration, with the rows held out.
  void judge() {
    d_.after = clean_;
    d_.program_after = d_.program;
    if (claimed_) {
      const Trial& best = d_.search.best;
      d_.extended_model = extended(model_, best.effects, d_.program->units);
      auto after = std::make_shared<Program>(compile(d_.extended_model, registry_));
      FitOptions fit_options = options_.fit;
      fit_options.restarts = 0;
      for (const Parameter& p : after->parameters)
        fit_options.start.push_back(best.values.at(p.name));
      for (const FittedValue& v : clean_.shared)
        fit_options.start.push_back(best.values.at(v.name));
      d_.after = calibrate(*after, known_, split_, fit_options);
      d_.program_after = std::move(after);
    }
    if (claimed_) d_.blocks = blocks();
    const Eigen::VectorXd before = squares(clean_.residuals_check),
                          after = squares(d_.after.residuals_check);
    if (before.size() == after.size() && before.size() > 0) {
      const double rows =
          before.sum() / std::pow(clean_.heldout_rms, 2) / static_cast<double>(before.size());
      d_.heldout = held_out(before, after, rows, options_.fit.seed);
    }
    for (Finding& f : d_.findings) {
      f.heldout_before = clean_.heldout_rms;
      f.heldout_after = d_.after.heldout_rms;
    }
    FaultOptions fault_options;
    fault_options.threads = options_.fit.threads;
    fault_options.seed = options_.fit.seed;
    d_.noise = judge_noise(*d_.program_after, known_, split_.fit, d_.after.x, fault_options);
    d_.faults.insert(d_.faults.end(), d_.noise.faults.begin(), d_.noise.faults.end());
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

  void verdict() {
    const bool faulty =
        !d_.outliers.found.empty() ||
        std::any_of(d_.faults.begin(), d_.faults.end(), [](const Fault& f) { return !f.note; });
    std::vector<std::string> words;
    for (const Fault& f : d_.faults)
      if (!f.note) words.push_back(f.statement);
    if (!d_.outliers.found.empty()) words.push_back(d_.outliers.statement);
    const bool misfit =
        d_.after.noise_known && d_.after.chi2_p < kImpossible && d_.after.noise_scale > kPlain;
    if (d_.findings.empty()) {
      d_.verdict = faulty ? Verdict::bad_data : Verdict::nothing_missing;
      d_.statement = faulty ? join(words, " ") + " Nothing else is seen."
                            : "Nothing is missing that these recordings could show.";
      if (!faulty && misfit) {
        d_.verdict = Verdict::ambiguous;
        d_.statement = fmt::format(
            "Something is missing: residuals are {:.3g} sigmas. No candidate explains it. {}",
            d_.after.fit_rms, d_.noise.statement);
      }
      return;
    }
    bool unknown = false, sure = true;
    std::vector<std::string> found;
    for (Finding& f : d_.findings) {
      unknown |= f.effect == "unknown";
      sure &= f.probability >= kSure;
      for (const Finding& other : d_.findings)
        unknown |= &f != &other && one_place(f.accepted, other.accepted);
      f.statement =
          fmt::format("{} at {} (probability {:.2f})", f.effect, f.location, f.probability);
      found.push_back(f.statement);
    }
    d_.verdict = unknown ? Verdict::unknown_physics
                 : sure  ? Verdict::explained
                         : Verdict::ambiguous;
    d_.statement =
        join(found, " and ") + fmt::format("; rows held out: {:.3g} sigmas instead of {:.3g}.",
                                           d_.after.heldout_rms, clean_.heldout_rms);
    if (!words.empty()) d_.statement += " " + join(words, " ");
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
