#include "framework/report/draw_picture.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/dsl/text.h"

namespace talus {
namespace {

// At most `digits` behind the point, no zeros at the end: "12.5", "3", "0".
std::string brief(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}
std::string round1(double value) { return brief(value, 1); }

std::string paint(const Mark& s) {
  std::string out = s.fill ? fmt::format(" fill=\"#{:06x}\"", *s.fill) : " fill=\"none\"";
  if (s.fill && s.opacity < 1) out += fmt::format(" fill-opacity=\"{}\"", brief(s.opacity, 2));
  if (!s.stroke) return out;
  out += fmt::format(" stroke=\"#{:06x}\" stroke-width=\"{}\"", *s.stroke, brief(s.width, 2));
  for (std::size_t i = 0; i < s.dash.size(); ++i)
    out += (i ? " " : " stroke-dasharray=\"") + round1(s.dash[i]);
  return s.dash.empty() ? out : out + "\"";
}

std::string point(const Eigen::Vector2d& p) { return round1(p.x()) + "," + round1(p.y()); }

}  // namespace

double text_width(const std::string& text, double size) {
  double width = 0;
  for (unsigned char c : text) {
    if ((c & 0xC0) == 0x80) continue;  // the rest of a character of several bytes
    width += c == 'i' || c == 'j' || c == 'l' || c == '.' || c == ',' || c == ' ' ? 0.33
             : c == 'm' || c == 'w'                                               ? 0.95
             : c >= 'A' && c <= 'Z'                                               ? 0.72
                                                                                  : 0.6;
  }
  return width * size;
}

std::string svg_element(const Mark& s) {
  const Eigen::Vector2d& p = s.points[0];
  if (s.kind == Mark::Kind::disc)
    return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>", round1(p.x()), round1(p.y()),
                       round1(s.size), paint(s));
  if (s.kind == Mark::Kind::text) {
    std::string style;
    if (s.anchor == Mark::Anchor::middle) style += " text-anchor=\"middle\"";
    if (s.anchor == Mark::Anchor::end) style += " text-anchor=\"end\"";
    if (s.bold) style += " font-weight=\"bold\"";
    if (s.slanted) style += " font-style=\"italic\"";
    if (s.halo)
      style += fmt::format(" stroke=\"#fff\" stroke-width=\"{}\" paint-order=\"stroke\"",
                           brief(s.size / 4, 1));
    return fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"#{:06x}\"{}>{}</text>",
                       round1(p.x()), round1(p.y()), round1(s.size), s.fill.value_or(0), style,
                       xml_escape(s.text));
  }
  std::string points;
  for (const Eigen::Vector2d& q : s.points) points += (points.empty() ? "" : " ") + point(q);
  return fmt::format("<{} points=\"{}\"{}/>", s.kind == Mark::Kind::line ? "polyline" : "polygon",
                     points, paint(s));
}

std::string svg_head(const Picture& picture, const std::string& title) {
  const std::string width = round1(picture.width), height = round1(picture.height);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" "
      "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n<title>{2}</title>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      width, height, xml_escape(title));
}

std::string write_svg(const Picture& picture, const std::string& title) {
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg_head(picture, title);
  for (const Mark& mark : picture.marks) out += svg_element(mark) + "\n";
  return out + "</svg>\n";
}

}  // namespace talus
