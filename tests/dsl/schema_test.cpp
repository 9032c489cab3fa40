// The schema accepts what the checker accepts, and knows every registered plugin.
#include <doctest/doctest.h>
#include <tinyxml2.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "framework/dsl/dsl.h"

using namespace talus;
namespace fs = std::filesystem;

TEST_CASE("every element is declared once, with its meaning") {
  const std::string schema = xml_schema(Registry::built_in());
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(schema.c_str()) == tinyxml2::XML_SUCCESS);
  std::set<std::string> names;
  for (auto* e = document.RootElement()->FirstChildElement(); e; e = e->NextSiblingElement()) {
    CHECK(names.insert(e->Attribute("name")).second);
    CHECK(e->FirstChildElement("xs:annotation")->FirstChildElement()->GetText() != nullptr);
  }
  for (const Plugin* plugin : Registry::built_in().all())
    if (plugin->declaration.family != Family::residual)
      CHECK(names.count(plugin->declaration.tag) == 1);
  CHECK(schema.find("<xs:enumeration value=\"rpy\"/>") != std::string::npos);
}

TEST_CASE("xmllint agrees with the checker" *
          doctest::skip(std::system("xmllint --version 2>/dev/null") != 0)) {
  const fs::path folder = fs::temp_directory_path() / "talus_schema_test";
  fs::create_directories(folder);
  std::ofstream(folder / "talus.xsd") << xml_schema(Registry::built_in());
  const auto valid = [&](const std::string& text) {
    std::ofstream(folder / "model.xml") << text;
    const std::string command = "xmllint --noout --schema " + (folder / "talus.xsd").string() +
                                " " + (folder / "model.xml").string() + " 2>/dev/null";
    return std::system(command.c_str()) == 0;
  };
  const auto accepted = [&](const std::string& text) {
    try {
      Registry registry = Registry::built_in();
      read_xml(text, "model.xml", registry);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  for (const auto& [text, good] :
       {std::pair{R"(<talus xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
                               xsi:noNamespaceSchemaLocation="talus.xsd" name="arm"><chain from="B" to="E">
               <mount name="m" order="rpy" x="54 ± 1"/><dh name="j" theta="q"/></chain><encoder name="q"/>
               <frame name="E" in="B"/><calibrate residual="frame_points" of="E" arm="50"/></talus>)",
                  true},
        std::pair{R"(<talus><chain from="B"/></talus>)", false},
        std::pair{R"(<talus><dh name="j" theta="q"/></talus>)", false},
        std::pair{R"(<talus><chain from="B" to="E"><dh name="j"/></chain></talus>)", false},
        std::pair{R"(<talus><chain from="B" to="E"><mount name="m" order="zyx"/></chain></talus>)",
                  false},
        std::pair{R"(<talus><encoder name="q" slop="1"/></talus>)", false}}) {
    const std::string model = text;
    CAPTURE(model);
    CHECK(valid(text) == good);
    CHECK(accepted(text) == good);
  }
  fs::remove_all(folder);
}
