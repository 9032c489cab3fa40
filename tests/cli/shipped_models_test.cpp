// Every model that is shipped: checked, converted both ways, valid by the schema.
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;
namespace fs = std::filesystem;

TEST_CASE("every shipped model passes the check and is the same after conversion and back") {
  const Folder folder;
  std::vector<std::string> models = shipped_models();
  for (const std::string& file : shipped_models(".lua")) models.push_back(file);
  REQUIRE(models.size() > 10);
  for (const std::string& file : models) {
    CAPTURE(file);
    const Run check = command(folder, "check '" + file + "'");
    CAPTURE(check.error);
    CHECK(check.code == 0);
    CHECK(command(folder, "convert '" + file + "' there.xml").code == 0);
    CHECK(command(folder, "convert there.xml there.lua").code == 0);
    CHECK(command(folder, "convert there.lua back.xml").code == 0);
    Model model = model_of(file);
    move_plugin_paths(model, file, folder / "there.xml");
    for (const char* converted : {"there.xml", "there.lua", "back.xml"}) {
      CAPTURE(converted);
      CHECK(same(model_of(folder / converted).root, model.root));
    }
    CHECK(contents(folder / "back.xml") == contents(folder / "there.xml"));
  }
}

TEST_CASE("a model in XML and in Lua with one name is one model") {
  int twins = 0;
  for (const std::string& file : shipped_models()) {
    const fs::path lua = fs::path(file).replace_extension(".lua");
    if (!fs::exists(lua)) continue;
    CAPTURE(file);
    ++twins;
    CHECK(same(model_of(file).root, model_of(lua.string()).root));
  }
  CHECK(twins >= 8);
  // Every device is there in both.
  for (const auto& folder : fs::directory_iterator(TALUS_SOURCE_DIR "/models"))
    if (folder.is_directory() && !fs::is_empty(folder)) {
      CAPTURE(folder.path().string());
      CHECK(fs::exists(folder.path() / "model.xml"));
      CHECK(fs::exists(folder.path() / "model.lua"));
    }
}

TEST_CASE("every shipped XML model is valid by the schema") {
  if (shell("xmllint --version") != 0) {
    MESSAGE("xmllint is not installed: skipped");
    return;
  }
  const Folder folder;
  for (const std::string& file : shipped_models()) {
    CAPTURE(file);
    Registry registry = Registry::built_in();  // and the plugins that the model names
    read_model(file, registry);
    folder.write("talus.xsd", xml_schema(registry));
    CHECK(shell("xmllint --noout --schema '" + folder / "talus.xsd" + "' '" + file + "'") == 0);
  }
  // And it does refuse: a misspelt attribute, a joint outside a chain.
  const std::string bad = folder.write(
      "bad.xml",
      R"(<talus><chain from="B" to="E"><dh name="j" theta="q" alhpa="90"/></chain></talus>)");
  CHECK(shell("xmllint --noout --schema '" + folder / "talus.xsd" + "' '" + bad + "'") != 0);
  const std::string outside =
      folder.write("outside.xml", R"(<talus><dh name="j" theta="q"/></talus>)");
  CHECK(shell("xmllint --noout --schema '" + folder / "talus.xsd" + "' '" + outside + "'") != 0);
}
