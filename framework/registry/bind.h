// Turns a plugin struct (see plugin.h) into a registered Plugin. A plugin file includes this header
// only.
//
// Built into the framework, TALUS_PLUGIN adds the struct to the registry before main. Built as a
// shared library (TALUS_PLUGIN_LIBRARY defined, as talus_add_plugin() of CMake does), it exports
// the interface version and a function that hands over the library's plugins.
#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "framework/registry/registry.h"

namespace talus {
namespace bind {

template <class... A>
inline constexpr int count_choices = (0 + ... + (std::is_same_v<std::decay_t<A>, int> ? 1 : 0));

// Calls f with the fixed arguments, then inputs (Expr) and choices (int) in the order it asks.
template <class R, class... Fixed, class... A>
R call(R (*f)(A...), Plugin::Inputs inputs, Plugin::Choices choices, const Fixed&... fixed) {
  std::size_t next_input = 0, next_choice = 0;
  auto take = [&]<std::size_t I>() -> decltype(auto) {
    using Wanted = std::decay_t<std::tuple_element_t<I, std::tuple<A...>>>;
    if constexpr (I < sizeof...(Fixed))
      return Wanted(std::get<I>(std::tie(fixed...)));
    else if constexpr (std::is_same_v<Wanted, int>)
      return int(choices[next_choice++]);
    else
      return Expr(inputs[next_input++]);
  };
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    std::tuple<std::decay_t<A>...> arguments{take.template operator()<I>()...};  // left to right
    return std::apply(f, std::move(arguments));
  }
  (std::index_sequence_for<A...>{});
}

// What an effect returns, as a list.
inline std::vector<Expr> numbers_of(const Expr& value) { return {value}; }
inline std::vector<Expr> numbers_of(const Twist<Expr>& twist) {
  const auto& [t, r] = twist;
  return {t[0], t[1], t[2], r[0], r[1], r[2]};
}
inline std::vector<Expr> numbers_of(const Matrix3<Expr>& D) {
  return {D[0][0], D[0][1], D[0][2], D[1][0], D[1][1], D[1][2], D[2][0], D[2][1], D[2][2]};
}

void check_arity(const Declaration& declaration, const char* function, int inputs, int choices,
                 int wanted_inputs);

template <class R, class... A>
void check(const Declaration& d, const char* function, int fixed, int wanted, R (*)(A...)) {
  check_arity(d, function, int(sizeof...(A)) - fixed - count_choices<A...>, count_choices<A...>,
              wanted);
}

template <class P>
Plugin make() {
  Plugin plugin;
  plugin.declaration = P::declaration();
  const Declaration& d = plugin.declaration;
  const int inputs = int(d.inputs.size());
  using In = Plugin::Inputs;
  using Ch = Plugin::Choices;
  if constexpr (requires { &P::template transform<Expr>; }) {
    check(d, "transform", 0, inputs, &P::template transform<Expr>);
    plugin.transform = [](In in, Ch ch) { return call(&P::template transform<Expr>, in, ch); };
  }
  if constexpr (requires { &P::template offset<Expr>; }) {
    check(d, "offset", 0, inputs, &P::template offset<Expr>);
    plugin.transform = [](In in, Ch ch) { return call(&P::template offset<Expr>, in, ch); };
  }
  if constexpr (requires { &P::template value<Expr>; }) {
    check(d, "value", 1, inputs, &P::template value<Expr>);
    plugin.value = [](const Expr& r, In in, Ch ch) {
      return call(&P::template value<Expr>, in, ch, r);
    };
  }
  if constexpr (requires { &P::template observe<Expr>; }) {
    check(d, "observe", 0, int(d.columns.size()), &P::template observe<Expr>);
    plugin.observe = [](In in, Ch ch) { return call(&P::template observe<Expr>, in, ch); };
  }
  if constexpr (requires { &P::template rows<Expr>; }) {
    check(d, "rows", 2, inputs, &P::template rows<Expr>);
    plugin.rows = [](const Rigid<Expr>& model, const Observed<Expr>& measured, In in, Ch ch) {
      return call(&P::template rows<Expr>, in, ch, model, measured);
    };
  }
  if constexpr (requires { &P::template deviations<Expr>; })
    plugin.deviations = [](const Vector3<Expr>& p, const Expr& radius) {
      return P::deviations(p[0], p[1], p[2], radius);
    };
  if constexpr (requires { &P::template act<Expr>; }) {
    check(d, "act", 1, inputs, &P::template act<Expr>);
    plugin.act = [](const Around<Expr>& around, In in, Ch ch) {
      return numbers_of(call(&P::template act<Expr>, in, ch, around));
    };
  }
  // An effect of so many inputs that they come as a list.
  if constexpr (requires { &P::template act_on_list<Expr>; })
    plugin.act = [](const Around<Expr>& around, In in, Ch ch) {
      return numbers_of(P::template act_on_list<Expr>(
          around, std::vector<Expr>(in.begin(), in.end()), std::vector<int>(ch.begin(), ch.end())));
    };
  return plugin;
}

// The plugins of this shared library, or null where they go straight to the registry.
using Makers = std::vector<Plugin (*)()>;
bool add_built_in(Plugin (*maker)());

#ifdef TALUS_PLUGIN_LIBRARY
namespace {
Makers& library_makers() {
  static Makers makers;
  return makers;
}
[[maybe_unused]] bool add_to_library(Plugin (*maker)()) {
  library_makers().push_back(maker);
  return true;
}
}  // namespace
#endif

}  // namespace bind
}  // namespace talus

#ifdef TALUS_PLUGIN_LIBRARY
// One source file makes one plugin library; it may hold several TALUS_PLUGINs.
extern "C" {
__attribute__((visibility("default"), weak)) int talus_plugin_interface() {
  return talus::plugin_interface_version;
}
__attribute__((visibility("default"), weak)) void talus_plugin_register(talus::Registry* registry,
                                                                        const char* origin) {
  for (auto maker : talus::bind::library_makers()) {
    talus::Plugin plugin = maker();
    plugin.origin = origin;
    registry->add(std::move(plugin));
  }
}
}
#define TALUS_PLUGIN(Struct)                                                                     \
  namespace {                                                                                    \
  const bool talus_added_##Struct = ::talus::bind::add_to_library(&::talus::bind::make<Struct>); \
  }
#else
#define TALUS_PLUGIN(Struct)                                                                   \
  namespace {                                                                                  \
  const bool talus_added_##Struct = ::talus::bind::add_built_in(&::talus::bind::make<Struct>); \
  }
#endif
