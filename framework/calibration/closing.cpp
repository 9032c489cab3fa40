#include "framework/calibration/closing.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <set>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/inverse.h"

namespace talus {
namespace {

constexpr int kRounds = 3;  // effects follow postures, which follow effects a little
constexpr int kMost = 8;    // unknowns of a pose
constexpr int kDraws = 20;  // times as many postures are drawn as wanted, at most

bool is_loop(const Program& program, const Row& row) {
  return program.features[row.feature].kind == Kind::nothing;
}

// The program with its closures' rows alone, each open by a gap that is read from a column.
class Gaps {
 public:
  explicit Gaps(Program& program)
      : program_(program),
        rows_(program.rows),
        readings_(program.readings),
        names_(program.slot_names),
        slots_(program.slots) {
    std::erase_if(program.rows, [&](const Row& row) { return !is_loop(program, row); });
    for (std::size_t i = 0; i < program.rows.size(); ++i) {
      Row& row = program.rows[i];
      const std::string name = fmt::format("gap:{}", i);
      Reading gap{name, name, row.dimension};
      gap.covariate = true;
      gap.slot = program.slots++;
      program.slot_names.push_back(name);
      gap.value = Expr::leaf(*program.tape, gap.slot);
      row.value = row.value + gap.value;
      program.readings.push_back(std::move(gap));
    }
  }
  ~Gaps() {
    program_.rows = std::move(rows_);
    program_.readings = std::move(readings_);
    program_.slot_names = std::move(names_);
    program_.slots = slots_;
  }
  Gaps(const Gaps&) = delete;

 private:
  Program& program_;
  std::vector<Row> rows_;
  std::vector<Reading> readings_;
  std::vector<std::string> names_;
  int slots_;
};

class Closer {
 public:
  Closer(Program& program, const ClosingOptions& options)
      : program_(program), options_(options), list_(coordinates(program)) {
    std::set<int> seen;
    const auto support = row_support(program);
    for (std::size_t r = 0; r < support.size(); ++r)
      if (is_loop(program, program.rows[r])) seen.insert(support[r].begin(), support[r].end());
    const std::size_t readings = program.readings.size();
    for (std::size_t i = 0; i < list_.size(); ++i) {
      const Unknown* unknown = i < readings ? nullptr : &program.unknowns[i - readings];
      const bool held = !options.held.empty() && options.held[i];
      const bool moves = list_[i].dimension == angle || list_[i].dimension == length;
      free_.push_back(!held && !list_[i].covariate && moves &&
                      !(unknown && !unknown->per.empty()) &&
                      seen.contains(unknown ? unknown->slot : program.readings[i].slot));
    }
    // The solver takes so many unknowns of a pose; with as many freedoms most loops can be closed.
    for (auto first = free_.begin(); std::count(free_.begin(), free_.end(), true) > kMost;)
      *(first = std::find(first, free_.end(), true)) = false;
  }

  Closed run(Settings at) {
    const std::size_t rows = at.poses.size();
    const bool effects =
        std::any_of(list_.begin(), list_.end(), [](const Coordinate& c) { return c.covariate; });
    std::size_t loops = 0;
    for (const Row& row : program_.rows) loops += is_loop(program_, row);
    std::vector<std::vector<double>> gaps(loops, std::vector<double>(rows, 0.0));
    Closed closed;
    closed.reached.assign(rows, true);
    for (int round = 0; round < (effects ? kRounds : 1); ++round) {
      at = with_circumstances(program_, std::move(at), options_.table);
      if (std::none_of(free_.begin(), free_.end(), [](bool f) { return f; })) break;
      closed.reached = solve(at, gaps, options_.attempts);
      at.circumstances.clear();
    }
    if (options_.noise > 0) {
      draw(gaps);
      at = with_circumstances(program_, std::move(at), options_.table);
      solve(at, gaps, 1);
      at.circumstances.clear();
    }
    closed.settings = with_circumstances(program_, std::move(at), options_.table);
    return closed;
  }

 private:
  void draw(std::vector<std::vector<double>>& gaps) const {
    std::mt19937_64 random(options_.seed);
    std::normal_distribution<double> normal;
    std::size_t i = 0;
    for (const Row& row : program_.rows) {
      if (!is_loop(program_, row)) continue;
      for (double& gap : gaps[i]) gap = options_.noise * row.sigma.value_or(0) * normal(random);
      ++i;
    }
  }

  // Moves the free coordinates; which postures were reached.
  std::vector<bool> solve(Settings& at, const std::vector<std::vector<double>>& gaps,
                          int attempts) {
    Recordings table;
    auto add = [&](const std::string& name, Dimension dimension, std::vector<double> values) {
      table.columns.push_back({name, program_.units.of(dimension), std::move(values), {}});
    };
    for (std::size_t k = 0; k < at.poses.size(); ++k)
      table.lines.push_back(static_cast<int>(k) + 2);
    for (std::size_t i = 0; i < list_.size(); ++i) {
      if (free_[i]) continue;
      std::vector<double> values;
      for (const auto& pose : at.poses) values.push_back(pose[i]);
      add(list_[i].column, list_[i].dimension, std::move(values));
    }
    std::size_t next = 0;
    for (const Row& row : program_.rows)
      if (is_loop(program_, row)) {
        add(fmt::format("gap:{}", next), row.dimension, gaps[next]);
        ++next;
      }
    // The gaps stand between readings and unknowns.
    const auto readings = static_cast<long>(program_.readings.size());
    Settings near = at;
    for (std::size_t k = 0; k < near.poses.size(); ++k)
      for (std::size_t g = 0; g < gaps.size(); ++g)
        near.poses[k].insert(near.poses[k].begin() + readings + static_cast<long>(g), gaps[g][k]);
    const Gaps open(program_);
    const Recovered found =
        recover(program_, table, Reach::if_possible, options_.threads, &near, attempts);
    std::vector<bool> reached;
    for (std::size_t k = 0; k < at.poses.size(); ++k) {
      at.poses[k] = found.settings.poses[k];
      at.poses[k].erase(at.poses[k].begin() + readings,
                        at.poses[k].begin() + readings + static_cast<long>(gaps.size()));
      reached.push_back(found.how[k] == Recovered::How::inside);
    }
    return reached;
  }

  Program& program_;
  const ClosingOptions& options_;
  std::vector<Coordinate> list_;
  std::vector<bool> free_;  // to be solved for
};

}  // namespace

bool has_loops(const Program& program) {
  return std::any_of(program.rows.begin(), program.rows.end(),
                     [&](const Row& row) { return is_loop(program, row); });
}

Closed close_loops(Program& program, Settings drawn, const ClosingOptions& options) {
  return Closer(program, options).run(std::move(drawn));
}

Settings random_closed_settings(Program& program, int count, const ClosingOptions& options) {
  Settings kept;
  for (int draw = 0; draw < kDraws && static_cast<int>(kept.poses.size()) < count; ++draw) {
    ClosingOptions exactly = options;
    exactly.noise = 0;
    const Closed closed = close_loops(
        program, random_settings(program, count, options.seed + static_cast<std::uint64_t>(draw)),
        exactly);
    for (std::size_t k = 0; k < closed.reached.size(); ++k)
      if (closed.reached[k] && static_cast<int>(kept.poses.size()) < count)
        kept.poses.push_back(closed.settings.poses[k]);
  }
  if (kept.poses.empty()) {
    const auto loop = std::find_if(program.features.begin(), program.features.end(),
                                   [](const Feature& f) { return f.kind == Kind::nothing; });
    throw InputError(
        loop->place,
        fmt::format("no posture drawn from the sensors' ranges closes '{}'", loop->name),
        "range=\"...\" of the sensors such that the loop can be closed");
  }
  return close_loops(program, std::move(kept), options).settings;
}

}  // namespace talus
