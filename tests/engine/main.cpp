// Recordings of a linkage that an independent physics engine (MuJoCo) builds and loads: what its
// encoders show and where its end is measured, with noise. Nothing here uses Talus.
//
//     talus_engine_recordings isl|arm OUT.csv [--seed N] [--poses N] [--flaw
//     KIND:JOINT:SIZE[:EXTRA]]...
//                             [--readings FILE.csv]
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "tests/engine/world.h"

namespace engine {
namespace {

constexpr double deg = std::numbers::pi / 180;

struct Wanted {
  std::string linkage, out, readings;
  unsigned seed = 1;
  int poses = 100;
  std::vector<Flaw> flaws;
};

Wanted read(int count, char** words) {
  Wanted w;
  std::vector<std::string> plain;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (!word.starts_with("--")) {
      plain.push_back(word);
      continue;
    }
    if (++i == count) throw std::runtime_error(word + " wants a value");
    const std::string value = words[i];
    if (word == "--seed")
      w.seed = static_cast<unsigned>(std::stoul(value));
    else if (word == "--poses")
      w.poses = std::stoi(value);
    else if (word == "--flaw")
      w.flaws.push_back(read_flaw(value));
    else if (word == "--readings")
      w.readings = value;
    else
      throw std::runtime_error("no option " + word);
  }
  if (plain.size() != 2)
    throw std::runtime_error("usage: talus_engine_recordings isl|arm OUT.csv [options]");
  w.linkage = plain[0], w.out = plain[1];
  return w;
}

// Rows of the columns theta1 to theta6 of a table, in degrees.
std::vector<Angles> settings(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  std::vector<Angles> result;
  std::vector<int> of;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> cells;
    std::istringstream cut(line);
    for (std::string cell; std::getline(cut, cell, ',');) cells.push_back(cell);
    if (of.empty()) {
      for (std::size_t c = 0; c < cells.size(); ++c)
        of.push_back(cells[c].starts_with("theta") ? cells[c][5] - '1' : -1);
      continue;
    }
    Angles row{};
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (of[c] >= 0) row[static_cast<std::size_t>(of[c])] = std::stod(cells[c]);
    result.push_back(row);
  }
  return result;
}

class Recorder {
 public:
  explicit Recorder(const Wanted& wanted)
      : wanted_(wanted), random_(wanted.seed), specimen_(built(drawn(wanted.linkage), random_)) {
    specimen_.flaws = wanted.flaws;
  }

  void run() {
    World world(specimen_);
    std::ostringstream table;
    header(table);
    const std::vector<Angles> given =
        wanted_.readings.empty() ? std::vector<Angles>{} : settings(wanted_.readings);
    const int poses = given.empty() ? wanted_.poses : static_cast<int>(given.size());
    for (int pose = 1; pose <= poses; ++pose) {
      const Angles angles = given.empty() ? drawn_pose(world) : angles_of(given[pose - 1]);
      std::array<int, 6> sense;
      for (int& s : sense) s = uniform_(random_) < 0.5 ? -1 : 1;
      const double payload = specimen_.held ? 0 : uniform_(random_) < 0.5 ? 0 : 3;
      world.payload(payload);
      world.rest(angles, sense);
      table << pose;
      readings(table, world.encoders(), angles);
      measured(table, world.end());
      if (!specimen_.held) {
        table << ',' << payload;
        for (int s : sense) table << ',' << s;
      }
      table << '\n';
    }
    std::ofstream(wanted_.out) << table.str();
  }

 private:
  void header(std::ostream& out) const {
    out.precision(10);
    out << "pose";
    for (int i = 1; i <= 6; ++i) out << ",theta" << i << "[deg]";
    out << ",E.x[mm],E.y[mm],E.z[mm]";
    if (specimen_.frame) out << ",E.qw,E.qx,E.qy,E.qz";
    if (!specimen_.held) {
      out << ",payload[kg]";
      for (int i = 1; i <= 6; ++i) out << ",approach_joint" << i;
    }
    out << '\n';
  }

  Angles angles_of(const Angles& readings) const {
    Angles result{};
    for (std::size_t i = 0; i < 6; ++i)
      result[i] = (specimen_.encoders[i].slope.value * readings[i] +
                   specimen_.encoders[i].intercept.value) *
                  deg;
    return result;
  }

  // Within the encoders' ranges; a linkage that is held, not near a posture where little holds it.
  Angles drawn_pose(World& world) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      Angles readings{};
      for (std::size_t i = 0; i < 6; ++i) {
        const Encoder& e = specimen_.encoders[i];
        readings[i] = e.low + (e.high - e.low) * uniform_(random_);
      }
      const Angles angles = angles_of(readings);
      if (!specimen_.held) return angles;
      world.place(angles);
      if (world.regularity() > 0.2) return angles;
    }
    throw std::runtime_error("no posture far from singular ones");
  }

  // Readings count turns: of all that look alike, the one near where the joint was placed.
  void readings(std::ostream& out, const Angles& shown, const Angles& placed) {
    for (std::size_t i = 0; i < 6; ++i) {
      const Encoder& e = specimen_.encoders[i];
      const double near = placed[i] + std::remainder(shown[i] - placed[i], 2 * std::numbers::pi);
      out << ',' << (near / deg - e.intercept.value) / e.slope.value + e.sigma * normal_(random_);
    }
  }

  void measured(std::ostream& out, const Eigen::Isometry3d& end) {
    for (int i = 0; i < 3; ++i)
      out << ',' << 1000 * end.translation()[i] + specimen_.sigma_mm * normal_(random_);
    if (!specimen_.frame) return;
    Eigen::Vector3d turn;
    for (double& t : turn) t = specimen_.sigma_deg * deg * normal_(random_);
    const Eigen::Quaterniond q(
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * end.linear());
    out << ',' << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z();
  }

  Wanted wanted_;
  std::mt19937_64 random_;
  Linkage specimen_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

}  // namespace
}  // namespace engine

int main(int count, char** words) {
  try {
    engine::Recorder(engine::read(count, words)).run();
  } catch (const std::exception& e) {
    std::cerr << "talus_engine_recordings: " << e.what() << '\n';
    return 2;
  }
}
