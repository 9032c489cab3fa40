// The very words in which models are refused that are well formed but mean nothing.
#include <string>

#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

std::string complaint(const std::string& xml) {
  try {
    program_from(xml);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

// A whole model around what is of interest, which begins at line 2, column 3.
std::string around(const std::string& elements) {
  return "<talus length=\"mm\" angle=\"deg\">\n  " + elements + R"(
  <chain from="B" to="E">
    <dh name="joint1" theta="encoder1" a="100 ± 1"/>
    <dh name="joint2" theta="encoder2" a="80 ± 1"/>
  </chain>
  <encoder name="encoder1"/>
  <encoder name="encoder2"/>
  <frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/>
</talus>)";
}
// The same with more in the chain, at line 2, column 27.
std::string joint(const std::string& joints) {
  return "<talus>\n  <chain from=\"B\" to=\"E\"> " + joints + R"( </chain>
  <encoder name="encoder1"/>
  <encoder name="encoder2"/>
  <frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/>
</talus>)";
}

struct Case {
  const char* what;
  std::string text;
  const char* complaint;
};

const Case cases[] = {
    {"a wrong unit", joint(R"(<dh name="j" theta="encoder1" a="90 deg"/>)"),
     R"(model.xml:2:63: 'deg' measures an angle
  expected a length (mm, m, um, cm, in))"},
    {"a missing unit", joint(R"(<dh name="j" theta="encoder1 + 90"/>)"),
     R"(model.xml:2:56: '+' joins an angle (deg, rad, mrad, arcmin, arcsec) and a plain number (no unit) in 'encoder1 + 90'
  expected two of a kind; write the unit of a number, such as 90 deg)"},
    {"an expression of another dimension",
     joint(R"(<dh name="j" theta="encoder1" a="2*encoder1"/>)"),
     R"(model.xml:2:60: a="2*encoder1" is an angle (deg, rad, mrad, arcmin, arcsec)
  expected a length (mm, m, um, cm, in))"},
    {"an unknown name", joint(R"xml(<dh name="j" theta="-(encoder1 + encodr2)"/>)xml"),
     R"(model.xml:2:60: 'encodr2' is not a number, constant, parameter, unknown or sensor
  expected one of: encoder1, encoder2
  did you mean 'encoder2'?)"},
    {"a joint's name where a value is meant", joint(R"(<dh name="j" theta="encoder1" a="j"/>)"),
     R"(model.xml:2:60: 'j' is not a number, constant, parameter, unknown or sensor
  expected one of: encoder1, encoder2)"},
    {"an input nobody has", joint(R"(<dh name="j" theta="encoder1" a="j.b"/>)"),
     R"(model.xml:2:60: no input 'j.b'
  expected one of: j.theta, j.d, j.a, j.alpha
  did you mean 'j.d'?)"},
    {"an input of an element nobody knows", joint(R"(<dh name="j" theta="encoder1" a="k.a"/>)"),
     R"(model.xml:2:60: no input 'k.a'
  expected element.input
  did you mean 'E.a'?)"},
    {"a definition in a circle",
     joint(R"(<dh name="j" theta="encoder1" a="2*k.a"/> <dh name="k" theta="encoder2" a="j.a"/>)"),
     R"(model.xml:2:102: 'j.a' is defined in a circle)"},
    {"constants in a circle",
     around(R"(<constant name="L" value="2*M"/> <constant name="M" value="L"/>)"),
     R"(model.xml:2:62: 'L' is defined in a circle)"},
    {"a sensor whose input needs the sensor",
     "<talus>\n  <encoder name=\"q\" intercept=\"2*q\"/>\n  <chain from=\"B\" to=\"E\"><dh "
     "name=\"j\" "
     "theta=\"q\"/></chain>\n  <point name=\"E\"/>\n</talus>",
     R"(model.xml:2:34: 'q' is defined in a circle)"},
    {"a number out of its range",
     joint(R"(<dh name="j" theta="encoder1" a="100 ± 1 [110, 120]"/>)"),
     R"(model.xml:2:60: 100 is out of its bounds [110, 120]
  expected a number within them)"},
    {"a sigma below zero", around(R"(<encoder name="q" sigma="-1"/>)"),
     R"(model.xml:2:28: sigma="-1"
  expected zero or more)"},
    {"a range upside down", around(R"(<encoder name="q" range="30, -30"/>)"),
     R"(model.xml:2:28: range="30, -30"
  expected lower below upper)"},
    {"a sigma of zero at a feature", around(R"(<point name="P" at="E" sigma="0"/>)"),
     R"(model.xml:2:33: sigma '0'
  expected more than zero)"},
    {"a frame reached twice",
     around(R"(<chain from="B" to="E"><mount name="other" x="1"/></chain>)"),
     R"(model.xml:3:23: frame 'E' is reached twice (before at model.xml:2:23)
  expected a tree of frames; close a loop with <closure in="..." at="..."/>)"},
    {"chains that form a circle",
     "<talus>\n  <chain from=\"B\" to=\"E\"><mount name=\"m\" x=\"1\"/></chain>\n  <chain "
     "from=\"E\" "
     "to=\"B\"><mount name=\"n\" x=\"1\"/></chain>\n</talus>",
     R"(model.xml:2:16: the chains form a circle through frame 'B'
  expected a tree of frames; close a loop with <closure in="..." at="..."/>)"},
    {"a circle beside the tree",
     around(
         R"(<chain from="P" to="Q"><mount name="m" x="1"/></chain><chain from="Q" to="P"><mount name="n" x="1"/></chain>)"),
     R"(model.xml:2:16: the chains form a circle through frame 'P'
  expected a tree of frames; close a loop with <closure in="..." at="..."/>)"},
    {"a frame that hangs loose",
     around(R"(<chain from="jont1" to="T"><mount name="m" x="1"/></chain>)"),
     R"(model.xml:2:16: frame 'jont1' hangs loose: no chain leads to it
  expected a frame that is connected to the root 'B': B, E, joint1, joint2
  did you mean 'joint1'?)"},
    {"a feature at no frame", around(R"(<point name="P" in="B" at="jont1"/>)"),
     R"(model.xml:2:30: no frame 'jont1'
  expected one of: B, E, joint1, joint2
  did you mean 'joint1'?)"},
    {"a feature in no frame", around(R"(<point name="P" in="camera" at="E"/>)"),
     R"(model.xml:2:23: no frame 'camera'
  expected one of: B, E, joint1, joint2)"},
    {"a feature whose own name is no frame", around(R"(<point name="probe" in="B"/>)"),
     R"(model.xml:2:16: no frame 'probe'
  expected one of: B, E, joint1, joint2)"},
    {"a centre of mass without a mass", joint(R"(<dh name="j" theta="encoder1" com="1, 2, 3"/>)"),
     R"(model.xml:2:62: <dh name="j"> has a centre of mass, but no mass
  expected mass="...": mass of the link behind the joint, such as 0.18 kg)"},
    {"a negative mass", joint(R"(<dh name="j" theta="encoder1" mass="-1 kg"/>)"),
     R"(model.xml:2:63: mass="-1 kg"
  expected zero or more)"},
    {"a mass in millimetres", joint(R"(<dh name="j" theta="encoder1" mass="1 mm"/>)"),
     R"(model.xml:2:65: 'mm' measures a length
  expected a mass (kg, g))"},
    {"a mass to be calibrated", joint(R"(<dh name="j" theta="encoder1" mass="1 ± 0.1"/>)"),
     R"(model.xml:2:63: mass="1 ± 0.1" is free
  expected a mass that is not calibrated, such as 0.18 kg)"},
    {"a centre of mass of two numbers",
     joint(R"(<dh name="j" theta="encoder1" mass="1 kg" com="1, 2"/>)"),
     R"(model.xml:2:74: com="1, 2"
  expected three lengths: x, y, z in the frame behind it)"},
    {"a centre of mass in degrees",
     joint(R"(<dh name="j" theta="encoder1" mass="1 kg" com="1, 2 deg, 3"/>)"),
     R"(model.xml:2:79: 'deg' measures an angle
  expected a length (mm, m, um, cm, in))"},
    {"gravity without a direction", around(R"(<gravity in="B" x="0"/>)"),
     R"(model.xml:2:3: gravity has no direction
  expected components of a vector that points down, such as z="-1")"},
    {"gravity in no frame", around(R"(<gravity in="F" z="-1"/>)"), R"(model.xml:2:16: no frame 'F'
  expected one of: B, E, joint1, joint2
  did you mean 'B'?)"},
    {"gravity of no size", around(R"(<gravity z="-1" magnitude="0"/>)"),
     R"(model.xml:2:30: magnitude="0"
  expected more than zero)"},
    {"gravity in kilograms", around(R"(<gravity z="-1" magnitude="9.81 kg"/>)"),
     R"(model.xml:2:35: 'kg' measures a mass
  expected an acceleration (m/s^2))"},
    {"gravity given twice", around(R"(<gravity z="-1"/> <gravity z="1"/>)"),
     R"(model.xml:2:21: gravity is given twice (before at model.xml:2:3)
  expected one <gravity>)"},
    {"a linkage held nowhere", around(R"(<gravity z="-1" held_at="F"/>)"),
     R"(model.xml:2:28: no frame 'F'
  expected one of: B, E, joint1, joint2
  did you mean 'B'?)"},
    {"a linkage held at its root", around(R"(<gravity z="-1" held_at="B"/>)"),
     R"(model.xml:2:28: 'B' is the root, which stands anyway
  expected the frame at the other end that something holds)"},
    {"a payload at no frame", around(R"(<payload at="jont2" mass="1 kg"/>)"),
     R"(model.xml:2:16: no frame 'jont2'
  expected one of: B, E, joint1, joint2
  did you mean 'joint2'?)"},
    {"a payload of no mass", around(R"(<payload at="E"/>)"),
     R"(model.xml:2:3: a payload at 'E' of no mass
  expected either column="...", a column of the recordings, or mass="2 kg")"},
    {"a payload of two masses", around(R"(<payload at="E" column="load" mass="1 kg"/>)"),
     R"(model.xml:2:3: a payload at 'E' with both a column and a mass
  expected either column="...", a column of the recordings, or mass="2 kg")"},
    {"no chain at all", "<talus>\n  <encoder name=\"q\"/>\n</talus>",
     R"(model.xml:1:1: the model has no <chain>
  expected at least one <chain from="..." to="...">)"},
    {"a residual that does not fit its feature",
     around(
         R"(<calibrate residual="position, inverse_direction_cosines" of="P"/><point name="P" at="E"/>)"),
     R"(model.xml:2:34: residual 'inverse_direction_cosines' cannot be taken of 'P', which is a point
  expected a feature of kind frame or direction)"},
    {"a residual of no feature", around(R"(<calibrate residual="position" of="other"/>)"),
     R"(model.xml:2:38: no measured feature 'other'
  expected one of: E)"},
    {"a feature nobody knows, further down in a list of several lines",
     around("<calibrate residual=\"position\" of=\"E,\n      other\"/>"),
     R"(model.xml:3:7: no measured feature 'other'
  expected one of: E)"},
    {"a residual nobody knows", around(R"(<calibrate residual="positon" of="E"/>)"),
     R"(model.xml:2:24: no residual 'positon' is known
  expected one of: closure, direction, distance, frame_points, inverse_direction_cosines, position, projection_angles, rotation_vector, turn, vector_length
  did you mean 'position'?)"},
    {"a residual taken twice",
     around(R"(<calibrate residual="position" of="E"/><calibrate residual="position"/>)"),
     R"(model.xml:2:63: residual 'position' of 'E' is taken twice
  expected each residual of a feature once)"},
    {"too many weights", around(R"(<calibrate residual="position" of="E" weight="0.3, 0.7"/>)"),
     R"(model.xml:2:49: 2 weights for 1 residuals
  expected one weight per residual)"},
    {"a free parameter that no residual sees",
     around(R"(<chain from="B" to="T"><mount name="m" x="1 ± 1"/></chain>)"),
     R"(model.xml:2:45: free parameter 'm.x' is seen by no residual
  expected it to be fixed (no tolerance, no '?'), or a measured feature whose chain it moves)"},
    {"a named parameter that nobody uses",
     around(R"(<parameter name="L" kind="length" value="3 ?"/>)"),
     R"(model.xml:2:44: free parameter 'L' is seen by no residual
  expected it to be fixed (no tolerance, no '?'), or a measured feature whose chain it moves)"},
    {"an unknown that no residual sees", around(R"(<unknown name="u" kind="angle" value="0"/>)"),
     R"(model.xml:2:3: unknown 'u' is seen by no residual
  expected a measured feature whose chain it moves)"},
    {"a probed shape that stands nowhere above",
     around(R"(<plane name="face"/><circle name="pin" on="fase"/>)"),
     R"(model.xml:2:46: no probed shape 'fase' above this
  expected one of: face
  did you mean 'face'?)"},
    {"points projected on a line", around(R"(<line name="side"/><circle name="pin" on="side"/>)"),
     R"(model.xml:2:45: 'side' is a line
  expected a plane or a circle to project the points on)"},
    {"points of a shape without their frame", around(R"(<plane name="face" probe="1, 2, 3"/>)"),
     R"(model.xml:2:29: 'face' has points but no frame
  expected at="...": the frame in which the points are given)"},
    {"a point of two numbers", around(R"(<plane name="face" at="E" probe="1, 2, 3; 4, 5"/>)"),
     R"(model.xml:2:44: the point '4, 5'
  expected three lengths: x, y, z; the next point behind a ';')"},
    {"a datum's axis without a shape",
     around(R"(<plane name="face"/><datum name="d" origin="face" primary="face"/>)"),
     R"(model.xml:2:62: primary="face"
  expected an axis and the shape it follows: y=face, or y=-face)"},
    {"a datum's axis along a sphere",
     around(R"(<sphere name="ball"/><datum name="d" origin="ball" primary="x=ball"/>)"),
     R"(model.xml:2:63: 'ball' is a sphere, which has no axis
  expected a plane, line, circle or cylinder)"},
    {"a feature probed by no datum",
     around(R"(<sphere name="ball"/><point name="P" at="E" probed="bal"/>)"),
     R"(model.xml:2:55: no datum or probed shape 'bal'
  expected one of: ball
  did you mean 'ball'?)"},
    {"a frame probed by a sphere",
     around(R"(<sphere name="ball"/><frame name="F" at="E" probed="ball"/>)"),
     R"(model.xml:2:55: 'ball' is a sphere
  expected a datum: a frame is measured)"},
    {"a limb at no frame",
     around(R"(<limb name="shank" at="jont1" length="1" width="1" height="1"/>)"),
     R"(model.xml:2:26: no frame 'jont1'
  expected one of: B, E, joint1, joint2
  did you mean 'joint1'?)"},
    {"a limb whose own name is no frame",
     around(R"(<limb name="joint3" length="1" width="1" height="1"/>)"),
     R"(model.xml:2:15: no frame 'joint3'
  expected one of: B, E, joint1, joint2
  did you mean 'joint1'?)"},
    {"a limb of no length", around(R"(<limb name="E" length="0" width="1" height="1"/>)"),
     R"(model.xml:2:26: length="0"
  expected more than zero)"},
    {"a limb's edge in degrees", around(R"(<limb name="E" length="9 deg" width="1" height="1"/>)"),
     R"(model.xml:2:28: 'deg' measures an angle
  expected a length (mm, m, um, cm, in))"},
    {"a limb's edge to be calibrated",
     around(R"(<limb name="E" length="9 ± 1" width="1" height="1"/>)"),
     R"(model.xml:2:26: length="9 ± 1" is free
  expected a length that is not calibrated, such as 60 mm)"},
    {"a limb's edge that is calibrated elsewhere",
     around(R"(<limb name="E" length="1" width="1" height="joint1.a"/>)"),
     R"(model.xml:2:47: height="joint1.a" is no fixed number
  expected a length that is not calibrated, such as 60 mm)"},
    {"a kind nobody knows", around(R"(<parameter name="L" kind="lenght" value="3"/>)"),
     R"(model.xml:2:29: kind="lenght"
  expected length, angle, number or a unit)"},
};

}  // namespace

TEST_CASE("models that mean nothing are refused in these very words") {
  for (const Case& c : cases) {
    CAPTURE(c.what);
    CAPTURE(c.text);
    CHECK(complaint(c.text) == std::string(c.complaint));
  }
}
