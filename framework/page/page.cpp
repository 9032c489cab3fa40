#include "framework/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "framework/dsl/text.h"
#include "framework/page/linkage.h"
#include "framework/page/pack.h"
#include "framework/page/page_state.h"
#include "framework/page/sha256.h"
#include "framework/page/template.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return in ? text.str() : std::string();
}

// Inside a script nothing may look like its end, nor open a comment that swallows it.
std::string inside_script(std::string text) {
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;)
    text.replace(at, 1, "\\u003c"), at += 6;
  return text;
}

Json sources(const Model& model) {
  std::map<std::string, Json> elements;
  std::function<void(const Element&)> walk = [&](const Element& e) {
    Json entry{{"tag", e.tag}, {"line", e.place.line}};
    for (const char* key : {"name", "at", "of", "in"})
      if (const Attribute* a = e.find(key)) entry[key] = a->text;
    if (e.place.line > 0) elements[e.place.file].push_back(std::move(entry));
    for (const Element& child : e.children) walk(child);
  };
  walk(model.root);
  Json out = Json::array();
  for (const std::string& file : model.sources) {
    const std::string text = bytes_of(file);
    if (text.empty() || text.size() > 200000 || !is_utf8(text)) continue;
    out.push_back({{"file", file}, {"text", text}});
    const auto found = elements.find(file);
    out.back()["elements"] = found == elements.end() ? Json::array() : found->second;
  }
  return out;
}

// What --set has changed, and where the file has it: the text shown is the file's.
Json changes(const PageContent& content) {
  std::map<std::string, Place> places;
  std::function<void(const Element&, bool)> walk = [&](const Element& e, bool root) {
    for (const Attribute& a : e.attributes) {
      if (!e.name().empty()) places.try_emplace(e.name() + "." + a.name, a.place);
      if (e.tag == "calibrate") places["calibrate." + a.name] = places[a.name] = a.place;
      if (root) places[a.name] = a.place;
      if (a.name == "value") places.try_emplace(e.name(), a.place);
    }
    for (const Element& child : e.children) walk(child, false);
  };
  if (content.model) walk(content.model->root, true);
  Json out = Json::array();
  for (const std::string& set : content.sets) {
    const std::string name = set.substr(0, set.find('='));
    const Place& place = places[name];
    out.push_back({{"name", name},
                   {"text", set.substr(std::min(set.size(), name.size() + 1))},
                   {"file", place.file},
                   {"line", place.line}});
  }
  return out;
}

Json columns(const Recordings& recordings) {
  Json out = Json::array();
  for (const RecordedColumn& c : recordings.columns) {
    if (c.name.find(':') != std::string::npos) continue;  // loads and the like, worked out
    Json values = Json::array();
    for (const double v : c.values)
      values.push_back(rounded((v - c.unit.offset) / c.unit.factor, 12));
    out.push_back({{"name", c.name}, {"unit", c.unit.text}, {"values", std::move(values)}});
  }
  return out;
}

Json files(const PageContent& content) {
  std::vector<std::string> names =
      content.model ? content.model->sources : std::vector<std::string>();
  names.insert(names.end(), content.files.begin(), content.files.end());
  Json out = Json::array();
  for (const std::string& name : names)
    if (const std::string text = bytes_of(name); !text.empty())
      out.push_back({{"file", name}, {"sha256", sha256(text)}});
  return out;
}

Json points(const Curve& curve) {
  Json out = Json::array();
  for (const CurvePoint& p : curve.fine)
    out.push_back({{"x", rounded(p.x, 7)},
                   {"before", rounded(p.before, 5)},
                   {"after", rounded(p.after, 5)},
                   {"fitted", rounded(p.fitted, 5)},
                   {"std", rounded(p.std, 3)},
                   {"fitted_std", rounded(p.fitted_std, 3)},
                   {"count", p.count}});
  return out;
}

std::string replaced(std::string_view text, const std::map<std::string, std::string>& by) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t found = text.find("<!--talus:", at);
    const std::size_t end = found == text.npos ? text.npos : text.find("-->", found);
    out += text.substr(at, std::min(found, text.size()) - at);
    if (end == text.npos) break;
    const auto value = by.find(std::string(text.substr(found + 10, end - found - 10)));
    if (value != by.end()) out += value->second;
    at = end + 3;
  }
  return out;
}

}  // namespace

bool has_page_template() { return !page_template.empty(); }

std::string write_page(const PageContent& content) {
  if (!has_page_template())
    throw InputError(
        {"--html", 0, 0},
        "this build has no page; scripts/setup, then scripts/build fetch and bundle it");
  Json data{{"talus", TALUS_VERSION},
            {"command", content.command},
            {"command_line", content.command_line},
            {"title", content.title},
            {"headline", content.headline},
            {"sentences", content.sentences},
            {"files", files(content)}};
  data["report"] = content.report_json.empty() ? Json(nullptr) : Json::parse(content.report_json);
  data["sources"] = content.model ? sources(*content.model) : Json::array();
  data["changes"] = changes(content);
  std::vector<const Program*> programs;
  std::string scripts;
  data["use"] = std::string(content.use.begin(), content.use.end());
  data["columns"] = content.recordings ? columns(*content.recordings) : Json::array();
  data["linkages"] = Json::array();
  data["states"] = Json::array();
  for (const PageState& state : content.states) {
    auto known = std::find(programs.begin(), programs.end(), state.program);
    if (known == programs.end()) {
      programs.push_back(state.program);
      PageLinkage linkage = page_linkage(*state.program, content.recordings);
      data["linkages"].push_back(std::move(linkage.scene));
      scripts += (programs.size() > 1 ? ",\n" : "") + linkage.script;
      known = programs.end() - 1;
    }
    Json of = json_of(state);
    of["linkage"] = known - programs.begin();
    if (state.apart) of["columns"] = columns(*state.recordings);
    pack(of, data["states"], of.value("columns", data["columns"]));
    data["states"].push_back(std::move(of));
  }
  data["directions"] = Json::array();
  for (const PageDirection& d : content.directions)
    data["directions"].push_back(
        {{"sentence", d.sentence}, {"state", d.state}, {"changes", d.changes}});
  data["next"] = content.next;
  data["curves"] = Json::array();
  for (const Curve& c : content.curves) data["curves"].push_back(points(c));

  return replaced(page_template, {{"title", xml_escape(content.title)},
                                  {"headline", xml_escape(content.headline)},
                                  {"text", xml_escape(content.report_text)},
                                  {"data", inside_script(data.dump())},
                                  {"functions", "window.talusLinkages=[" + scripts + "];"}});
}

}  // namespace talus
