// A flat picture: marks in the order in which they are painted, y downwards, lengths in pixels.
// It is written as SVG (text stays text) here, as PNG, PDF and raw pixels by draw_canvas.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace talus {

using Colour = std::uint32_t;  // 0xRRGGBB

struct Mark {
  enum class Kind { polygon, line, disc, text };
  enum class Anchor { start, middle, end };
  Kind kind = Kind::polygon;
  std::vector<Eigen::Vector2d> points;  // a disc's centre; a text's anchor on its baseline
  std::optional<Colour> fill, stroke;
  double width = 1;          // of the stroke
  double size = 0;           // radius of a disc, height of a text
  double opacity = 1;        // of the fill
  std::vector<double> dash;  // lengths drawn and left out
  std::string text;
  Anchor anchor = Anchor::start;
  bool bold = false, slanted = false, halo = false;  // of a text; a white rim keeps it legible
};

struct Picture {
  double width = 0, height = 0;
  std::vector<Mark> marks;
};

// About as wide as the text is set in a sans-serif face.
double text_width(const std::string& text, double size);

std::string svg_element(const Mark& mark);  // one element, coordinates rounded to 0.1
std::string svg_head(const Picture& picture, const std::string& title);  // <svg ...>, title, paper
std::string write_svg(const Picture& picture, const std::string& title);

}  // namespace talus
