#include <algorithm>
#include <cmath>

#include "framework/report/draw_page.h"

namespace talus {

using Eigen::Vector2d, Eigen::Vector3d;

double Page::unit() const { return std::min(width / 1000, height / 750); }

Vector3d Projection::operator()(const Vector3d& p) const {
  const Vector3d seen = scale * camera(p);
  return {offset.x() + seen.x(), offset.y() - seen.y(), seen.z()};
}

std::vector<CaptionLine> wrap(const std::vector<CaptionLine>& lines, const Page& page) {
  const double room = page.width - 250 * page.unit();  // beside the scale
  std::vector<CaptionLine> result;
  for (const CaptionLine& line : lines) {
    result.push_back({"", line.title, line.sample});
    std::size_t start = 0;
    while (start < line.text.size()) {
      const std::size_t space = std::min(line.text.find(", ", start), line.text.size());
      const std::string word = line.text.substr(start, space + 2 - start);
      std::string& text = result.back().text;
      if (!text.empty() && !line.title &&
          text_width(text + word, caption_size * page.unit()) > room)
        result.push_back({word, false, {}});
      else
        text += word;
      start = space + 2;
    }
  }
  return result;
}

Projection fit(const std::vector<Vector3d>& extent, const Camera& camera, const Page& page,
               std::size_t lines) {
  const double u = page.unit(), caption = (10 + caption_line * static_cast<double>(lines)) * u;
  Vector2d low = Vector2d::Constant(INFINITY), high = -low;
  for (const Vector3d& p : extent) {
    const Vector2d seen = camera(p).head<2>();
    low = low.cwiseMin(seen), high = high.cwiseMax(seen);
  }
  const Vector2d size = high - low,
                 room(page.width - 2 * margin * u, page.height - 2 * margin * u - caption);
  Projection result{camera};
  result.scale = std::min(room.x() / size.x(), room.y() / size.y());
  if (!std::isfinite(result.scale)) result.scale = u;  // a point
  const Vector2d middle = (low + high) / 2;
  result.offset = {page.width / 2 - result.scale * middle.x(),
                   (page.height - caption) / 2 + result.scale * middle.y()};
  return result;
}

}  // namespace talus
