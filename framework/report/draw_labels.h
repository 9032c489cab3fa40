// Where the names in a picture go: near what they name, not on each other and, where there is room,
// not on what is drawn. Each label tries places around its anchor, nearest first; the one that
// costs least is taken, in several rounds. A label that had to go far gets a thin line to its
// anchor.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace talus {

struct LabelBox {
  Eigen::Vector2d low, high;
  double overlap(const LabelBox& b) const;  // area
};

struct LabelWish {
  Eigen::Vector2d anchor;
  Eigen::Vector2d size;                               // of the text
  Eigen::Vector2d towards = Eigen::Vector2d::Zero();  // where it would rather be, unit vector
  Eigen::Vector2d before = Eigen::Vector2d::Constant(-1e9);  // offset in the picture before
};

// Segments that should stay visible; `width` is half of theirs.
struct Obstacle {
  Eigen::Vector2d from, to;
  double width = 1;
};

// The upper left corner of each label. All within `page`.
std::vector<Eigen::Vector2d> place_labels(const std::vector<LabelWish>& wishes,
                                          const std::vector<Obstacle>& obstacles,
                                          const LabelBox& page);

}  // namespace talus
