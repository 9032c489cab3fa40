#include "framework/page/page_state.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "framework/calibration/settings.h"
#include "framework/kinematics/pose_values.h"
#include "framework/page/linkage.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// What is measured of a feature minus what is modelled, in the frame it is measured in: a position
// and a rotation vector, or the difference of directions.
class Offsets {
 public:
  Offsets(const Program& program, const Feature& feature)
      : feature_(feature),
        chain_(program.chains[feature.chain]),
        modelled_(program, chain_.motions),
        shown_(program, feature.shown ? *feature.shown : Rigid<Expr>()),
        measured_(program, feature.observed.frame),
        vector_(*program.tape, nodes(program, feature.observed.vector)) {}

  std::vector<double> operator()(std::vector<double>& slots) {
    PlainPose model = modelled_(slots);
    set_chain(chain_, model, slots);
    if (feature_.shown) model = shown_(slots);
    std::vector<double> out;
    if (feature_.kind == Kind::direction) {
      const std::vector<double>& v = vector_(slots);
      for (int i = 0; i < 3; ++i)
        out.push_back((feature_.observed.angles ? std::cos(v[i]) : v[i]) - model.rotation[i][2]);
      return out;
    }
    const PlainPose measured = measured_(slots);
    for (int i = 0; i < 3; ++i) out.push_back(measured.translation[i] - model.translation[i]);
    if (feature_.kind != Kind::frame) return out;
    Matrix3<double> between{};  // measured = between * modelled
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) between[i][j] += measured.rotation[i][k] * model.rotation[j][k];
    for (const double v : rotation_vector(between)) out.push_back(v);
    return out;
  }

 private:
  static std::vector<std::int32_t> nodes(const Program& program, const Vector3<Expr>& v) {
    std::vector<std::int32_t> out;
    for (const Expr& e : v) out.push_back(e.node_on(*program.tape));
    return out;
  }

  const Feature& feature_;
  const Chain& chain_;
  PoseValues modelled_, shown_, measured_;
  TapeValues vector_;
};

Json offsets_json(const PageState& state) {
  Json out = Json::object();
  const Program& program = *state.program;
  for (const Feature& f : program.features) {
    if (f.kind == Kind::scalar || f.kind == Kind::nothing) continue;
    std::vector<const RecordedColumn*> columns;
    bool there = true;
    for (const MeasuredColumn& c : program.columns)
      columns.push_back(state.recordings->find(c.name));
    for (const int c : f.columns) there = there && columns[c];
    if (!there) continue;
    Offsets offsets(program, f);
    std::vector<double> slots = page_slots(program, state.parameters);
    std::vector<Json> lists(f.kind == Kind::frame ? 6 : 3, Json::array());
    for (std::size_t k = 0; k < state.poses.size(); ++k) {
      std::size_t next = 0;
      for (const Reading& r : program.readings) slots[r.slot] = state.poses[k][next++];
      for (const Unknown& u : program.unknowns) slots[u.slot] = state.poses[k][next++];
      for (std::size_t c = 0; c < columns.size(); ++c)
        slots[program.columns[c].slot] = columns[c] ? columns[c]->values[k] : nan;
      const std::vector<double> values = offsets(slots);
      for (std::size_t i = 0; i < lists.size(); ++i) lists[i].push_back(rounded(values[i], 5));
    }
    out[f.name] = lists;
  }
  return out;
}

// Readings and covariates as recorded, unknowns at their start until they are set.
std::vector<std::vector<double>> recorded_poses(const Program& program,
                                                const Recordings& recordings) {
  const std::vector<Coordinate> list = coordinates(program);
  std::vector<std::vector<double>> poses(recordings.rows());
  for (std::size_t k = 0; k < poses.size(); ++k)
    for (std::size_t i = 0; i < list.size(); ++i) {
      const RecordedColumn* column =
          i < program.readings.size() ? recordings.find(list[i].column) : nullptr;
      poses[k].push_back(column ? column->values[k] : list[i].rest);
    }
  return poses;
}

void take(PageState& state, const Problem::Residuals& from, const std::vector<int>& latent) {
  for (std::size_t j = 0; j < from.poses.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    state.residuals.row(static_cast<Eigen::Index>(from.poses[j])) = from.raw.row(row);
    for (std::size_t i = 0; i < latent.size(); ++i)
      state.poses[from.poses[j]][state.program->readings.size() + latent[i]] =
          from.latent(row, static_cast<Eigen::Index>(i));
  }
}

PageState state_of(std::string label, const Program& program, const Recordings& recordings,
                   const Groups& groups, std::span<const double> x) {
  PageState state{std::move(label), &program, {x.begin(), x.end()}, {}, &recordings, {}};
  state.poses = recorded_poses(program, recordings);
  state.residuals = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(recordings.rows()),
                                              static_cast<Eigen::Index>(program.rows.size()), nan);
  std::size_t first = program.parameters.size();
  for (const Groups::Unknowns& shared : groups.shared) {
    for (std::size_t k = 0; k < state.poses.size(); ++k)
      if (const std::size_t at = first + shared.instance[k]; at < x.size())
        state.poses[k][program.readings.size() + shared.unknown] = x[at];
    first += shared.instances;
  }
  return state;
}

}  // namespace

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  if (value == std::round(value) && std::abs(value) < 1e9) return static_cast<long long>(value);
  return std::stod(fmt::format("{:.{}g}", value, digits));
}

PageState fitted_state(std::string label, const Program& program, const Recordings& recordings,
                       const Fit& fit) {
  const Groups groups(program, recordings);
  PageState state = state_of(std::move(label), program, recordings, groups, fit.x);
  take(state, fit.residuals_fit, groups.latent);
  take(state, fit.residuals_check, groups.latent);
  return state;
}

PageState given_state(std::string label, const Program& program, const Recordings& recordings,
                      int threads) {
  std::vector<std::size_t> rows(recordings.rows());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  const Groups groups(program, recordings);
  ProblemOptions options;
  options.threads = threads;
  Problem problem(program, recordings, rows, groups, options);
  const Problem::Residuals residuals = problem.residuals(problem.start());
  PageState state = state_of(std::move(label), program, recordings, groups, problem.start());
  take(state, residuals, groups.latent);
  return state;
}

Json json_of(const PageState& state) {
  const Program& program = *state.program;
  Json out{{"label", state.label}};
  out["base"] = page_slots(program, state.parameters);
  for (Json& value : out["base"])
    if (!value.is_number() || !std::isfinite(value.get<double>())) value = 0;
  const std::vector<Coordinate> list = coordinates(program);
  out["coordinates"] = Json::array();
  for (std::size_t i = 0; i < list.size() && !state.poses.empty(); ++i) {
    const double factor = program.units.of(list[i].dimension).factor;
    Json values = Json::array();
    for (const auto& pose : state.poses) values.push_back(rounded(pose[i] / factor, 12));
    out["coordinates"].push_back(std::move(values));
  }
  out["rows"] = Json::array();
  for (std::size_t r = 0; r < program.rows.size(); ++r) {
    const Row& row = program.rows[r];
    const Unit unit = program.units.of(row.dimension);
    out["rows"].push_back({{"name", row.measure}, {"unit", unit.text}});
    if (row.sigma) out["rows"].back()["sigma"] = *row.sigma / unit.factor;
    if (state.residuals.rows() == 0) continue;
    Json values = Json::array();
    for (Eigen::Index k = 0; k < state.residuals.rows(); ++k)
      values.push_back(rounded(state.residuals(k, static_cast<Eigen::Index>(r)) / unit.factor, 5));
    out["rows"].back()["residuals"] = std::move(values);
  }
  if (state.recordings && !state.poses.empty()) out["offsets"] = offsets_json(state);
  return out;
}

}  // namespace talus
