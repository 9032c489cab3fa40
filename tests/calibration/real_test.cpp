// Recordings of real devices, where they lie beside the repository (they are not part of it): what
// is left after the calibration of the rigid model, held out, against figures worked out elsewhere.
#include <cmath>

#include "tests/support/cases.h"
#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

struct Figures {
  double fit = 0, check = 0, both = 0;  // root mean square length of a pose's residual
  bool converged = true;
};

// Averages over `seeds` splits, each at random but for the groups.
Figures figures(const std::string& model_file, const std::string& data, double points = 1,
                const std::vector<std::string>& groups = {}, int seeds = 5) {
  const Program program = program_of(shipped(model_file));
  const Recordings recordings = read_recordings(beside + "data/" + data);
  Figures mean;
  for (int seed = 1; seed <= seeds; ++seed) {
    SplitOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    if (!groups.empty()) options.group_columns = {groups};
    for (const Reading& r : program.readings) options.reading_columns.push_back(r.column);
    const Split split = split_rows(recordings, options);
    const Fit fit = calibrate(program, recordings, split, {.threads = 2, .restarts = 1});
    mean.converged &= fit.converged;
    auto squares = [&](const Eigen::MatrixXd& raw) { return raw.squaredNorm() / points; };
    const Eigen::MatrixXd &a = fit.residuals_fit.raw, &b = fit.residuals_check.raw;
    mean.fit += squares(a) / static_cast<double>(a.rows()) / seeds;
    mean.check += squares(b) / static_cast<double>(b.rows()) / seeds;
    mean.both += (squares(a) + squares(b)) / static_cast<double>(a.rows() + b.rows()) / seeds;
  }
  mean.fit = std::sqrt(mean.fit), mean.check = std::sqrt(mean.check);
  mean.both = std::sqrt(mean.both);
  MESSAGE(data, ": fitted ", mean.fit, ", held out ", mean.check, ", both ", mean.both);
  return mean;
}

}  // namespace

// The figures are those of a rigid chain worked out with linear algebra alone, each a little
// rounded up.
TEST_CASE("rigid models of six recorded devices leave what such models leave") {
  if (!there("data")) return;
  const Figures motoman = figures("arm-motoman/model.xml", "ctu-motoman-leica/left.csv", 1, {}, 20);
  CHECK(motoman.converged);
  CHECK(motoman.both <= 0.076);   // mm
  CHECK(motoman.check <= 0.080);  // a single split may have 0.072
  const Figures ur10 = figures("arm-ur10/model.xml", "ipa-ur10-tmac/A.csv");
  CHECK(ur10.converged);
  CHECK(ur10.both <= 0.445);
  const Figures justin = figures("upper-body-justin/model.xml", "dlr-agile-justin/right.csv");
  CHECK(justin.converged);
  CHECK(justin.check <= 13.5);
  const double arcsec2 = std::pow(deg / 3600, 2);
  const Figures stars = figures("mount-altaz/model.xml", "mmt-telescope-pointing/2021-08-21.csv",
                                arcsec2, {"star"}, 20);
  CHECK(stars.converged);
  CHECK(stars.check <= 4.3);
  const Figures nothing_missing = figures(
      "mount-altaz/model.xml", "mmt-telescope-pointing/2023-07-02.csv", arcsec2, {"star"}, 20);
  CHECK(nothing_missing.check <= 1.6);
  const Figures knee = figures("knee-two-axis/step-up.xml", "sta-open-knee/NTU_stepUp.csv", 4);
  CHECK(knee.converged);
  CHECK(knee.check <= 4.4);
  const Figures panda =
      figures("arm-panda/model.xml", "mukca-panda-socket/panda_3.csv", 1, {"location"});
  CHECK(panda.converged);
  CHECK(panda.check <= 0.22);
}

// What another program found for the rigid model on simulated recordings with one effect or none.
TEST_CASE("chi-square of the rigid fit is what another program found") {
  each_case([](const std::string& id, const nlohmann::json& key, const std::string& model,
               const std::string& file) {
    const Program program = program_of(model);
    const Recordings recordings = read_recordings(file);
    const Fit fit = calibrate(program, recordings, split_rows(recordings, {}), {.threads = 2});
    CAPTURE(fit.stopped);
    CAPTURE(fit.iterations);
    CAPTURE(fit.chi2);
    CHECK(fit.converged);
    CHECK(fit.rows_missing == 0);
    // Within 1.5 % or 5: tolerances count as priors here. Two are known to differ more: d006, where
    // we find a deeper minimum, and d008, where a strong effect draws numbers out of their
    // tolerances.
    const double expected = key["rigid_chi2"], held = key["rigid_check_rms"];
    if (id == "d006") {
      CHECK(fit.chi2 < expected);
    } else if (id == "d008") {
      CHECK(fit.chi2 < 1.25 * expected);
      CHECK(fit.heldout_rms < held);
    } else {
      CHECK(std::abs(fit.chi2 - expected) < std::max(5.0, 0.015 * expected));
      CHECK(fit.heldout_rms == doctest::Approx(held).epsilon(0.025));
    }
    // There all parameters count; here what only its tolerance holds does not.
    const double more = fit.dof - key["rigid_dof"].get<double>();
    CHECK(more > -1);
    CHECK(more < static_cast<double>(fit.seen.unseen.size()) + 1);
    // Recordings of rigid devices are explained by the instruments, others are not.
    if (key["effects"].empty() || key["strength"] == "absorbed") {
      CHECK(fit.chi2_p > 0.01);
    } else {
      CHECK(fit.chi2_p < 1e-6);
    }
  });
}
