// Linkages as an engine builds them, told in numbers and not read from a model file: what a
// drawing states, with tolerances from which a built specimen deviates, and what is wrong with it.
//
// Lengths in mm and angles in degrees as in the drawings, masses in kg. Flaws are in the units of a
// data sheet: deg/(N m), 1/(N m^2), deg, mm.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace engine {

using Vector = std::array<double, 3>;

struct Toleranced {
  double value = 0, tolerance = 0;
};

// Shifted, then turned about its own axes, one after the other.
struct Mount {
  std::array<Toleranced, 3> shift;
  std::string axes;  // "zxz"
  std::array<Toleranced, 3> turns;
};

// Turned by the joint's angle about z, shifted by (a, 0, d), turned by alpha about x, beta about y.
struct Link {
  Toleranced d, a, alpha, beta;
  double mass = 0;
  Vector com{};  // seen from the link's end
};

// Angle = slope reading + intercept.
struct Encoder {
  Toleranced intercept, slope;
  double sigma = 0, low = 0, high = 0;
};

struct Flaw {
  enum class Kind { elastic, tilting, bending, eccentric, play_load, play_approach, clearance };
  Kind kind = Kind::elastic;
  int joint = 0;  // from 1
  // Compliance, flexibility, eccentricity by radius, half the play or the radial clearance.
  double size = 0;
  // Phase of an eccentric disc (deg); of a link, how much softer it is one way than the other.
  double extra = 0;
};

struct Linkage {
  std::string name;
  Mount base;
  std::array<Link, 6> links;
  Mount end;
  std::array<Encoder, 6> encoders;
  Vector gravity{};              // direction
  bool gravity_in_base = false;  // in the frame behind the mount; else in that of the measurement
  bool held = false;             // its end is held as well and its joints are free; else driven
  bool frame = false;            // its end is measured as a frame, else as a point
  double sigma_mm = 0, sigma_deg = 0;
  std::vector<Flaw> flaws;

  const Flaw* flaw(Flaw::Kind kind, int joint) const;
};

// By name: isl, arm.
Linkage drawn(const std::string& name);
// KIND:JOINT:SIZE[:EXTRA]
Flaw read_flaw(const std::string& text);
// Every toleranced number off by a normal deviate of a third of its tolerance, and without one.
Linkage built(Linkage linkage, std::mt19937_64& random);

}  // namespace engine
