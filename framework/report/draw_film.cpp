#include "framework/report/draw_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "framework/dsl/text.h"

namespace talus {
namespace {

constexpr const char* style = R"(
body { margin: 0; background: #fff; color: #222; font: 15px Helvetica, Arial, sans-serif; }
figure { margin: 0 auto; padding: 8px; max-width: 1400px; }
svg { display: block; width: 100%; height: auto; max-height: calc(100vh - 70px); }
#controls { display: flex; gap: 12px; align-items: center; padding: 8px 16px; }
#controls button { font: inherit; width: 5em; padding: 4px 0; }
#slider { flex: 1; }
#which { min-width: 8em; text-align: right; font-variant-numeric: tabular-nums; }
@media print { #controls { display: none; } }
)";

constexpr const char* script = R"JS(
"use strict";
const film = JSON.parse(document.getElementById("film").textContent);
const picture = document.getElementById("picture"), slider = document.getElementById("slider");
const play = document.getElementById("play"), which = document.getElementById("which");
const speed = document.getElementById("speed"), last = film.frames.length - 1;
let now = 0, playing = false, since = 0, from = 0;
function show(i) {
  now = Math.max(0, Math.min(last, i));
  picture.innerHTML = film.frames[now].map(k => film.elements[k]).join("");
  slider.value = now;
  which.textContent = film.titles[now];
}
function step(time) {
  if (!playing) return;
  if (!since) { since = time; from = now; }
  const i = from + Math.floor((time - since) / 1000 * film.rate * speed.value);
  if (i % (last + 1) !== now) show(i % (last + 1));
  requestAnimationFrame(step);
}
function run(on) {
  playing = on;
  since = 0;
  play.textContent = on ? "Pause" : "Play";
  if (on) requestAnimationFrame(step);
}
play.onclick = () => run(!playing);
slider.oninput = () => { run(false); show(+slider.value); };
speed.onchange = () => { since = 0; };
document.onkeydown = event => {
  const to = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: last }[event.key];
  if (event.target === speed || (event.key !== " " && to === undefined)) return;
  event.preventDefault();
  if (event.key === " ") run(!playing);
  else { run(false); show(to); }
};
play.onkeyup = event => { if (event.key === " ") event.preventDefault(); };
show(0);
if (last > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches) run(true);
)JS";

std::string elements_of(const Picture& picture) {
  std::string out;
  for (const Mark& mark : picture.marks) out += svg_element(mark) + "\n";
  return out;
}

}  // namespace

std::string write_film_html(const Film& film) {
  nlohmann::json elements = nlohmann::json::array(), frames = nlohmann::json::array();
  std::map<std::string, int> numbers;
  for (const Picture& picture : film.pictures) {
    nlohmann::json& frame = frames.emplace_back(nlohmann::json::array());
    for (const Mark& mark : picture.marks) {
      std::string element = svg_element(mark);
      std::replace(element.begin(), element.end(), '"', '\'');  // texts have none, escaped as it is
      const auto [number, fresh] = numbers.try_emplace(element, static_cast<int>(numbers.size()));
      if (fresh) elements.push_back(element);
      frame.push_back(number->second);
    }
  }
  std::string data = nlohmann::json{{"rate", film.rate},
                                    {"titles", film.titles},
                                    {"frames", std::move(frames)},
                                    {"elements", std::move(elements)}}
                         .dump();
  for (std::size_t at = 0; (at = data.find("</", at)) != std::string::npos; at += 3)
    data.insert(at + 1, "\\");  // the end of an element is not that of the script
  const std::string title = xml_escape(film.title);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<figure>\n{2}<g id=\"picture\">\n{3}</g>\n</svg>\n"
      "<div id=\"controls\">\n<button id=\"play\" title=\"space\">Play</button>\n"
      "<input id=\"slider\" type=\"range\" min=\"0\" max=\"{4}\" value=\"0\" "
      "aria-label=\"picture\" title=\"arrow keys\">\n<output id=\"which\"></output>\n"
      "<select id=\"speed\" aria-label=\"speed\"><option value=\"0.25\">1/4 speed</option>"
      "<option value=\"0.5\">1/2 speed</option><option value=\"1\" selected>speed 1</option>"
      "<option value=\"2\">speed 2</option></select>\n</div>\n</figure>\n"
      "<script type=\"application/json\" id=\"film\">{5}</script>\n<script>{6}</script>\n"
      "</body>\n</html>\n",
      title, style, svg_head(film.pictures[0], film.title), elements_of(film.pictures[0]),
      film.pictures.size() - 1, data, script);
}

std::string write_film_svg(const Film& film) {
  const double count = static_cast<double>(film.pictures.size()), seconds = count / film.rate;
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg_head(film.pictures[0], film.title);
  for (std::size_t i = 0; i < film.pictures.size(); ++i) {
    const double begin = static_cast<double>(i) / count, end = static_cast<double>(i + 1) / count;
    out += fmt::format("<g{}>", i == 0 ? "" : " visibility=\"hidden\"");
    if (film.pictures.size() > 1)
      out += fmt::format(
          "<animate attributeName=\"visibility\" calcMode=\"discrete\" dur=\"{:.4g}s\" "
          "repeatCount=\"indefinite\" values=\"{}\" keyTimes=\"{}\"/>",
          seconds, i == 0 ? "visible;hidden" : "hidden;visible;hidden",
          i == 0 ? fmt::format("0;{:.6g}", end) : fmt::format("0;{:.6g};{:.6g}", begin, end));
    out += "\n" + elements_of(film.pictures[i]) + "</g>\n";
  }
  return out + "</svg>\n";
}

}  // namespace talus
