// The ankle of Storey et al. 2006 in two ways: with built-in hinges, and with a hinge written in
// Lua that takes its axis by inclination and deviation. They are one model, calibrated with both
// angles latent in every pose.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "framework/calibration/axes.h"
#include "tests/support/fits.h"
#include "tests/support/plugin_check.h"

using namespace talus;
using namespace talus::testing;
namespace fs = std::filesystem;

namespace {

const std::string folder = "ankle-storey-2006/";
const std::string built_in = shipped(folder + "model.xml"),
                  scripted = shipped(folder + "scripted.xml");
const std::string cases = TALUS_SOURCE_DIR "/../shared/cases/";

struct Axis {
  double inclination, deviation;  // deg
};
// A subject about one standard deviation away from the means.
const Axis talocrural{11, 80}, subtalar{48, 31};

// The same ankle for either hinge: u = Rx(roll) Ry(yaw) z = (cos i cos d, cos i sin d, sin i).
void place(Program& program, const std::string& joint, const Axis& axis) {
  const double i = axis.inclination * deg, d = axis.deviation * deg;
  const double x = std::cos(i) * std::cos(d), y = std::cos(i) * std::sin(d), z = std::sin(i);
  const std::map<std::string, double> values{{joint + ".inclination", i},
                                             {joint + ".deviation", d},
                                             {joint + ".yaw", std::asin(x)},
                                             {joint + ".roll", std::atan2(-y, z)}};
  for (Parameter& p : program.parameters)
    if (const auto known = values.find(p.name); known != values.end())
      p.nominal.value = known->second;
}

Program subject(const std::string& file) {
  Program program = program_of(file);
  place(program, "talocrural", talocrural);
  place(program, "subtalar", subtalar);
  return program;
}

// Tolerances of the two descriptions are not the same prior; this wide they do not pull.
Program loose(const std::string& file) {
  Program program = program_of(file);
  for (Parameter& p : program.parameters) *p.nominal.tolerance *= 1e3;
  return program;
}

Recordings moved(const Program& program, double noise, std::uint64_t seed) {
  return simulate(program, grid_settings(program, "q1=-20:30:5; q2=-15:15:5"),
                  {.seed = seed, .noise = noise});
}

struct Found {
  Located located;
  std::vector<View> views;
};
Found axes(const Program& program, const Recordings& recordings) {
  AxisFinder finder(program);
  LocateOptions options;
  options.fit.threads = 2;
  Found found{finder.locate(recordings, all_rows(recordings), options), {}};
  found.views = finder.body_views(found.located);
  finder.describe(found.located, found.views);
  return found;
}

// Largest |found - true| / std over both axes' positions and orientations.
double largest_z(const Found& found, const Program& truth) {
  std::vector<double> x;
  for (const Parameter& p : truth.parameters) x.push_back(p.nominal.value);
  const std::vector<Line> lines = AxisFinder(truth).lines(x);
  double largest = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const LocatedAxis& axis = found.located.axes[k];
    CHECK(axis.determined);
    const auto expected = coordinates_of(lines[k], found.views[k]);
    for (int v = 0; v < 4; ++v)
      largest = std::max(largest, std::abs(axis.value[v] - expected[v]) / axis.std[v]);
  }
  return largest;
}

void check_same(const Found& a, const Found& b) {
  CHECK(a.located.fit.converged);
  CHECK(b.located.fit.converged);
  CHECK(a.located.fit.chi2 == doctest::Approx(b.located.fit.chi2).epsilon(1e-5));
  for (int k = 0; k < 2; ++k)
    for (int v = 0; v < 4; ++v) {
      const LocatedAxis &one = a.located.axes[k], &other = b.located.axes[k];
      CHECK(std::abs(one.value[v] - other.value[v]) < 0.01 * one.std[v]);
      CHECK(one.std[v] == doctest::Approx(other.std[v]).epsilon(1e-3));
    }
}

}  // namespace

TEST_CASE("the ankle's plugins in Lua: declaration, derivatives, both syntaxes") {
  Registry registry = Registry::built_in();
  for (const char* file : {"parts/inclined_hinge.lua", "parts/screw_displacement.lua"})
    load_plugin(shipped(folder + file), registry);
  check_plugin(*registry.find("inclined_hinge"));
  check_plugin(*registry.find("screw_displacement"));
}

TEST_CASE("the ankle with built-in and with scripted hinges moves the same") {
  const Recordings a = moved(subject(built_in), 0, 1), b = moved(subject(scripted), 0, 1);
  REQUIRE(a.rows() == 77);
  REQUIRE(a.columns.size() == b.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c)
    for (std::size_t k = 0; k < a.rows(); ++k)
      CHECK(std::abs(a.columns[c].values[k] - b.columns[c].values[k]) < 1e-12);
}

TEST_CASE("both, calibrated with latent angles, find the same axes, and the true ones") {
  const Program truth = subject(scripted);
  for (const std::uint64_t seed : {1, 2, 3}) {
    CAPTURE(seed);
    const Recordings recordings = moved(truth, 1, seed);
    const Found one = axes(loose(built_in), recordings), other = axes(loose(scripted), recordings);
    check_same(one, other);
    CHECK(one.located.fit.chi2_p > 0.001);
    CHECK(largest_z(one, truth) < 4);
    CHECK(largest_z(other, truth) < 4);
  }
}

// Of a screw's six coordinates the moment is, for small errors, the error of position.
TEST_CASE("the scripted residual finds what position and rotation vector find") {
  Registry registry = Registry::built_in();
  load_plugin(shipped(folder + "parts/screw_displacement.lua"), registry);
  Model model = read_model(built_in, registry);
  const Recordings recordings = moved(subject(built_in), 1, 4);
  const Fit plain = calibrate(compile(model, registry), recordings, all_to_fit(recordings), {});
  set_calibrate(model, "residual", "screw_displacement");
  const Fit screw = calibrate(compile(model, registry), recordings, all_to_fit(recordings), {});
  CHECK(screw.converged);
  CHECK(screw.chi2 == doctest::Approx(plain.chi2).epsilon(1e-3));
  for (const FittedValue& v : plain.parameters)
    CHECK(std::abs(value(screw, v.name).value - v.value) < 0.05 * v.std);
}

// Recordings with keys, where they lie beside the repository. Of rigid ankles the axes must be the
// true ones; what an effect does to them is told.
TEST_CASE("recorded ankles: both hinges find the same, of rigid ones the truth") {
  if (!fs::exists(cases + "keys.json")) {
    MESSAGE("skipped, not beside the repository: cases/keys.json");
    return;
  }
  std::ifstream in(cases + "keys.json");
  const nlohmann::json keys = nlohmann::json::parse(in);
  const std::map<std::string, std::string> names{
      {"p1u", "talocrural.x"},    {"p1v", "talocrural.z"},  {"roll1", "talocrural.roll"},
      {"yaw1", "talocrural.yaw"}, {"p2u", "subtalar.y"},    {"p2v", "subtalar.z"},
      {"roll2", "subtalar.roll"}, {"yaw2", "subtalar.yaw"}, {"x0", "calcaneus.x"},
      {"y0", "calcaneus.y"},      {"z0", "calcaneus.z"},    {"rx0", "calcaneus.a"},
      {"ry0", "calcaneus.b"},     {"rz0", "calcaneus.c"}};
  for (const auto& item : keys.items()) {
    const std::string id = item.key(), file = cases + "ankle2/" + id + "/recordings.csv";
    const nlohmann::json& key = item.value();
    if (key["device"] != "ankle2" || !fs::exists(file)) continue;
    CAPTURE(id);
    const Recordings recordings = read_recordings(file);
    const Found one = axes(loose(built_in), recordings), other = axes(loose(scripted), recordings);
    check_same(one, other);
    Program truth = program_of(built_in);
    for (const auto& entry : key["true_geometry"].items())
      for (Parameter& p : truth.parameters)
        if (p.name == names.at(entry.key()))
          p.nominal.value = entry.value().get<double>() * (p.dimension == angle ? deg : 1);
    const double z = largest_z(one, truth);
    if (key["effects"].empty() || key["strength"] == "absorbed")
      CHECK(z < 4);
    else
      MESSAGE(id, ": with ", key["effects"][0]["id"].get<std::string>(),
              " in the recordings the axes are up to ", z, " standard uncertainties off");
  }
}
