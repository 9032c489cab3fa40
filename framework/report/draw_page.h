// A scene on a page: projected, painted from back to front, with names, a scale and a caption.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/report/draw_camera.h"
#include "framework/report/draw_picture.h"
#include "framework/report/draw_scene.h"

namespace talus {

// Lengths of lines and letters are in units: a thousandth of the width of a page of 4:3.
struct Page {
  double width = 1000, height = 750;  // pixels
  double unit() const;                // pixels
};

// In units: the rim around what is drawn, the sizes of letters, and from line to line.
constexpr double margin = 70, title_size = 15, caption_size = 12, caption_line = 17;

struct Projection {
  Camera camera;
  double scale = 1;                                            // pixels per mm
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();            // where the origin is, pixels
  Eigen::Vector3d operator()(const Eigen::Vector3d& p) const;  // x, y downwards, height; pixels
};

struct CaptionLine {
  std::string text;
  bool title = false;
  std::optional<Colour> sample;  // a piece of line before the text
};

// What stands below the picture, wrapped to the page.
std::vector<CaptionLine> wrap(const std::vector<CaptionLine>& lines, const Page& page);

// The scale at which `extent` fills what `lines` lines of caption leave of the page.
Projection fit(const std::vector<Eigen::Vector3d>& extent, const Camera& camera, const Page& page,
               std::size_t lines);

// Names keep near their places in the picture before, which `places` carries from one to the next.
using NamePlaces = std::map<std::string, Eigen::Vector2d>;
Picture paint(const Scene& scene, const Projection& projection, const Page& page,
              const std::vector<CaptionLine>& caption, bool with_scale, NamePlaces& places);

}  // namespace talus
