#include "framework/report/draw_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/report/draw_labels.h"
#include "framework/report/draw_order.h"

namespace talus {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

Colour mixed(Colour a, Colour b, double share) {  // `share` of b
  Colour result = 0;
  for (int shift : {16, 8, 0}) {
    const double from = a >> shift & 255, to = b >> shift & 255;
    result |= static_cast<Colour>(std::lround(from + share * (to - from))) << shift;
  }
  return result;
}

class PagePainter {
 public:
  PagePainter(const Scene& scene, const Projection& projection, const Page& page)
      : scene_(scene), project_(projection), page_(page), u_(page.unit()) {
    picture_.width = page.width;
    picture_.height = page.height;
  }

  void bodies() {
    for (const Face& f : scene_.faces) face(f);
    for (const Rod& r : scene_.rods) rod(r);
    for (const Barrel& b : scene_.barrels) barrel(b);
    for (int i : painters_order(pieces_))
      for (Mark& s : marks_[i]) picture_.marks.push_back(std::move(s));
  }

  void overlay() {
    for (const Stroke& s : scene_.strokes) stroke(s);
    for (const Ring& r : scene_.rings) {
      const Vector2d p = flat(r.at);
      disc(p, r.radius * u_, r.fill, r.edge, 1.4);
      disc(p, 0.35 * r.radius * u_, r.edge, {}, 0);
      const Vector2d half(r.radius * u_, 0);
      for (int i = 0; i < 3; ++i) obstacles_.push_back({p - half, p + half, r.radius * u_});
    }
  }

  void names(NamePlaces& places, double lower_end) {
    std::vector<LabelWish> wishes;
    for (const Name& n : scene_.names) {
      const Vector2d anchor = flat(n.at);
      LabelWish wish{anchor,
                     {text_width(n.text, n.size * u_) * (n.bold ? 1.12 : 1), 0.95 * n.size * u_}};
      const Vector2d towards = flat(n.towards) - anchor;
      if (towards.norm() > 1) wish.towards = towards.normalized();
      if (auto before = places.find(n.key); before != places.end()) wish.before = before->second;
      wishes.push_back(wish);
    }
    const double rim = 6 * u_;
    const auto corners =
        place_labels(wishes, obstacles_, {{rim, rim}, {page_.width - rim, lower_end}});
    for (std::size_t i = 0; i < wishes.size(); ++i) {
      const Name& n = scene_.names[i];
      const LabelWish& w = wishes[i];
      const Vector2d &low = corners[i], high = low + w.size;
      places[n.key] = (low + high) / 2 - w.anchor;
      const Vector2d nearest = w.anchor.cwiseMax(low).cwiseMin(high);
      if ((nearest - w.anchor).norm() > 24 * u_)
        line({w.anchor, nearest + 3 * u_ * (w.anchor - nearest).normalized()}, 0x999999, 0.7);
      Mark text{.kind = Mark::Kind::text, .points = {{low.x(), high.y() - 0.13 * w.size.y()}}};
      text.text = n.text;
      text.size = n.size * u_;
      text.fill = n.colour;
      text.bold = n.bold;
      text.slanted = n.slanted;
      text.halo = true;
      picture_.marks.push_back(std::move(text));
    }
  }

  void caption(const std::vector<CaptionLine>& lines) {
    double y = page_.height - 14 * u_ - caption_line * u_ * (static_cast<double>(lines.size()) - 1);
    for (const CaptionLine& l : lines) {
      double x = 16 * u_;
      if (l.sample) {
        line({{x, y - 4 * u_}, {x + 26 * u_, y - 4 * u_}}, *l.sample, 1.8);
        x += 34 * u_;
      }
      text({x, y}, l.text, (l.title ? title_size : caption_size) * u_, l.title,
           Mark::Anchor::start);
      y += caption_line * u_;
    }
  }

  void scale() {
    const double longest = 190 * u_ / project_.scale,
                 power = std::pow(10, std::floor(std::log10(longest)));
    double bar = power;
    for (double step : {2.0, 5.0})
      if (step * power <= longest) bar = step * power;
    const double right = page_.width - 20 * u_, left = right - bar * project_.scale,
                 y = page_.height - 18 * u_;
    line({{left, y}, {right, y}}, 0x222222, 1.6);
    for (double x : {left, right}) line({{x, y - 4 * u_}, {x, y + 4 * u_}}, 0x222222, 1.6);
    text({(left + right) / 2, y - 8 * u_}, fmt::format("{:g} mm", bar), caption_size * u_, false,
         Mark::Anchor::middle);
  }

  Picture take() { return std::move(picture_); }

 private:
  Vector2d flat(const Vector3d& p) const { return project_(p).head<2>(); }

  void line(std::vector<Vector2d> points, Colour colour, double width,
            const std::vector<double>& dash = {}) {
    Mark s{.kind = Mark::Kind::line, .points = std::move(points)};
    s.stroke = colour;
    s.width = width * u_;
    for (double d : dash) s.dash.push_back(d * u_);
    picture_.marks.push_back(std::move(s));
  }
  void disc(const Vector2d& at, double radius, Colour fill, std::optional<Colour> edge,
            double width) {
    Mark s{.kind = Mark::Kind::disc, .points = {at}};
    s.size = radius;
    s.fill = fill;
    s.stroke = edge;
    s.width = width * u_;
    picture_.marks.push_back(std::move(s));
  }
  void text(const Vector2d& at, const std::string& words, double size, bool bold,
            Mark::Anchor anchor) {
    Mark s{.kind = Mark::Kind::text, .points = {at}};
    s.text = words;
    s.size = size;
    s.bold = bold;
    s.anchor = anchor;
    s.fill = 0x222222;
    picture_.marks.push_back(std::move(s));
  }
  Mark area(std::vector<Vector2d> points, Colour fill, std::optional<Colour> edge, double opacity,
            double width) const {
    Mark s{.points = std::move(points)};
    s.fill = fill;
    s.stroke = edge;
    s.opacity = opacity;
    s.width = width * u_;
    return s;
  }
  void add(std::vector<Vector2d> outline, const Vector3d& plane, std::vector<Mark> marks) {
    pieces_.push_back({std::move(outline), plane});
    marks_.push_back(std::move(marks));
  }

  void face(const Face& f) {
    Points3 p;
    std::vector<Vector2d> outline;
    for (const Vector3d& corner : f.corners) {
      p.push_back(project_(corner));
      outline.push_back(p.back().head<2>());
    }
    // Corners counterclockwise from outside turn the other way where y points downwards.
    const Vector3d outwards = -(p[1] - p[0]).cross(p[3] - p[0]);
    Vector3d normal = outwards.normalized();
    if (!(normal.z() > 1e-3)) return;
    const Vector3d plane(-normal.x() / normal.z(), -normal.y() / normal.z(),
                         normal.dot(p[0]) / normal.z());
    // Light from the upper left, behind the viewer's shoulder.
    const double light = std::max(0.0, normal.dot(Vector3d(-0.40, -0.62, 0.67)));
    const Colour fill = light > 0.6 ? mixed(f.fill, 0xffffff, 0.9 * (light - 0.6))
                                    : mixed(f.fill, 0x405060, 0.55 * (0.6 - light));
    for (std::size_t i = 0; i < outline.size(); ++i)
      obstacles_.push_back({outline[i], outline[(i + 1) % outline.size()], 0.5 * u_});
    add(outline, plane, {area(outline, fill, f.edge, f.opacity, 0.9)});
  }

  void rod(const Rod& r) {
    const Vector3d a = project_(r.from), b = project_(r.to);
    const Vector2d p = a.head<2>(), q = b.head<2>();
    const double radius = r.radius * project_.scale, span = (q - p).norm();
    Mark cap{.kind = Mark::Kind::disc, .points = {p}};
    cap.size = radius;
    cap.fill = r.fill;
    if (span < 0.2 * radius) {  // seen from its end
      cap.stroke = r.edge;
      cap.width = 0.9 * u_;
      const Vector2d x(radius, 0), y(0, radius);
      add({p - x, p - y, p + x, p + y}, {0, 0, std::max(a.z(), b.z())}, {cap});
      return;
    }
    const Vector2d along = (q - p) / span, side(-along.y() * radius, along.x() * radius);
    const double rise = (b.z() - a.z()) / span;
    const Vector3d plane(rise * along.x(), rise * along.y(), a.z() - rise * along.dot(p));
    std::vector<Mark> marks{cap, cap,
                            area({p - side, q - side, q + side, p + side}, r.fill, {}, 1, 0)};
    marks[1].points[0] = q;
    // A light stripe on the side towards the light makes it round.
    const double lit = side.dot(Vector2d(-0.54, -0.84)) > 0 ? 1 : -1;
    if (radius > 2.5 * u_)
      marks.push_back(area({p + 0.1 * lit * side, q + 0.1 * lit * side, q + 0.65 * lit * side,
                            p + 0.65 * lit * side},
                           mixed(r.fill, 0xffffff, 0.45), {}, 1, 0));
    for (int sign : {-1, 1}) {
      Mark edge{.kind = Mark::Kind::line, .points = {p + sign * side, q + sign * side}};
      edge.stroke = r.edge;
      edge.width = 0.9 * u_;
      marks.push_back(std::move(edge));
    }
    obstacles_.push_back({p, q, radius});
    add({p - side, q - side, q + side, p + side}, plane, std::move(marks));
  }

  void barrel(const Barrel& b) {
    const Vector3d along = b.direction, x = along.unitOrthogonal(), y = along.cross(x);
    std::vector<Vector2d> caps[2], both;
    constexpr int corners = 20;
    for (int end : {0, 1})
      for (int k = 0; k < corners; ++k) {
        const double angle = 2 * std::numbers::pi * k / corners;
        caps[end].push_back(flat(b.centre + (end ? b.half : -b.half) * along +
                                 b.radius * (std::cos(angle) * x + std::sin(angle) * y)));
        both.push_back(caps[end].back());
      }
    const Vector3d from = project_(b.centre - b.half * along),
                   to = project_(b.centre + b.half * along);
    const int near = to.z() > from.z() ? 1 : 0;
    const std::vector<Vector2d> hull = convex_hull(both);
    // In front of the rods that end in it.
    add(hull, {0, 0, (from.z() + to.z()) / 2 + 1.3 * b.radius * project_.scale},
        {area(hull, b.fill, b.edge, 1, 1.1),
         area(caps[near], mixed(b.fill, 0xffffff, 0.5), b.edge, 1, 0.9)});
    obstacles_.push_back({from.head<2>(), to.head<2>(), b.radius * project_.scale});
  }

  void stroke(const Stroke& s) {
    const Vector2d p = flat(s.from), q = flat(s.to);
    const double span = (q - p).norm();
    if (span < 0.5 * u_) return;
    const Vector2d along = (q - p) / span, side(-along.y(), along.x());
    const double head = std::min((6.5 + 1.6 * s.width) * u_, 0.6 * span);
    const Vector2d end = s.tip == Tip::none ? q : Vector2d(q - 0.8 * head * along),
                   begin = s.tip == Tip::both ? Vector2d(p + 0.8 * head * along) : p;
    line({begin, end}, s.colour, s.width, s.dash);
    auto arrow = [&](const Vector2d& tip, const Vector2d& to) {
      const Vector2d back = tip - head * to, aside = 0.36 * head * side;
      picture_.marks.push_back(area({tip, back + aside, back - aside}, s.colour, {}, 1, 0));
    };
    if (s.tip != Tip::none) arrow(q, along);
    if (s.tip == Tip::both) arrow(p, -along);
    obstacles_.push_back({p, q, s.width * u_});
  }

  const Scene& scene_;
  const Projection& project_;
  const Page& page_;
  double u_;
  Picture picture_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<Mark>> marks_;
  std::vector<Obstacle> obstacles_;
};

}  // namespace

Picture paint(const Scene& scene, const Projection& projection, const Page& page,
              const std::vector<CaptionLine>& caption, bool with_scale, NamePlaces& places) {
  PagePainter painter(scene, projection, page);
  painter.bodies();
  painter.overlay();
  painter.names(places, page.height - (16 + caption_line * static_cast<double>(caption.size())) *
                                          page.unit());
  painter.caption(caption);
  if (with_scale) painter.scale();
  return painter.take();
}

}  // namespace talus
