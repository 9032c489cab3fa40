// Linkages with closed loops, for tests.
#pragma once

#include "tests/support/models.h"

namespace talus::testing {

// A planar four-bar linkage, crank and rocker read by encoders, joined by a rod of known length
// that nothing measures.
inline Model four_bar() {
  Registry registry = Registry::built_in();
  return read_xml(R"(<talus name="Four-bar linkage" length="mm" angle="deg">
    <chain from="ground" to="crank_pin"><dh name="crank" theta="encoder1" a="60 ± 0.5"/></chain>
    <chain from="ground" to="rocker_pin">
      <mount name="post" x="150 ± 0.5"/>
      <dh name="rocker" theta="encoder2" a="100 ± 0.5"/>
    </chain>
    <encoder name="encoder1" intercept="0 ± 1" sigma="0.01" range="-180, 180"/>
    <encoder name="encoder2" intercept="0 ± 1" sigma="0.01" range="60, 180"/>
    <closure name="coupler" in="rocker_pin" at="crank_pin" sigma="0.02"/>
    <calibrate residual="distance" of="coupler" nominal="130"/>
    </talus>)",
                  "four-bar.xml", registry);
}

// The spatial linkage of Bonny et al. 2013 on its fixture, whose two shafts are read as well: a
// loop of eight joints, closed at the clamps. Nothing else is measured.
inline Model isl_on_fixture() {
  Model model = model_of(shipped("isl-bonny-2013/model.xml"));
  std::erase_if(model.root.children, [](const Element& e) {
    return e.tag == "include" || e.tag == "frame" || e.tag == "calibrate" ||
           e.name().starts_with("B_") || e.name().starts_with("E_");
  });
  const Model fixture = model_of(shipped("isl-bonny-2013/fixture.xml"));
  for (Element e : fixture.root.children) {
    if (e.tag == "chain") e.set("to", "F");
    if (e.tag == "encoder") e.set("sigma", "0.005");
    if (e.tag == "chain" || e.tag == "encoder") model.root.children.push_back(e);
  }
  Element closure;
  closure.tag = "closure";
  closure.set("name", "clamp"), closure.set("in", "F"), closure.set("at", "E");
  closure.set("sigma", "0.01 mm, 0.005 deg");
  model.root.children.push_back(closure);
  return model;
}

}  // namespace talus::testing
