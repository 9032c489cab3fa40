// What is wrong in an XML model, and the very words in which it is said.
#include <doctest/doctest.h>

#include <string>

#include "framework/dsl/dsl.h"

using namespace talus;

namespace {

std::string complaint(const std::string& text) {
  Registry registry = Registry::built_in();
  try {
    read_xml(text, "arm.xml", registry);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

// A model with this in its chain, or beside its chain.
std::string in_chain(const std::string& joints) {
  return "<talus>\n  <chain from=\"B\" to=\"E\">\n    " + joints + "\n  </chain>\n</talus>";
}
std::string beside_chain(const std::string& elements) {
  return "<talus>\n  " + elements + "\n</talus>";
}

struct Case {
  const char* what;
  std::string text;
  const char* complaint;
};

const Case cases[] = {
    {"a misspelt attribute", in_chain(R"(<dh name="j1" theta="q" alhpa="90"/>)"),
     R"(arm.xml:3:36: <dh> has no attribute 'alhpa'
  expected one of: name, theta, d, a, alpha, mass, com, link
  did you mean 'alpha'?)"},
    {"an attribute nobody knows", beside_chain(R"(<constant name="L" value="3" colour="red"/>)"),
     R"(arm.xml:2:40: <constant> has no attribute 'colour'
  expected one of: name, value)"},
    {"a misspelt tag", in_chain(R"(<mout name="base"/>)"),
     R"(arm.xml:3:5: no element <mout> is known
  did you mean 'mount'?)"},
    {"a limb without its height", beside_chain(R"(<limb name="shank" length="1" width="1"/>)"),
     R"(arm.xml:2:3: <limb name="shank"> lacks the attribute 'height'
  expected height: its edge along z)"},
    {"two limbs of one name",
     beside_chain(
         R"(<limb name="a" length="1" width="1" height="1"/><limb name="a" length="1" width="1" height="1"/>)"),
     R"(arm.xml:2:63: the name 'a' is given twice
  expected another one than that of <limb> at arm.xml:2:3)"},
    {"a joint outside a chain", beside_chain(R"(<dh name="j1" theta="q"/>)"),
     R"(arm.xml:2:3: <dh name="j1"> may not stand inside <talus>
  expected it inside a <chain>)"},
    {"a sensor inside a chain", in_chain(R"(<encoder name="q"/>)"),
     R"(arm.xml:3:5: <encoder name="q"> may not stand inside <chain>
  expected it directly inside <talus>)"},
    {"children where there are none",
     in_chain(R"(<dh name="j1" theta="q"><dh name="j2" theta="q"/></dh>)"),
     R"(arm.xml:3:29: <dh> stands inside <dh name="j1">, which has no children)"},
    {"a residual as an element", beside_chain(R"(<position/>)"),
     R"(arm.xml:2:3: <position> is a residual, not an element
  expected it to be named by a calibrate: <calibrate residual="position" of="..."/>)"},
    {"no name", in_chain(R"(<dh theta="q"/>)"),
     R"(arm.xml:3:5: <dh> lacks the attribute 'name'
  expected name: its name and that of the frame behind it)"},
    {"a coordinate left out", in_chain(R"(<dh name="j1" a="300"/>)"),
     R"(arm.xml:3:5: <dh name="j1"> lacks the attribute 'theta'
  expected theta: rotation about z of A; an angle (deg, rad, mrad, arcmin, arcsec))"},
    {"two joints of one name", in_chain(R"(<dh name="j1" theta="q"/> <dh name="j1" theta="q"/>)"),
     R"(arm.xml:3:41: the name 'j1' is given twice
  expected another one than that of <dh> at arm.xml:3:5)"},
    {"a name that expressions cannot use", beside_chain(R"(<encoder name="encoder 1"/>)"),
     R"(arm.xml:2:18: 'encoder 1' cannot be a name
  expected letters, digits and '_', with no digit first)"},
    {"a wrong word for a choice", in_chain(R"(<mount name="base" order="zxy"/>)"),
     R"(arm.xml:3:31: order of <mount name="base"> cannot be 'zxy'
  expected one of: zxz, rpy, vector
  did you mean 'zxz'?)"},
    {"a misspelt residual",
     beside_chain(R"(<calibrate residual="position, rotation_vektor" of="E"/>)"),
     R"(arm.xml:2:24: no residual 'rotation_vektor' is known)"},
    {"the input of a residual not asked for",
     beside_chain(R"(<calibrate residual="position" of="E" arm="50"/>)"),
     R"(arm.xml:2:46: 'arm' is an input of the residual frame_points, which is not named here)"},
    {"an unknown loss", beside_chain(R"(<calibrate residual="position" of="E" loss="hubber 2"/>)"),
     R"(arm.xml:2:47: loss of <calibrate> cannot be 'hubber 2'
  expected huber or cauchy with its scale in sigmas: huber 2
  did you mean 'huber'?)"},
    {"a unit of length that is none", R"(<talus length="deg"/>)",
     R"(arm.xml:1:16: 'deg' is no unit of length
  expected one of: mm, m, cm, um, in)"},
    {"another root", R"(<robot name="arm"/>)",
     R"(arm.xml:1:1: the root element is <robot>
  expected <talus>)"},
    {"two roots", "<talus/>\n<talus/>",
     R"(arm.xml:2: a second root, <talus>
  expected one <talus> holding everything)"},
    {"text", beside_chain("gravity points down"),
     R"(arm.xml:2: text 'gravity points down' stands inside <talus>
  expected attributes and elements only; remarks go into <!-- comments -->)"},
    {"an attribute twice", in_chain(R"(<dh name="j1" theta="q" theta="r"/>)"),
     R"(arm.xml:3: the attributes of <dh> cannot be read
  expected name="value" pairs, each name once)"},
    {"an element not closed", "<talus>\n  <chain from=\"B\" to=\"E\">\n</talus>",
     R"(arm.xml:2: <chain> is not closed where it should be
  expected </chain>)"},
    {"quotes left out", in_chain("<dh name=j1/>"),
     R"(arm.xml:3: the attributes of <dh> cannot be read
  expected name="value" pairs, each name once)"},
    {"nothing", "", R"(arm.xml: the file has no elements
  expected <talus> ... </talus>)"},
    {"another encoding", beside_chain("<encoder name=\"q\" slope=\"1 \xB1 0.1\"/>"),
     R"(arm.xml:2:30: the byte 0xB1 is not UTF-8 text
  expected a file saved as UTF-8 (tolerances may also be written in ASCII: 300 +- 0.5))"},
    {"a shared library in a model", beside_chain(R"(<plugin file="evil.so"/>)"),
     R"(arm.xml:2:17: 'evil.so' is not a Lua plugin file
  expected a name ending in .lua; a shared library is loaded only when the user names it: --plugin FILE.so)"},
    {"an included file that is not there", beside_chain(R"(<include file="nowhere.xml"/>)"),
     R"(arm.xml:2:18: there is no file 'nowhere.xml')"},
};

}  // namespace

TEST_CASE("complaints about XML models") {
  for (const Case& c : cases) {
    const std::string heard = complaint(c.text), wanted = c.complaint;
    INFO("case: " << std::string(c.what));
    // Lists of what is registered grow; only their beginnings are fixed here.
    CHECK((c.what == std::string("a misspelt residual") ? heard.substr(0, wanted.size()) : heard) ==
          wanted);
  }
}
