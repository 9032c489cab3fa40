// What a picture of a linkage shows, in space: limbs as cuboids, bodies without a limb as rods from
// joint to joint, joints as barrels (turning) or blocks (sliding) on their axes, frames as triads,
// what is measured as rings, rays and rulers, and names. A ghost, a second linkage shown for
// comparison, is the same in thin lines of one colour.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "framework/kinematics/skeleton.h"
#include "framework/report/draw_picture.h"

namespace talus {

using Points3 = std::vector<Eigen::Vector3d>;

struct Face {  // corners counterclockwise seen from outside
  Points3 corners;
  Colour fill, edge;
  double opacity = 1;
};
struct Rod {
  Eigen::Vector3d from, to;
  double radius;
  Colour fill, edge;
};
struct Barrel {
  Eigen::Vector3d centre, direction;
  double radius, half;  // half of its length
  Colour fill, edge;
};
enum class Tip { none, arrow, both };
struct Stroke {
  Eigen::Vector3d from, to;
  Colour colour;
  double width;  // in units of the page, as all lines
  std::vector<double> dash = {};
  Tip tip = Tip::none;
};
struct Ring {
  Eigen::Vector3d at;
  double radius;  // in units of the page
  Colour edge;
  Colour fill = 0xffffff;
};
struct Name {
  Eigen::Vector3d at, towards;  // the anchor, and a point to whose side it had better go
  std::string text;
  Colour colour;
  double size;  // in units of the page
  bool bold = false, slanted = false;
  std::string key = {};  // the same from picture to picture
};

struct Scene {
  std::vector<Face> faces;
  std::vector<Rod> rods;
  std::vector<Barrel> barrels;
  std::vector<Stroke> strokes;
  std::vector<Ring> rings;
  std::vector<Name> names;
  std::vector<Eigen::Isometry3d> triads;  // shown so far
};

struct SceneOptions {
  double unit = 1;                           // one unit of the page, mm
  std::vector<int> triads;                   // frames that are shown with their axes and name
  std::optional<Colour> ghost;               // drawn thin in this colour
  std::optional<Eigen::Vector3d> near_root;  // where a far root is shown, in the root frame
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // T_picture_root
};

// The frames that matter most: root, ends of chains, those that are measured or have a limb.
std::vector<int> main_frames(const Program& program, const Skeleton& skeleton);

// Where to show a root that lies much farther from the linkage than the linkage is large: on the
// way to it. `size` is that of the rest.
std::optional<Eigen::Vector3d> nearer_root(const Skeleton& skeleton, double size);

// What the picture must have room for, in the frame of the picture.
void extend(std::vector<Eigen::Vector3d>& extent, const Program& program, const Posture& posture,
            const Skeleton& skeleton, const SceneOptions& options);

void add_linkage(Scene& scene, const Program& program, const Posture& posture,
                 const Skeleton& skeleton, const SceneOptions& options);

}  // namespace talus
