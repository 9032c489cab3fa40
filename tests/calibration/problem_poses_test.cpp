// What a problem says pose by pose stands in the order of the recorded rows, however they were
// given and whatever groups they belong to.
#include <doctest/doctest.h>

#include "framework/calibration/problem.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

TEST_CASE("the linear form goes by recorded rows") {
  Model model = model_of(shipped("arm-6r/model.xml"));
  Recordings recordings = recorded(program_of(model), 40, 1);
  std::vector<double> sessions;
  for (std::size_t k = 0; k < recordings.rows(); ++k) sessions.push_back(k % 3 == 1);
  add_column(recordings, "session", sessions);
  Element shift;
  shift.tag = "unknown";
  for (const auto& [name, text] : std::map<std::string, std::string>{
           {"name", "shift"}, {"value", "0 ± 1"}, {"kind", "length"}, {"per", "session"}})
    shift.set(name, text);
  for (const bool grouped : {false, true}) {
    CAPTURE(grouped);
    if (grouped) {
      model.root.children.insert(model.root.children.begin(), shift);
      set(model, "tool.z", "180 mm + shift");
    }
    const Program program = program_of(model);
    std::vector<std::size_t> rows = all_rows(recordings);
    std::reverse(rows.begin(), rows.end());
    Problem problem(program, recordings, rows, Groups(program, recordings), {});
    std::vector<double> x = problem.start();
    x[0] += 0.5;
    const Problem::Linear linear = problem.linear(x);
    const Problem::Residuals residuals = problem.residuals(x);
    const int m = problem.rows();
    for (int k = 0; k < 40; ++k) {
      CHECK(linear.pose[k * m] == k);
      CHECK((linear.rows.segment(k * m, m) - residuals.whitened.row(k).transpose()).norm() == 0);
      // A pose has a column of its own session alone.
      if (grouped)
        for (int i = 0; i < 2; ++i) {
          const bool own = problem.groups().shared[0].instance[residuals.poses[k]] == i;
          CHECK((linear.columns.col(problem.size() - 2 + i).segment(k * m, m).norm() > 0) == own);
        }
    }
  }
}

// Without unknowns of the pose, the rows have unit covariance, and the sources account for it.
TEST_CASE("the shares of the sources of noise add up") {
  for (const char* file : {"arm-6r/model.xml", "isl-bonny-2013/model.xml",
                           "device-nordquist-2009/model.xml", "knee-two-axis/model.xml"}) {
    CAPTURE(file);
    Model model = model_of(shipped(file));
    const bool latent = file[0] == 'k';
    const Program program = program_of(model);
    const Recordings recordings =
        recorded(program_of(latent ? with_readings_for_unknowns(model, "-40, 40") : model), 20, 2);
    Problem problem(program, recordings, all_rows(recordings), Groups(program, recordings), {});
    problem.set_weights(problem.start());
    const Problem::Noise noise = problem.noise(problem.start());
    const Problem::Linear linear = problem.linear(problem.start());
    for (std::size_t k = 0; k < noise.shares.size(); ++k) {
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(problem.rows(), problem.rows());
      for (const Eigen::MatrixXd& share : noise.shares[k]) sum += share;
      CHECK((sum * sum - sum).norm() < 1e-6);  // a projection
      const Eigen::VectorXd first = noise.columns[k].col(0);
      CHECK((first * first.transpose() - noise.shares[k][0]).norm() < 1e-12);
      const auto told = problem.rows() - problem.latents();
      const bool dependent = std::string(file) != "arm-6r/model.xml" && !latent;
      CHECK(sum.trace() == doctest::Approx(dependent ? std::round(sum.trace()) : told));
      CHECK(sum.trace() <= told + 1e-6);
      CHECK(sum.trace() >= told - 1.5);
      const auto rows =
          linear.rows.segment(static_cast<Eigen::Index>(k) * problem.rows(), problem.rows());
      CHECK((sum * rows - rows).norm() < 1e-6 * (1 + rows.norm()));
    }
    std::vector<std::string> names;
    for (const auto& source : noise.sources) names.push_back(source.name);
    if (!latent) CHECK(names[0] == program.readings[0].sensor);
    if (latent) CHECK(names[0] == "E.x");
  }
}
