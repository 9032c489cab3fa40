// What is wrong in a Lua model or a Lua plugin, and the very words in which it is said. Among them
// are the ways out of the sandbox that do not exist.
#include <doctest/doctest.h>

#include <string>

#include "framework/dsl/dsl.h"

using namespace talus;

namespace {

std::string complaint(const std::string& text) {
  Registry registry = Registry::built_in();
  try {
    read_lua(text, "arm.lua", registry);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

struct Case {
  const char* what;
  const char* text;
  const char* complaint;
};

const Case elements[] = {
    {"a misspelt tag", "return talus {\n  chain { from = 'B', to = 'E', hd { name = 'j1' } } }",
     R"(arm.lua:2: nothing is called 'hd' here
  expected a variable set before, or the tag of a registered plugin
  did you mean 'dh'?)"},
    {"a misspelt attribute",
     "return talus { chain { from = 'B', to = 'E',\n  dh { name = 'j1', alhpa = 90 } } }",
     R"(arm.lua:2:29: <dh> has no attribute 'alhpa'
  expected one of: name, theta, d, a, alpha, mass, com, link
  did you mean 'alpha'?)"},
    {"a coordinate left out",
     "local d = 300\nreturn talus { chain { from = 'B', to = 'E', dh { name = 'j1', d = d } } }",
     R"(arm.lua:2:46: <dh name="j1"> lacks the attribute 'theta'
  expected theta: rotation about z of A; an angle (deg, rad, mrad, arcmin, arcsec))"},
    {"the second of two on a line",
     "return talus {\n  encoder { name = 'q' }, encoder { name = 'r', slop = 2 } }",
     R"(arm.lua:2:56: <encoder> has no attribute 'slop'
  expected one of: name, slope, intercept, column, sigma, range
  did you mean 'slope'?)"},
    {"a boolean", "return talus {\n  encoder { name = 'q', slope = true } }",
     R"(arm.lua:2:33: 'slope' of <encoder> is a boolean
  expected text or a number)"},
    {"a function", "return talus {\n  encoder { name = 'q', slope = math.sin } }",
     R"(arm.lua:2:33: 'slope' of <encoder> is a function
  expected text or a number)"},
    {"an infinite number", "return talus {\n  encoder { name = 'q', slope = 1/0 } }",
     R"(arm.lua:2:33: 'slope' of <encoder> is inf
  expected a finite number)"},
    {"an element as an attribute", "return talus {\n  sensor1 = encoder { name = 'q' } }",
     R"(arm.lua:2:13: 'sensor1' of <talus> is the element <encoder>
  expected the element alone, without a key)"},
    {"a table without a tag", "return talus {\n  { name = 'q' } }",
     R"(arm.lua:1: a table with 'name = ...' has no tag
  expected tag { ... }, or a plain list of elements)"},
    {"text between elements", "return talus { 'encoder' }",
     R"(arm.lua:1: a string stands where elements belong
  expected attributes (key = value) and elements (tag { ... }))"},
    {"a tag without its table", "return talus { encoder 'q' }",
     R"(arm.lua:1: encoder is called without a table
  expected encoder { name = "...", ... })"},
    {"an element inside itself",
     "local c = chain { from = 'B', to = 'E' }\nc[1] = c\nreturn talus { c }",
     R"(arm.lua:1: elements are nested too deeply
  expected no element inside itself)"},
    {"no model", "local m = talus {}", R"(arm.lua: the file returns nothing
  expected return talus { ... } as its last statement)"},
    {"another root", "return chain { from = 'B', to = 'E' }",
     R"(arm.lua:1:8: the root element is <chain>
  expected <talus>)"},
    {"a word of the language", "return talus {\n  frame { name = 'E', in = 'B' } }",
     R"(arm.lua:2: unexpected symbol near 'in'
  expected in_ = "..." for the attribute 'in', which is a word of the Lua language)"},
    {"a slip of syntax", "return talus {\n  encoder { name = 'q'\n",
     "arm.lua:3: '}' expected (to close '{' at line 2) near <eof>"},
    {"a slip at run time",
     "local lengths = {}\nreturn talus { constant { name = 'L', value = lengths.upper * 2 } }",
     "arm.lua:2: attempt to perform arithmetic on a nil value (field 'upper')"},
    {"a complaint of the model's own", "error('too few joints')", "arm.lua:1: too few joints"},
};

const Case sandbox[] = {
    {"the system", "os.execute('ls')", R"(arm.lua:1: 'os' is not available in a model file
  expected only what describes a model)"},
    {"files", "\nlocal f = io.open('/etc/passwd')",
     R"(arm.lua:2: 'io' is not available in a model file
  expected only what describes a model)"},
    {"modules", "require 'socket'", R"(arm.lua:1: 'require' is not available in a model file
  expected only what describes a model)"},
    {"code", "load('return 1')()", R"(arm.lua:1: 'load' is not available in a model file
  expected only what describes a model)"},
    {"the state", "debug.getregistry()", R"(arm.lua:1: 'debug' is not available in a model file
  expected only what describes a model)"},
    {"metatables", "setmetatable({}, {__gc = 1})",
     R"(arm.lua:1: 'setmetatable' is not available in a model file
  expected only what describes a model)"},
    {"catching the limits", "while true do pcall(talus) end",
     R"(arm.lua:1: 'pcall' is not available in a model file
  expected only what describes a model)"},
    {"patterns", "('x'):rep(10):find('.-b')",
     "arm.lua:1: 'string.find' is not available in a model file"},
    {"bytecode", "string.dump(error)", "arm.lua:1: 'string.dump' is not available in a model file"},
    {"chance", "math.random()", "arm.lua:1: 'math.random' is not available in a model file"},
    {"unbounded copies", "table.move({}, 1, math.maxinteger - 1, 2)",
     "arm.lua:1: 'table.move' is not available in a model file"},
    {"a loop without end", "local n = 0\nwhile true do n = n + 1 end",
     R"(arm.lua:2: stopped after 50 million steps
  expected a model file that is read in a moment; is there a loop without an end?)"},
    {"a table without end", "local t = {}\nfor i = 1, 1e9 do t[i] = {} end",
     R"(arm.lua:2: stopped: more than 256 MB of memory
  expected a model file that needs little; does a table or a text grow without an end?)"},
    {"a text without end", "local s = 'x'\nlocal t = s:rep(1 << 30)",
     R"(arm.lua:2: stopped: more than 256 MB of memory
  expected a model file that needs little; does a table or a text grow without an end?)"},
    {"recursion without end", "local function f() return 1 + f() end\nf()",
     "arm.lua:1: stack overflow"},
    {"bytecode as a file", "\x1bLuaT", "arm.lua: attempt to load a binary chunk (mode is 't')"},
};

void check(const Case& c) {
  INFO("case: " << std::string(c.what));
  const std::string heard = complaint(c.text), wanted = c.complaint;
  if (wanted == "arm.lua:1: stack overflow")
    CHECK(heard.substr(0, wanted.size()) == wanted);
  else
    CHECK(heard == wanted);
}

}  // namespace

TEST_CASE("complaints about Lua models") {
  for (const Case& c : elements) check(c);
}

TEST_CASE("what a Lua model cannot do") {
  for (const Case& c : sandbox) check(c);
}
