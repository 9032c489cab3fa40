#include "framework/report/draw_order.h"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

using Eigen::Vector2d;
using Polygon = std::vector<Vector2d>;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double area(const Polygon& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.size(); ++i) twice += cross(p[i], p[(i + 1) % p.size()]);
  return twice / 2;
}

struct Box {
  Vector2d low, high;
  explicit Box(const Polygon& p) : low(p[0]), high(p[0]) {
    for (const Vector2d& q : p) low = low.cwiseMin(q), high = high.cwiseMax(q);
  }
  bool apart(const Box& b) const {
    return (high.array() < b.low.array()).any() || (b.high.array() < low.array()).any();
  }
};

}  // namespace

Overlap overlap(const Polygon& a, const Polygon& b) {
  Polygon inside = a, next;  // Sutherland and Hodgman: cut by each edge of b in turn
  for (std::size_t i = 0; i < b.size() && !inside.empty(); ++i) {
    const Vector2d &from = b[i], along = b[(i + 1) % b.size()] - from;
    next.clear();
    for (std::size_t k = 0; k < inside.size(); ++k) {
      const Vector2d &p = inside[k], &q = inside[(k + 1) % inside.size()];
      const double sp = cross(along, p - from), sq = cross(along, q - from);
      if (sp >= 0) next.push_back(p);
      if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) next.push_back(p + sp / (sp - sq) * (q - p));
    }
    inside.swap(next);
  }
  Overlap result{Vector2d::Zero()};
  if (inside.size() < 3) return result;
  for (const Vector2d& p : inside) result.middle += p / static_cast<double>(inside.size());
  result.area = area(inside);
  return result;
}

Polygon convex_hull(Polygon points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  Polygon hull;
  auto add = [&](const Vector2d& p, std::size_t least) {
    while (hull.size() > least && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Vector2d& p : points) add(p, 1);
  const std::size_t lower = hull.size();
  for (auto p = points.rbegin() + 1; p < points.rend(); ++p) add(*p, lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

std::vector<int> painters_order(std::vector<Piece> pieces) {
  const int n = static_cast<int>(pieces.size());
  std::vector<Box> boxes;
  std::vector<double> height;
  for (Piece& p : pieces) {
    if (area(p.outline) < 0) std::reverse(p.outline.begin(), p.outline.end());
    boxes.emplace_back(p.outline);
    height.push_back(0);
    for (const Vector2d& q : p.outline)
      height.back() += p.height(q) / static_cast<double>(p.outline.size());
  }
  std::vector<std::vector<int>> before(n);  // [piece]: those painted after it
  std::vector<int> waiting_for(n, 0);
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      if (boxes[i].apart(boxes[j])) continue;
      const Overlap both = overlap(pieces[i].outline, pieces[j].outline);
      if (both.area < 1e-9) continue;
      const bool i_first = pieces[i].height(both.middle) < pieces[j].height(both.middle);
      before[i_first ? i : j].push_back(i_first ? j : i);
      ++waiting_for[i_first ? j : i];
    }
  std::vector<int> order;
  std::vector<bool> done(n, false);
  while (static_cast<int>(order.size()) < n) {
    int next = -1;
    for (int i = 0; i < n; ++i) {
      if (done[i]) continue;
      if (next < 0 || (waiting_for[i] == 0) > (waiting_for[next] == 0) ||
          ((waiting_for[i] == 0) == (waiting_for[next] == 0) && height[i] < height[next]))
        next = i;
    }
    done[next] = true;
    order.push_back(next);
    for (int later : before[next]) --waiting_for[later];
  }
  return order;
}

}  // namespace talus
