// A Lua 5.4 state for files from strangers. Text only; no way to files, the system, other modules
// or the state's own machinery; limits on steps, memory and time, which hold again for every call.
// What is left of the libraries ends in a bounded time between two steps (so no patterns), and
// gives the same results in every run (so no random numbers; pairs() goes in the order of the
// keys).
//
// Lua is C: its errors jump over frames without unwinding them, and no exception may pass through
// it. So a callback keeps three parts apart: Lua calls with plain locals; C++ work inside guard(),
// which must not call what can raise a Lua error; Lua calls again. What C++ throws in guard() is
// kept, jumps out as a Lua error, and is thrown again by protect().
#pragma once

#include <cstdint>
#include <lua.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/model/error.h"

namespace talus {

class Registry;

struct LuaLimits {
  std::int64_t steps = 50'000'000;
  std::size_t memory = 256u << 20;  // bytes
  double seconds = 20;              // far above what the steps take; ends misuse of the libraries
};

class LuaSandbox : public std::enable_shared_from_this<LuaSandbox> {
 public:
  explicit LuaSandbox(std::string file, LuaLimits limits = {});
  ~LuaSandbox();
  LuaSandbox(const LuaSandbox&) = delete;
  LuaSandbox& operator=(const LuaSandbox&) = delete;

  static LuaSandbox& of(lua_State* L);
  lua_State* state() { return L_; }
  const std::string& file() const { return file_; }

  // What a file may add to while it is being run; not so in later calls of its functions.
  struct Reading {
    Registry* registry;
    std::vector<std::string> defined = {};  // tags of plugins
  };
  Reading* reading = nullptr;

  // Runs the text of the file; its first result is left on the stack. InputError on any failure.
  void run(const std::string& text);

  // Calls function(L) with `data` as its argument (a light userdata) under fresh limits; nothing is
  // left on the stack. Everything that can raise a Lua error must happen in such a call.
  void protect(lua_CFunction function, void* data);

  // For callbacks. The line of the file that is being run.
  Place place(lua_State* L) const;
  // Counts work done in C++ as so many steps; raises a Lua error where the limit is passed.
  void charge(lua_State* L, std::int64_t steps);

  // Keeps the exception being handled, for raise().
  void keep(lua_State* L) noexcept;
  [[noreturn]] static void raise(lua_State* L);

 private:
  static void* allocate(void* self, void* block, std::size_t old_size, std::size_t size);
  static void hook(lua_State* L, lua_Debug*);
  static int on_error(lua_State* L);
  static int open(lua_State* L);
  void call(int arguments, int results);
  [[noreturn]] void fail(int status);

  std::string file_;
  LuaLimits limits_;
  lua_State* L_ = nullptr;
  std::size_t used_ = 0;
  std::int64_t steps_left_ = 0;
  double stop_at_ = 0;  // on the steady clock
  int line_ = 0;        // where the last error came up
  bool running_ = false;
  std::optional<InputError> kept_;
  std::mutex mutex_;  // one call at a time
};

// Runs body(), C++ work inside a callback. It captures by reference and calls nothing of Lua that
// can raise.
template <class Body>
void guard(lua_State* L, Body body) {
  static_assert(std::is_trivially_destructible_v<Body>);
  bool failed = false;
  try {
    body();
  } catch (...) {
    LuaSandbox::of(L).keep(L);
    failed = true;
  }
  if (failed) LuaSandbox::raise(L);
}

// Ends a callback with an InputError at the line being run.
[[noreturn]] void refuse(lua_State* L, const char* found, const char* expected = "");

// The same complaint at another place.
InputError moved(const InputError& error, const Place& place);

// Is this a name of Lua's own that is not available in a model file?
bool is_forbidden_in_lua(std::string_view global);

}  // namespace talus
