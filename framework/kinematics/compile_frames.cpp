#include <fmt/format.h>

#include <algorithm>

#include "framework/kinematics/compiler.h"

namespace talus {

// Frames are collected from all chains in any order, then hung on the root.
void Compiler::frames() {
  struct Edge {
    std::string parent;
    Frame frame;
    std::string alias;
  };
  std::vector<Edge> edges;
  std::map<std::string, Place> reached;  // frame names that have a parent
  std::vector<std::pair<std::string, Place>> starts;
  auto reach = [&](const std::string& name, const Place& place) {
    auto [it, fresh] = reached.emplace(name, place);
    if (!fresh)
      throw InputError(
          place,
          fmt::format("frame '{}' is reached twice (before at {})", name, to_string(it->second)),
          "a tree of frames; close a loop with <closure in=\"...\" at=\"...\"/>");
  };
  for (const Element& chain : model_.root.children) {
    if (chain.tag != "chain") continue;
    std::string parent = chain.text("from");
    starts.emplace_back(parent, chain.find("from") ? chain.find("from")->place : chain.place);
    const std::string to = chain.text("to");
    const Place to_place = chain.find("to") ? chain.find("to")->place : chain.place;
    for (const Element& joint : chain.children) {
      const Plugin* plugin = registry_.find(joint.tag, Family::joint);
      if (!plugin) throw InputError(joint.place, fmt::format("<{}> is not a joint", joint.tag));
      reach(joint.name(), joint.place);
      edges.push_back({parent, joint_with_effects(joint, *plugin), ""});
      parent = joint.name();
    }
    if (!to.empty() && to != parent) {
      reach(to, to_place);
      if (chain.children.empty())
        edges.push_back({parent, {to, -1, {}, to_place}, ""});
      else
        edges.back().alias = to;
    }
  }
  if (starts.empty())
    throw InputError(model_.root.place, "the model has no <chain>",
                     "at least one <chain from=\"...\" to=\"...\">");
  // The root: of the frames no chain leads to, the one with the largest tree, so that a misspelt
  // one is not taken for it.
  auto root = starts.end();
  std::size_t largest = 0;
  for (auto start = starts.begin(); start != starts.end(); ++start) {
    if (reached.contains(start->first)) continue;
    std::set<std::string> tree{start->first};
    for (std::size_t before = 0; before != tree.size();) {
      before = tree.size();
      for (const Edge& edge : edges)
        if (tree.contains(edge.parent))
          tree.insert({edge.frame.name, edge.alias.empty() ? edge.frame.name : edge.alias});
    }
    if (tree.size() > largest) largest = tree.size(), root = start;
  }
  if (root == starts.end())
    throw InputError(starts[0].second,
                     fmt::format("the chains form a circle through frame '{}'", starts[0].first),
                     "a tree of frames; close a loop with <closure in=\"...\" at=\"...\"/>");
  auto name_frame = [&](const std::string& name, int index) { program_.frame_index[name] = index; };
  program_.frames.push_back({root->first, -1, {}, root->second});
  name_frame(root->first, 0);
  for (bool progress = true; progress;) {
    progress = false;
    for (Edge& edge : edges) {
      if (edge.parent.empty() || !program_.frame_index.contains(edge.parent)) continue;
      edge.frame.parent = program_.frame_index[edge.parent];
      const int index = static_cast<int>(program_.frames.size());
      name_frame(edge.frame.name, index);
      if (!edge.alias.empty()) name_frame(edge.alias, index);
      program_.frames.push_back(std::move(edge.frame));
      edge.parent.clear();
      progress = true;
    }
  }
  for (auto& [name, place] : starts)
    if (!program_.frame_index.contains(name)) {
      std::vector<std::string> names;
      for (auto& [n, i] : program_.frame_index) names.push_back(n);
      if (reached.contains(name))
        throw InputError(place, fmt::format("the chains form a circle through frame '{}'", name),
                         "a tree of frames; close a loop with <closure in=\"...\" at=\"...\"/>");
      throw InputError(
          place, fmt::format("frame '{}' hangs loose: no chain leads to it", name),
          fmt::format("a frame that is connected to the root '{}': {}", root->first, join(names)),
          nearest(name, names));
    }
}

int Program::frame(const std::string& name, const Place& place) const {
  if (auto it = frame_index.find(name); it != frame_index.end()) return it->second;
  std::vector<std::string> names;
  for (auto& [n, i] : frame_index) names.push_back(n);
  throw InputError(place, fmt::format("no frame '{}'", name), "one of: " + join(names),
                   nearest(name, names));
}

Rigid<Expr> Program::between(int in, int at) const {
  auto to_root = [&](int f) {
    std::vector<int> path{f};
    while (frames[path.back()].parent >= 0) path.push_back(frames[path.back()].parent);
    std::reverse(path.begin(), path.end());
    return path;
  };
  const std::vector<int> a = to_root(in), b = to_root(at);
  std::size_t common = 0;
  while (common < a.size() && common < b.size() && a[common] == b[common]) ++common;
  Rigid<Expr> up, down;
  for (std::size_t i = common; i < a.size(); ++i) up = up * frames[a[i]].motion;
  for (std::size_t i = common; i < b.size(); ++i) down = down * frames[b[i]].motion;
  return inverse(up) * down;
}

}  // namespace talus
