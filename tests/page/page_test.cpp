#include "framework/page/page.h"

#include <doctest/doctest.h>

#include "framework/kinematics/posture.h"
#include "framework/kinematics/skeleton.h"
#include "framework/page/contents.h"
#include "framework/page/javascript.h"
#include "framework/page/linkage.h"
#include "framework/page/pack.h"
#include "framework/page/sha256.h"
#include "tests/support/models.h"

using namespace talus;

TEST_CASE("the digest is that of sha256sum") {
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256(std::string(1000000, 'a')) ==
        "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("lists of numbers are made small") {
  using Json = nlohmann::ordered_json;
  // 1 and -2 as 32-bit floats, lowest byte first, and a NaN
  const Json pair = Json::array({1, -2}), other = Json::array({3, 4});
  CHECK(packed(pair)["f32"] == "AACAPwAAAMA=");
  CHECK(packed(Json::array({nullptr}))["f32"] == "AADAfw==");

  Json first, columns = Json::array();
  columns.push_back({{"name", "q"}, {"values", pair}});
  first["coordinates"] = Json::array({pair, other});
  first["rows"] = Json::array({Json{{"name", "E.x"}, {"residuals", pair}}, Json{{"name", "E.y"}}});
  first["offsets"]["E"] = Json::array({other});
  Json second = first;
  pack(first, Json::array(), columns);
  CHECK(first["coordinates"][0] == Json{{"column", 0}});
  CHECK(first["coordinates"][1] == packed(other));
  CHECK(first["rows"][0]["residuals"] == packed(pair));
  CHECK_FALSE(first["rows"][1].contains("residuals"));
  CHECK(first["offsets"]["E"][0] == packed(other));
  pack(second, Json::array({first}), Json::array());
  CHECK(second["coordinates"][0] == packed(pair));
  CHECK(second["coordinates"][1] == Json{{"state", 0}, {"coordinate", 1}});
}

TEST_CASE("expressions become JavaScript") {
  Tape tape;
  const Expr a = Expr::leaf(tape, 0), b = Expr::leaf(tape, 2);
  const Expr smaller = less(a, b), first = sin(a) * -0.1, second = atan2(a, b) / 3;
  const Expr e = select(smaller, first, second);
  CHECK(javascript(tape, {e.node_on(tape), Expr(-2.5).node_on(tape)}) ==
        "function(s,o){const v0=s[0];\n"
        "const v1=s[2];\n"
        "const v2=v0<v1?1:0;\n"
        "const v3=Math.sin(v0);\n"
        "const v5=v3*(-0.1);\n"
        "const v6=Math.atan2(v0,v1);\n"
        "const v8=v6/3;\n"
        "const v9=v2!==0?v5:v8;\n"
        "o[0]=v9;\n"
        "o[1]=(-2.5);\n"
        "}");
}

TEST_CASE("what a linkage yields is where the posture has it") {
  const Program program = testing::program_from(R"(<talus name="arm" length="mm" angle="deg">
    <chain from="B" to="E">
      <dh name="j1" theta="q1" d="10" a="100" alpha="90"/>
      <dh name="j2" theta="q2" d="0" a="80" alpha="0"/>
    </chain>
    <encoder name="q1" range="-90, 90"/>
    <encoder name="q2"/>
    <frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/>
  </talus>)");
  const PageLinkage linkage = page_linkage(program);
  std::vector<double> slots = page_slots(program);
  const std::vector<double> coordinates{0.3, -0.7};
  for (std::size_t i = 0; i < 2; ++i) slots[program.readings[i].slot] = coordinates[i];
  TapeValues values(*program.tape, linkage.wanted);
  const std::vector<double> out = values(slots);
  Posture posture(program);
  posture.set(coordinates);
  Skeleton skeleton(program);
  skeleton.set(posture);
  const auto& frames = linkage.scene["frames"];
  REQUIRE(frames.size() == program.frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        CHECK(out[frames[f]["at"].get<std::size_t>() + static_cast<std::size_t>(4 * i + j)] ==
              doctest::Approx(posture.frame(static_cast<int>(f)).matrix()(i, j)));
  const auto& bones = linkage.scene["bones"];
  REQUIRE(bones.size() == skeleton.bones().size());
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Bone& bone = skeleton.bones()[b];
    REQUIRE(bones[b]["points"].size() == bone.points.size());
    for (std::size_t p = 0; p < bone.points.size(); ++p)
      for (int i = 0; i < 3; ++i)
        CHECK(out[bones[b]["points"][p].get<std::size_t>() + static_cast<std::size_t>(i)] ==
              doctest::Approx(bone.points[p][i]));
  }
  CHECK(linkage.scene["coordinates"][0]["low"] == -90);
  CHECK(linkage.scene["coordinates"][0]["limited"] == true);
  CHECK(linkage.scene["coordinates"][1]["limited"] == false);
  CHECK(linkage.scene["axes"][1]["before"] == 0);
}

TEST_CASE("a page holds its data, or says how to get one") {
  PageContent content;
  const Program program = testing::program_from(
      R"(<talus name="a &lt;/script&gt;&lt;b&gt; hinge" length="mm" angle="deg">
    <chain from="B" to="E"><revolute name="hinge" theta="q"/></chain>
    <encoder name="q"/>
    <frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/>
  </talus>)");
  page_of_model(content, program);
  if (!has_page_template()) {
    CHECK_THROWS_WITH_AS(write_page(content), doctest::Contains("scripts/setup"), InputError);
    return;
  }
  const std::string page = write_page(content);
  CHECK(page.find("<!--talus:") == std::string::npos);
  CHECK(page.find("<b> hinge") == std::string::npos);
  CHECK(page.find("\\u003c/script") != std::string::npos);
  CHECK(page.find("window.talusLinkages=[function(s,o){") != std::string::npos);
}
