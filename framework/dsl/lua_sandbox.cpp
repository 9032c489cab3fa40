#include "framework/dsl/lua_sandbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "framework/dsl/lua_libraries.h"
#include "framework/dsl/text.h"

namespace talus {
namespace {

constexpr int steps_between_looks = 100;
constexpr const char* chunk = "=model";  // short, so that Lua does not cut it in its messages
constexpr std::string_view prefix = "model:";
constexpr std::size_t longest_message = 500;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The line of the innermost Lua function; allocates nothing.
int current_line(lua_State* L) {
  lua_Debug frame;
  for (int level = 0; lua_getstack(L, level, &frame); ++level)
    if (lua_getinfo(L, "l", &frame) && frame.currentline > 0) return frame.currentline;
  return 0;
}

}  // namespace

LuaSandbox::LuaSandbox(std::string file, LuaLimits limits)
    : file_(std::move(file)), limits_(limits) {
  L_ = lua_newstate(&allocate, this);
  if (!L_) throw std::bad_alloc();
  *static_cast<LuaSandbox**>(lua_getextraspace(L_)) = this;
  lua_sethook(L_, &hook, LUA_MASKCOUNT, steps_between_looks);
  try {
    protect(&open, nullptr);
  } catch (...) {
    lua_close(L_);
    throw;
  }
}

LuaSandbox::~LuaSandbox() { lua_close(L_); }

LuaSandbox& LuaSandbox::of(lua_State* L) {
  return **static_cast<LuaSandbox**>(lua_getextraspace(L));
}

int LuaSandbox::open(lua_State* L) {
  install_libraries(L);
  return 0;
}

void* LuaSandbox::allocate(void* self, void* block, std::size_t old_size, std::size_t size) {
  auto& s = *static_cast<LuaSandbox*>(self);
  const std::size_t old = block ? old_size : 0;  // without a block, old_size tells the type
  if (size == 0) {
    std::free(block);
    s.used_ -= old;
    return nullptr;
  }
  void* result =
      size > old && s.used_ + (size - old) > s.limits_.memory ? nullptr : std::realloc(block, size);
  if (result) {
    s.used_ = s.used_ - old + size;
    if (size > old) s.steps_left_ -= static_cast<std::int64_t>((size - old) / 64);
  } else if (s.running_) {
    s.line_ = current_line(s.L_);
  }
  return result;
}

void LuaSandbox::hook(lua_State* L, lua_Debug*) { of(L).charge(L, steps_between_looks); }

void LuaSandbox::charge(lua_State* L, std::int64_t steps) {
  if (!running_) return;  // closing
  steps_left_ -= steps;
  if (steps_left_ >= 0 && now() < stop_at_) return;
  guard(L, [&] {
    throw InputError(place(L),
                     steps_left_ < 0
                         ? fmt::format("stopped after {} million steps", limits_.steps / 1'000'000)
                         : fmt::format("stopped after {} seconds", limits_.seconds),
                     "a model file that is read in a moment; is there a loop without an end?");
  });
}

Place LuaSandbox::place(lua_State* L) const { return {file_, current_line(L), 0}; }

void LuaSandbox::keep(lua_State* L) noexcept {
  try {
    try {
      throw;
    } catch (const InputError& e) {
      kept_.emplace(e);
    } catch (const std::exception& e) {
      kept_.emplace(place(L), e.what());
    }
  } catch (...) {
    kept_.reset();  // out of memory: raise() says no more than that
  }
}

void LuaSandbox::raise(lua_State* L) {
  lua_pushnil(L);
  lua_error(L);
  std::abort();  // lua_error does not return
}

// Runs before the stack unwinds.
int LuaSandbox::on_error(lua_State* L) {
  of(L).line_ = current_line(L);
  return 1;
}

void LuaSandbox::call(int arguments, int results) {
  steps_left_ = limits_.steps;
  stop_at_ = now() + limits_.seconds;
  line_ = 0;
  kept_.reset();
  running_ = true;
  const int handler = lua_gettop(L_) - arguments;
  lua_pushcfunction(L_, &on_error);
  lua_insert(L_, handler);
  const int status = lua_pcall(L_, arguments, results, handler);
  running_ = false;
  lua_remove(L_, handler);
  if (status != LUA_OK) fail(status);
}

// Makes an InputError of the error on top of the stack.
void LuaSandbox::fail(int status) {
  std::string text =
      lua_type(L_, -1) == LUA_TSTRING ? lua_tostring(L_, -1) : "an error without a message";
  lua_pop(L_, 1);
  if (kept_) {
    InputError error = *kept_;
    kept_.reset();
    throw error;
  }
  Place place{file_, line_, 0};
  if (status == LUA_ERRMEM)
    throw InputError(place, fmt::format("stopped: more than {} MB of memory", limits_.memory >> 20),
                     "a model file that needs little; does a table or a text grow without an end?");
  if (text.starts_with(prefix)) {
    char* end = nullptr;
    place.line = static_cast<int>(std::strtol(text.c_str() + prefix.size(), &end, 10));
    text.erase(0, end - text.c_str());
    text.erase(0, text.find_first_not_of(": "));
  }
  if (text.size() > longest_message) {  // the file's own error()
    text.resize(longest_message);
    while (!is_utf8(text)) text.pop_back();
    text += " ...";
  }
  std::string expected;
  if (status == LUA_ERRSYNTAX && text.ends_with("near 'in'"))
    expected = "in_ = \"...\" for the attribute 'in', which is a word of the Lua language";
  throw InputError(place, text, expected);
}

void LuaSandbox::run(const std::string& text) {
  line_ = 0;
  running_ = true;  // the parser allocates
  steps_left_ = limits_.steps;
  stop_at_ = now() + limits_.seconds;
  const int status = luaL_loadbufferx(L_, text.data(), text.size(), chunk, "t");
  running_ = false;
  if (status != LUA_OK) fail(status);
  call(0, 1);
}

void LuaSandbox::protect(lua_CFunction function, void* data) {
  std::lock_guard lock(mutex_);
  if (!lua_checkstack(L_, 8)) throw std::bad_alloc();
  lua_pushcfunction(L_, function);
  lua_pushlightuserdata(L_, data);
  call(1, 0);
}

void refuse(lua_State* L, const char* found, const char* expected) {
  guard(L, [&] { throw InputError(LuaSandbox::of(L).place(L), found, expected); });
  std::abort();  // guard has raised
}

InputError moved(const InputError& error, const Place& place) {
  const std::string what = error.what(), before = to_string(error.place()) + ": ";
  return InputError(place, what.starts_with(before) ? what.substr(before.size()) : what);
}

}  // namespace talus
