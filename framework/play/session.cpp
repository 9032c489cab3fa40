#include "framework/play/session.h"

#include <cmath>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/settings.h"
#include "framework/dsl/dsl.h"
#include "framework/kinematics/pose_values.h"
#include "framework/page/linkage.h"
#include "framework/page/page_state.h"
#include "framework/report/plugin_json.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

Json error_json(const Place& place, std::string text) {
  const std::string before = to_string(place) + ": ";
  if (text.starts_with(before)) text.erase(0, before.size());
  return {{"error",
           {{"text", text}, {"file", place.file}, {"line", place.line}, {"column", place.column}}}};
}

void elements_of(const Element& element, Json& out) {
  for (const Element& child : element.children) {
    out.push_back({{"tag", child.tag},
                   {"name", child.name()},
                   {"file", child.place.file},
                   {"line", child.place.line},
                   {"column", child.place.column}});
    elements_of(child, out);
  }
}

Json parameters_of(const Program& program) {
  Json out = Json::array();
  for (const Parameter& p : program.parameters) {
    const Unit unit = program.units.of(p.dimension);
    out.push_back({{"name", p.name},
                   {"value", p.nominal.value / unit.factor},
                   {"unit", unit.text},
                   {"line", p.place.line},
                   {"column", p.place.column}});
    if (p.nominal.tolerance) out.back()["tolerance"] = *p.nominal.tolerance / unit.factor;
  }
  return out;
}

Json finite(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double v : values) out.push_back(std::isfinite(v) ? Json(v) : Json(nullptr));
  return out;
}

}  // namespace

std::string PlaySession::answer(const std::string& request) {
  Json out;
  try {
    const Json asked = Json::parse(request);
    const std::string what = asked.at("do");
    if (what == "grammar") {
      for (const Plugin* plugin : Registry::built_in().all())
        out["plugins"].push_back(json_of(*plugin));
    } else if (what == "read") {
      out = read(asked);
    } else if (what == "pose") {
      out = pose(asked);
    } else if (what == "record") {
      out = record(asked);
    } else if (what == "residuals") {
      out = residuals();
    } else if (what == "simulate") {
      out = simulated(asked);
    } else if (what == "calibrate") {
      out = calibrated(asked);
    } else if (what == "diagnose") {
      out = diagnosed(asked);
    } else {
      throw InputError("no request '" + what + "'");
    }
  } catch (const InputError& e) {
    out = error_json(e.place(), e.what());
  } catch (const std::exception& e) {
    out = error_json({}, e.what());
  }
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PlaySession::Read& PlaySession::model() {
  if (!read_) throw InputError("there is no model that can be read");
  return *read_;
}

Recordings PlaySession::usable(const Program& program) {
  if (!recordings_) throw InputError("there are no recordings");
  return with_derived(program, *recordings_);
}

std::string PlaySession::written(const Model& model) const {
  return read_->file.ends_with(".lua") ? write_lua(model) : write_xml(model);
}

Json PlaySession::read(const Json& request) {
  const std::string text = request.at("text"), file = request.value("file", "model.xml");
  read_.reset();
  Registry registry = Registry::built_in();
  Model model =
      file.ends_with(".lua") ? read_lua(text, file, registry) : read_xml(text, file, registry);
  Program program = compile(model, registry);
  PageLinkage linkage = page_linkage(program, recordings_ ? &*recordings_ : nullptr);
  Json out{{"scene", std::move(linkage.scene)}};
  out["scene"]["base"] = finite(page_slots(program));
  TapeValues values(*program.tape, linkage.wanted);
  read_.emplace(
      Read{file, std::move(registry), std::move(model), std::move(program), std::move(values)});
  std::vector<double> rest;
  for (const Coordinate& c : coordinates(read_->program)) rest.push_back(c.rest);
  out["values"] = finite(read_->values(slots_at(read_->program, rest)));
  out["parameters"] = parameters_of(read_->program);
  out["elements"] = Json::array();
  elements_of(read_->model.root, out["elements"]);
  return out;
}

Json PlaySession::pose(const Json& request) {
  Read& read = model();
  const Json& given = request.at("coordinates");
  std::vector<double> at;
  for (const Coordinate& c : coordinates(read.program)) {
    const double factor = read.program.units.of(c.dimension).factor;
    const bool there = at.size() < given.size() && given[at.size()].is_number();
    at.push_back(there ? given[at.size()].get<double>() * factor : c.rest);
  }
  return {{"values", finite(read.values(slots_at(read.program, at)))}};
}

Json PlaySession::record(const Json& request) {
  recordings_.reset();
  const std::string text = request.at("text");
  if (text.empty()) return {{"poses", 0}};
  recordings_ = parse_recordings(text, request.value("file", "recordings.csv"));
  return {{"poses", recordings_->rows()}};
}

}  // namespace talus
