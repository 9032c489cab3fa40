// The evaluation in batches against the tape evaluated number by number, and its derivatives
// against differences of high order in long double, for every model that is shipped.
#include "framework/kinematics/plan.h"

#include <cmath>

#include "framework/calibration/dataset.h"
#include "framework/kinematics/tape_values.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;
using reference::Real;

namespace {

// A program's rows as functions of its slots alone: the end poses of the chains first, then the
// rows.
class Scalar {
 public:
  explicit Scalar(const Program& program) : program_(program) {
    for (const Chain& chain : program.chains)
      for (const Expr& e : entries(chain.motions)) poses_.push_back(on_tape(e));
    for (const Row& row : program.rows) rows_.push_back(row.value);
  }

  std::vector<Real> operator()(std::vector<Real> slots) const {
    set_poses(slots, reference::evaluate(poses_, slots));
    return reference::evaluate(rows_, slots);
  }

  // The same by Tape::evaluate, in double.
  std::vector<double> by_tape(std::vector<double> slots) const {
    std::vector<double> poses, rows;
    for (const Expr& e : poses_) poses.push_back(program_.tape->evaluate(e.node(), slots));
    set_poses(slots, poses);
    for (const Expr& e : rows_)
      rows.push_back(e.is_constant() ? e.constant() : program_.tape->evaluate(e.node(), slots));
    return rows;
  }

  std::vector<Real> difference(const std::vector<Real>& slots, int slot, Real h) const {
    static constexpr Real weight[] = {45, -9, 1};
    std::vector<Real> sum(rows_.size());
    for (int k = 1; k <= 3; ++k)
      for (int side : {1, -1}) {
        std::vector<Real> moved = slots;
        moved[slot] += side * k * h;
        const std::vector<Real> f = (*this)(std::move(moved));
        for (std::size_t i = 0; i < f.size(); ++i) sum[i] += side * weight[k - 1] * f[i];
      }
    for (Real& s : sum) s /= 60 * h;
    return sum;
  }

 private:
  // Zeros of the rigid motions come as plain constants.
  Expr on_tape(const Expr& e) const { return {program_.tape.get(), e.node_on(*program_.tape)}; }

  template <class T>
  void set_poses(std::vector<T>& slots, const std::vector<T>& poses) const {
    for (std::size_t c = 0; c < program_.chains.size(); ++c)
      for (int i = 0; i < 12; ++i) slots[program_.chains[c].first_slot + i] = poses[12 * c + i];
  }

  const Program& program_;
  std::vector<Expr> poses_, rows_;
};

// Sensible values at all slots but the chains'.
std::vector<double> random_slots(const Program& program, Random& random) {
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters)
    slots[p.slot] = p.nominal.value + p.nominal.tolerance.value_or(0.1) * between(random, -1, 1);
  for (const Reading& r : program.readings) {
    const auto [low, high] = r.range.value_or(std::pair(-1.0, 1.0));
    slots[r.slot] = between(random, low, high);
  }
  for (const Unknown& u : program.unknowns)
    slots[u.slot] = u.start.value + (u.dimension == length ? 20 : 0.5) * between(random, -1, 1);
  for (const MeasuredColumn& c : program.columns)
    slots[c.slot] = c.dimension == length  ? between(random, -300, 300)
                    : c.dimension == angle ? between(random, 0.5, 2.5)
                                           : between(random, -1, 1);
  return slots;
}

// A plan with 16 different poses in its lanes. Parameters are the same in all of them.
struct Filled {
  enum Set { kParameters, kUnknowns, kReadings };

  Program program;
  Scalar scalar;
  std::vector<int> state;
  Plan plan;
  std::vector<std::vector<double>> poses;  // slots of every lane
  Buffer workspace;

  Filled(Program p, std::uint64_t seed)
      : program(std::move(p)), scalar(program), state(unknowns()), plan(program, sets(), state) {
    Random random(seed);
    for (int lane = 0; lane < lanes; ++lane) {
      poses.push_back(random_slots(program, random));
      for (const Parameter& p : program.parameters) poses[lane][p.slot] = poses[0][p.slot];
    }
    Buffer data(std::max<std::size_t>(1, plan.data_nodes().size()) * lanes),
        states(std::max<std::size_t>(1, state.size()) * lanes);
    TapeValues values(*program.tape, plan.data_nodes());
    for (int lane = 0; lane < lanes; ++lane) {
      const auto& v = values(poses[lane]);
      for (std::size_t i = 0; i < v.size(); ++i) data[i * lanes + lane] = v[i];
      for (std::size_t i = 0; i < state.size(); ++i)
        states[i * lanes + lane] = poses[lane][state[i]];
    }
    workspace = plan.workspace();
    plan.set_parameters(workspace, poses[0]);
    plan.evaluate(workspace, data.data(), states.data());
  }

  std::vector<int> unknowns() const {
    std::vector<int> slots;
    for (const Unknown& u : program.unknowns) slots.push_back(u.slot);
    return slots;
  }
  std::vector<std::vector<int>> sets() const {
    std::vector<std::vector<int>> all(3);
    for (const Parameter& p : program.parameters) all[kParameters].push_back(p.slot);
    all[kUnknowns] = unknowns();
    for (const Reading& r : program.readings) all[kReadings].push_back(r.slot);
    return all;
  }

  // [column][row][lane]; columns farther apart than need be, to see that nothing is written
  // between.
  Buffer jacobian(int set, const RowTransform& transform) {
    const std::size_t size = static_cast<std::size_t>(plan.rows()) * lanes;
    Buffer J((size + lanes) * plan.columns(set).size() + 1, 1e99);
    plan.jacobian(workspace, set, transform, J.data(), size + lanes);
    for (std::size_t c = 0; c < plan.columns(set).size(); ++c)
      for (int l = 0; l < lanes; ++l) CHECK(J[c * (size + lanes) + size + l] == 1e99);
    return J;
  }
  double at(const Buffer& J, int column, int row, int lane) const {
    return J[column * (static_cast<std::size_t>(plan.rows()) + 1) * lanes + row * lanes + lane];
  }
};

double off(double a, double b) { return std::abs(a - b) / std::max(1.0, std::abs(b)); }

void check_rows(const Filled& f) {
  double worst = 0;
  for (int lane = 0; lane < lanes; ++lane) {
    const std::vector<double> expected = f.scalar.by_tape(f.poses[lane]);
    for (int r = 0; r < f.plan.rows(); ++r)
      worst = std::max(worst, off(f.plan.row(f.workspace, r)[lane], expected[r]));
  }
  CHECK(worst < 1e-11);
}

void check_jacobians(Filled& f) {
  Random random(7);
  const int m = f.plan.rows();
  Buffer diagonal(static_cast<std::size_t>(m) * lanes),
      dense(static_cast<std::size_t>(m) * m * lanes);
  for (double& v : diagonal) v = between(random, -2, 2);
  for (double& v : dense) v = between(random, -2, 2);
  for (int set = 0; set < 3; ++set) {
    CAPTURE(set);
    const Buffer J = f.jacobian(set, {});
    const Buffer scaled = f.jacobian(set, {RowTransform::Kind::diagonal, diagonal.data()});
    const Buffer mixed = f.jacobian(set, {RowTransform::Kind::dense, dense.data()});
    double worst = 0, worst_transformed = 0;
    for (int lane = 0; lane < lanes; lane += 5) {
      const std::vector<Real> slots(f.poses[lane].begin(), f.poses[lane].end());
      for (std::size_t c = 0; c < f.plan.columns(set).size(); ++c) {
        const int slot = f.plan.columns(set)[c];
        const std::vector<Real> d = f.scalar.difference(slots, slot, 1e-3L);
        for (int r = 0; r < m; ++r) {
          const int column = static_cast<int>(c);
          worst = std::max(worst, off(f.at(J, column, r, lane), static_cast<double>(d[r])));
          double sum = 0, size = 1;
          for (int q = 0; q < m; ++q) {
            const double term = dense[(r * m + q) * lanes + lane] * static_cast<double>(d[q]);
            sum += term, size = std::max(size, std::abs(term));
          }
          worst_transformed =
              std::max({worst_transformed, std::abs(f.at(mixed, column, r, lane) - sum) / size,
                        off(f.at(scaled, column, r, lane),
                            diagonal[r * lanes + lane] * static_cast<double>(d[r]))});
        }
      }
    }
    CHECK(worst < 2e-9);
    CHECK(worst_transformed < 2e-9);
  }
}

}  // namespace

TEST_CASE("batches agree with the tape, and Jacobians with differences, for every shipped model") {
  for (const std::string& file : shipped_models()) {
    CAPTURE(file);
    Filled f(program_of(file), 3);
    CHECK(f.plan.rows() == static_cast<int>(f.program.rows.size()));
    check_rows(f);
    check_jacobians(f);
  }
}

// What no shipped model has: motions given by matrices, inverse chains through them, one parameter
// at several places, factors other than one, rows that depend on parameters beside the chain.
TEST_CASE("the same for matrix motions, shared parameters and two branches") {
  Filled f(program_from(R"xml(<talus length="mm" angle="deg">
    <parameter name="L" kind="length" value="120 ± 2"/>
    <parameter name="k" value="0.7 ± 0.1"/>
    <unknown name="u" kind="angle" value="5"/>
    <chain from="B" to="left">
      <mount name="foot" order="vector" x="L" y="2*L" a="10 ± 1" b="20 ± 1" c="-30 ± 1"/>
      <revolute_about name="hinge" theta="k * q1 + u" x="3 ± 1" y="L" ux="1 ± 0.1" uy="0.5 ± 0.1" uz="0.2 ± 0.1"/>
      <dh name="elbow" theta="-(q1 + q2)" d="L" a="100 ± 1" alpha="hinge_tilt"/>
    </chain>
    <parameter name="hinge_tilt" kind="angle" value="85 ± 1"/>
    <chain from="B" to="right">
      <spherical name="ball" roll="q1" pitch="u" yaw="q2" x="L" y="5 ± 1" z="-3 ± 1"/>
      <screw name="drive" theta="q2" pitch="3 ± 0.1 mm/rad" y="4 ± 1" roll="3 ± 1"/>
    </chain>
    <encoder name="q1" slope="1 ± 0.1" intercept="3 ± 1"/>
    <encoder name="q2"/>
    <frame name="F" in="left" at="right" sigma="0.1 mm, 0.1 deg"/>
    <length name="S" in="right" at="left" x="5 ± 1" y="L" sigma="0.1"/>
    <direction name="d" in="left" at="right" roll="10 ± 1" yaw="-20 ± 1" sigma="0.1"/>
    <closure name="c" in="left" at="right" sigma="0.1 mm, 0.1 deg"/>
    <calibrate residual="position, rotation_vector" of="F"/>
    <calibrate residual="vector_length" of="S"/>
    <calibrate residual="direction" of="d"/>
    <calibrate residual="projection_angles, distance" of="c" nominal="50 ± 1"/>
  </talus>)xml"),
           4);
  REQUIRE(f.program.chains.size() == 4);
  check_rows(f);
  check_jacobians(f);
}

// A batch has one instance of every group unknown; lanes without a pose repeat the first and are
// masked.
TEST_CASE("a dataset fills batches of whole groups and masks the lanes that are left") {
  const Program program = program_from(R"(<talus>
    <unknown name="zero" kind="angle" value="0" per="session"/>
    <chain from="B" to="E"><dh name="j" theta="q + zero" a="100 ± 1"/></chain>
    <encoder name="q"/>
    <point name="E" in="B" sigma="0.1"/>
  </talus>)");
  Recordings recordings = recorded(program, 40, 1);
  std::vector<double> session(40);
  for (int k = 0; k < 40; ++k) session[k] = k % 5 < 3 ? 1 : 2;  // 24 rows and 16 rows, mixed
  add_column(recordings, "session", session);
  column(recordings, "E.y").values[7] = std::nan("");
  const Groups groups(program, recordings);
  REQUIRE(groups.shared.size() == 1);
  CHECK(groups.shared[0].instances == 2);
  CHECK(groups.shared[0].labels == std::vector<std::string>{"session=1", "session=2"});

  std::vector<int> parameters, unknowns{program.unknowns[0].slot};
  for (const Parameter& p : program.parameters) parameters.push_back(p.slot);
  const Plan plan(program, {parameters, unknowns}, unknowns);
  const Dataset data(program, plan, recordings, all_rows(recordings), groups);
  CHECK(data.poses() == 40);
  CHECK(data.used() == 119);
  CHECK(data.missing() == 1);
  REQUIRE(data.batches() == 3);  // 16 + 8 of session 1, 16 of session 2
  std::vector<int> seen(40);
  for (int b = 0; b < data.batches(); ++b) {
    const Dataset::Batch& batch = data.batch(b);
    REQUIRE(batch.poses.size() == lanes);
    for (int l = 0; l < lanes; ++l) {
      const int row = batch.poses[l];
      CHECK(groups.shared[0].instance[row] == batch.instance[0]);
      for (int r = 0; r < plan.rows(); ++r) {
        const bool counts = l < batch.count && !(row == 7 && r == 1);
        CHECK(data.mask(b)[r * lanes + l] == (counts ? 1 : 0));
      }
      if (l < batch.count)
        ++seen[row];
      else
        CHECK(row == batch.poses[0]);
    }
  }
  CHECK(seen == std::vector<int>(40, 1));
}
