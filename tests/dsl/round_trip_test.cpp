// XML and Lua are two spellings of one tree: what is written reads back the same, in either.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "framework/dsl/dsl.h"

using namespace talus;
namespace fs = std::filesystem;

namespace {

const char* const knee = R"(<?xml version="1.0"?>
<!-- remarks are not kept, <dh/> in them is no element -->
<talus name="Knee &quot;linkage&quot; &amp; &lt;more&gt;" length="mm" angle="deg" about="first&#10;second \ line">
  <constant name="L" value="300 mm"/>
  <chain from="B" to="E">
    <mount name="base" x="54 ± 1" y="-69 +- 1" order="rpy" c="-60 ± 5"/>
    <dh theta="encoder1" name="joint1" d="L"   alpha="90 ± 1"/> <dh name="joint2" theta="0x10"
        a="300 ?"/>
  </chain>
  <encoder name="encoder1" column="theta1" slope="1 ± 0.01" intercept="150 ± 5 [140, 160]"/>
  <frame name="E" in="B" columns="E" sigma="0.005 mm, 0.002 deg"/>
  <length name="P" in="B" at="E" x="1e3"/>
  <calibrate residual="position, projection_angles" of="E" weight="0.35, 0.65"/>
</talus>)";

struct Folder {  // of model files that name each other
  fs::path path = fs::temp_directory_path() / "talus_dsl_test";
  Folder() { fs::remove_all(path), fs::create_directories(path / "parts"); }
  ~Folder() { fs::remove_all(path); }
  std::string write(const std::string& file, const std::string& text) const {
    std::ofstream(path / file) << text;
    return (path / file).string();
  }
};

}  // namespace

TEST_CASE("a model is the same after any number of conversions") {
  Registry registry = Registry::built_in();
  const Model first = read_xml(knee, "knee.xml", registry);
  const std::string xml = write_xml(first), lua = write_lua(first);
  const Model from_xml = read_xml(xml, "knee.xml", registry),
              from_lua = read_lua(lua, "knee.lua", registry);
  CHECK(same(first.root, from_xml.root));
  CHECK(same(first.root, from_lua.root));
  CHECK(write_xml(from_lua) == xml);
  CHECK(write_lua(from_xml) == lua);
  CHECK(first.root.text("about") == "first\nsecond \\ line");
  CHECK(from_lua.root.children[1].children[2].text("theta") == "0x10");  // text stays text
}

TEST_CASE("what is written is pleasant to read") {
  Registry registry = Registry::built_in();
  const Model model = read_xml(R"(<talus name="arm"><chain from="B" to="E">
    <dh name="j1" theta="q1" a="300 ± 0.5" alpha="90"/><dh theta="q2 + 90 deg" name="j2" a="0" alpha="-90"/>
    <dh name="j3" theta="q3" a="5" alpha="0"/></chain><frame name="E" in="B"/></talus>)",
                               "arm.xml", registry);
  CHECK(write_xml(model) == R"(<?xml version="1.0" encoding="UTF-8"?>
<talus name="arm">
  <chain from="B" to="E">
    <dh name="j1" theta="q1" a="300 ± 0.5" alpha="90"/>
    <dh name="j2" theta="q2 + 90 deg" a="0" alpha="-90"/>
    <dh name="j3" theta="q3" a="5" alpha="0"/>
  </chain>
  <frame name="E" in="B"/>
</talus>
)");
  Registry other = Registry::built_in();
  CHECK(write_lua(read_lua("return talus { name = 'arm', chain { from = 'B', to = 'E',"
                           "dh { name = 'j1', theta = 'q1', a = 300 }, dh { name = 'j2', theta = "
                           "'q2 + q1', a = 0.1 },"
                           "}, frame { name = 'E', in_ = 'B' } }",
                           "arm.lua", other)) ==
        R"(return talus { name = "arm",
  chain { from = "B", to = "E",
    dh { name = "j1", theta = "q1",      a = "300" },
    dh { name = "j2", theta = "q2 + q1", a = "0.1" },
  },
  frame { name = "E", in_ = "B" },
}
)");
}

TEST_CASE("Lua computes models") {
  Registry registry = Registry::built_in();
  const Model model = read_lua(R"(
    local with_tool, third = false, 1 / 3
    local function arm(n)
      local joints = {}
      for i = 1, n do joints[i] = dh { name = "joint"..i, theta = "encoder"..i, a = i * 100, d = third } end
      return joints
    end
    local sensors = {}
    for key, slope in pairs { encoder2 = 2, encoder1 = -1.5 } do
      sensors[#sensors + 1] = encoder { name = key, slope = slope }
    end
    return talus { chain { from = "B", to = "E", arm(2), with_tool and fixed { name = "tool" } }, sensors,
                   length { name = "P", at = "E", in_ = "B" } })",
                               "arm.lua", registry);
  CHECK(write_xml(model) == R"(<?xml version="1.0" encoding="UTF-8"?>
<talus>
  <chain from="B" to="E">
    <dh name="joint1" theta="encoder1" a="100" d="0.3333333333333333"/>
    <dh name="joint2" theta="encoder2" a="200" d="0.3333333333333333"/>
  </chain>
  <encoder name="encoder1" slope="-1.5"/>
  <encoder name="encoder2" slope="2"/>
  <length name="P" at="E" in="B"/>
</talus>
)");
  CHECK(to_string(model.root.children[0].children[1].find("a")->place) == "arm.lua:5:85");
}

TEST_CASE("places are those of the values") {
  Registry registry = Registry::built_in();
  const Model model = read_xml(knee, "knee.xml", registry);
  const Element& joint2 = model.root.children[1].children[2];
  CHECK(to_string(joint2.place) == "knee.xml:7:65");
  CHECK(to_string(joint2.find("a")->place) == "knee.xml:8:12");
  CHECK(to_string(model.root.children[1].children[0].find("order")->place) == "knee.xml:6:55");
}

TEST_CASE("files that stand in each other") {
  Folder folder;
  folder.write("parts/joints.lua", R"(joint "twist" { q = coordinate(angle), h = length(0),
    transform = function(p) return rotate_z(p.q) * translate_z(p.h) end })");
  folder.write("parts/arm.xml", R"(<talus><plugin file="joints.lua"/><encoder name="q"/></talus>)");
  folder.write("parts/joint.lua", R"(return talus { twist { name = "t", q = "q", h = 3 } })");
  const std::string main =
      folder.write("model.xml", R"(<talus name="m"><include file="parts/arm.xml"/>
    <chain from="B" to="E"><include file="parts/joint.lua"/></chain></talus>)");
  Registry registry = Registry::built_in();
  Model model = read_model(main, registry);
  CHECK(write_xml(model) == R"(<?xml version="1.0" encoding="UTF-8"?>
<talus name="m">
  <plugin file="parts/joints.lua"/>
  <encoder name="q"/>
  <chain from="B" to="E">
    <twist name="t" q="q" h="3"/>
  </chain>
</talus>
)");
  CHECK(model.sources.size() == 4);
  CHECK(registry.find("twist")->origin == (folder.path / "parts/joints.lua").string());

  SUBCASE("written elsewhere, plugins are still found") {
    move_plugin_paths(model, main, (folder.path / "out/fitted.xml").string());
    CHECK(model.root.children[0].text("file") == "../parts/joints.lua");
  }
  SUBCASE("a file that includes itself") {
    folder.write("parts/arm.xml", R"(<talus><include file="../model.xml"/></talus>)");
    Registry fresh = Registry::built_in();
    std::string heard;
    try {
      read_model(main, fresh);
    } catch (const InputError& e) {
      heard = e.what();
    }
    CHECK(heard.find("parts/arm.xml:1:23: '../model.xml' includes itself: ") != std::string::npos);
  }
  SUBCASE("an included file in other units") {
    folder.write("parts/arm.xml", R"(<talus angle="rad"><encoder name="q"/></talus>)");
    Registry fresh = Registry::built_in();
    CHECK_THROWS_AS(read_model(main, fresh), InputError);
  }
}

TEST_CASE("a Lua model with plugins of its own can be converted") {
  Folder folder;
  const std::string lua = folder.write("own.lua", R"(
    joint "twist" { q = coordinate(angle), transform = function(p) return rotate_z(p.q) end }
    return talus { chain { from = "B", to = "E", twist { name = "t", q = "s" } }, encoder { name = "s" } })");
  Registry registry = Registry::built_in(), fresh = Registry::built_in();
  const Model model = read_model(lua, registry);
  const std::string xml = folder.write("own.xml", write_xml(model));
  CHECK(same(read_model(xml, fresh).root, model.root));
  CHECK(fresh.find("twist") != nullptr);
  CHECK(same(read_model(lua, fresh).root, model.root));  // once more into the same registry
}
