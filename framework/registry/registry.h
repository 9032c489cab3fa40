// The registry: the grammar of model files. A tag is the name of a plugin; whatever is registered
// can be written. Built-in plugins are there from the start, others are added by loading a shared
// library or a Lua file that the user names.
//
// Residuals are not elements but words of <calibrate residual="...">, so a residual may bear the
// name of an element: the feature `direction` and the residual `direction`.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/model/error.h"
#include "framework/registry/plugin.h"

namespace talus {

// Raised whenever plugins must be rebuilt; a shared library of another version is refused.
inline constexpr int plugin_interface_version = 3;

class Registry {
 public:
  // All built-in plugins. A copy is cheap enough to extend for one model.
  static Registry& built_in();

  void add(Plugin plugin);  // InputError where the tag is taken or the declaration is unsound
  const Plugin* find(std::string_view tag) const;  // elements before residuals
  const Plugin* find(std::string_view tag, Family family) const;
  std::vector<const Plugin*> all() const;  // by family, then by tag
  std::vector<std::string> tags(Family family) const;

  // Loads a plugin library (.so); InputError names the file and, where it was built for another
  // interface, both versions.
  void load_library(const std::string& file);

 private:
  std::map<std::string, Plugin, std::less<>> elements_, residuals_;
};

}  // namespace talus
