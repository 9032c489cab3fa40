#include "framework/report/draw_labels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus {
namespace {

using Eigen::Vector2d;

// Length of the part of a segment that lies in a box (Liang and Barsky).
double length_inside(const Obstacle& o, const LabelBox& box) {
  const Vector2d d = o.to - o.from;
  double t0 = 0, t1 = 1;
  for (int i = 0; i < 2; ++i) {
    const double low = box.low[i] - o.width - o.from[i], high = box.high[i] + o.width - o.from[i];
    if (std::abs(d[i]) < 1e-12) {
      if (low > 0 || high < 0) return 0;
      continue;
    }
    t0 = std::max(t0, std::min(low / d[i], high / d[i]));
    t1 = std::min(t1, std::max(low / d[i], high / d[i]));
  }
  return t1 > t0 ? (t1 - t0) * d.norm() : 0;
}

struct Candidate {
  LabelBox box;
  Vector2d offset;  // of its middle from the anchor
  double cost;      // that does not depend on other labels
};

std::vector<Candidate> candidates(const LabelWish& wish, const std::vector<Obstacle>& obstacles,
                                  const LabelBox& page) {
  std::vector<Candidate> list;
  const double line = wish.size.y();
  for (double gap : {0.45, 1.0, 1.8, 2.8, 4.2})
    for (int k = 0; k < 16; ++k) {
      const double angle = k * std::numbers::pi / 8;
      const Vector2d to(std::cos(angle), std::sin(angle));
      // So far out that the box just clears the anchor by the gap.
      const Vector2d half = wish.size / 2;
      const double clear = std::min(half.x() / std::max(1e-9, std::abs(to.x())),
                                    half.y() / std::max(1e-9, std::abs(to.y())));
      const Vector2d offset = (clear + gap * line) * to;
      Candidate c{{wish.anchor + offset - half, wish.anchor + offset + half}, offset, 0};
      const Vector2d outside = (page.low - c.box.low).cwiseMax(c.box.high - page.high);
      if (outside.maxCoeff() > 0) c.cost += 1e3 * (1 + outside.maxCoeff());
      c.cost += 3 * gap - 0.8 * to.dot(wish.towards) + (k % 4 ? 0 : -0.1);
      if (wish.before.x() > -1e8) c.cost += 0.06 * std::min(60.0, (offset - wish.before).norm());
      for (const Obstacle& o : obstacles) c.cost += 3 * length_inside(o, c.box) / line;
      list.push_back(c);
    }
  return list;
}

}  // namespace

double LabelBox::overlap(const LabelBox& b) const {
  const Vector2d size = high.cwiseMin(b.high) - low.cwiseMax(b.low);
  return size.minCoeff() > 0 ? size.prod() : 0;
}

std::vector<Vector2d> place_labels(const std::vector<LabelWish>& wishes,
                                   const std::vector<Obstacle>& obstacles, const LabelBox& page) {
  const std::size_t n = wishes.size();
  std::vector<std::vector<Candidate>> all;
  all.reserve(n);
  for (const LabelWish& wish : wishes) all.push_back(candidates(wish, obstacles, page));
  std::vector<int> chosen(n, -1);
  for (int round = 0; round < 4; ++round)
    for (std::size_t i = 0; i < n; ++i) {
      double best = 1e300;
      int take = 0;
      for (std::size_t c = 0; c < all[i].size(); ++c) {
        double cost = all[i][c].cost;
        LabelBox rim = all[i][c].box;
        rim.low.array() -= 2, rim.high.array() += 2;
        for (std::size_t j = 0; j < n && cost < best; ++j)
          if (j != i && chosen[j] >= 0)
            if (const double area = rim.overlap(all[j][chosen[j]].box); area > 0)
              cost += 20 + 60 * area / wishes[i].size.prod();
        if (cost < best) best = cost, take = static_cast<int>(c);
      }
      chosen[i] = take;
    }
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(all[i][chosen[i]].box.low);
  return result;
}

}  // namespace talus
