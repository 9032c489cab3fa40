#include <filesystem>

#include "framework/dsl/lua_elements.h"
#include "framework/dsl/lua_plugin.h"
#include "framework/dsl/lua_sandbox.h"
#include "framework/dsl/lua_traced.h"
#include "framework/dsl/read.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

int install(lua_State* L) {
  lua::install_traced(L);
  lua::install_definitions(L);
  lua::install_elements(L);  // last: from here on an unknown global is an error
  return 0;
}

// A sandbox in which the file has been run.
class Run {
 public:
  Run(const std::string& text, const std::string& file, Registry& registry)
      : reading_{&registry}, sandbox_(std::make_shared<LuaSandbox>(file)) {
    check_utf8(text, file);
    sandbox_->protect(&install, nullptr);
    sandbox_->reading = &reading_;
    try {
      sandbox_->run(text);
    } catch (...) {
      sandbox_->reading = nullptr;
      throw;
    }
  }
  ~Run() { sandbox_->reading = nullptr; }
  Run(const Run&) = delete;

  lua_State* state() { return sandbox_->state(); }
  const std::vector<std::string>& defined() const { return reading_.defined; }

 private:
  LuaSandbox::Reading reading_;
  std::shared_ptr<LuaSandbox> sandbox_;  // the plugins that were defined share it
};

}  // namespace

Element run_lua_model(const std::string& text, const std::string& file, Registry& registry) {
  Run run(text, file, registry);
  Element root = lua::read_tree(run.state(), text);
  if (!run.defined().empty()) {
    const std::string self = std::filesystem::path(file).filename().string();
    Element plugin{"plugin", {{"file", self, root.place}}, {}, root.place};
    root.children.insert(root.children.begin(), std::move(plugin));
  }
  return root;
}

void run_lua_plugins(const std::string& text, const std::string& file, Registry& registry) {
  Run run(text, file, registry);
  if (run.defined().empty())
    throw InputError({file, 0, 0}, "the file defines no plugins",
                     "joint \"name\" { ... } and the like");
}

}  // namespace talus
