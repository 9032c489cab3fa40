#include "framework/report/draw_canvas.h"

#include <cairo-pdf.h>
#include <cairo.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace talus {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void colour(cairo_t* c, Colour rgb, double opacity = 1) {
  cairo_set_source_rgba(c, (rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0,
                        opacity);
}

void text(cairo_t* c, const Mark& s) {
  cairo_select_font_face(c, "sans-serif",
                         s.slanted ? CAIRO_FONT_SLANT_OBLIQUE : CAIRO_FONT_SLANT_NORMAL,
                         s.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, s.size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, s.text.c_str(), &extents);
  const double back = s.anchor == Mark::Anchor::start    ? 0
                      : s.anchor == Mark::Anchor::middle ? extents.x_advance / 2
                                                         : extents.x_advance;
  cairo_move_to(c, s.points[0].x() - back, s.points[0].y());
  if (s.halo) {
    cairo_text_path(c, s.text.c_str());
    colour(c, 0xffffff);
    cairo_set_line_width(c, s.size / 4);
    cairo_stroke(c);
    cairo_move_to(c, s.points[0].x() - back, s.points[0].y());
  }
  colour(c, s.fill.value_or(0));
  cairo_show_text(c, s.text.c_str());
}

void paint(cairo_t* c, const Mark& s) {
  cairo_set_dash(c, s.dash.data(), static_cast<int>(s.dash.size()), 0);
  if (s.kind == Mark::Kind::text) return text(c, s);
  cairo_new_path(c);
  if (s.kind == Mark::Kind::disc)
    cairo_arc(c, s.points[0].x(), s.points[0].y(), s.size, 0, 2 * std::numbers::pi);
  else
    for (const Eigen::Vector2d& p : s.points) cairo_line_to(c, p.x(), p.y());
  if (s.kind == Mark::Kind::polygon) cairo_close_path(c);
  if (s.fill) {
    colour(c, *s.fill, s.opacity);
    cairo_fill_preserve(c);
  }
  if (s.stroke) {
    colour(c, *s.stroke);
    cairo_set_line_width(c, s.width);
    cairo_stroke_preserve(c);
  }
  cairo_new_path(c);
}

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("cairo: ") + cairo_status_to_string(status));
}

void paint(cairo_surface_t* surface, const Picture& picture) {
  const Context context(cairo_create(surface), &cairo_destroy);
  cairo_t* c = context.get();
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  colour(c, 0xffffff);
  cairo_paint(c);
  for (const Mark& mark : picture.marks) paint(c, mark);
  check(cairo_status(c));
}

Surface image_of(const Picture& picture) {
  Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(picture.width)),
                                 static_cast<int>(std::lround(picture.height))),
      &cairo_surface_destroy);
  check(cairo_surface_status(surface.get()));
  paint(surface.get(), picture);
  cairo_surface_flush(surface.get());
  return surface;
}

cairo_status_t append(void* to, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string write_png(const Picture& picture) {
  std::string out;
  const Surface surface = image_of(picture);
  check(cairo_surface_write_to_png_stream(surface.get(), append, &out));
  return out;
}

std::string write_pdf(const Picture& picture, const std::string& title) {
  std::string out;
  const double point = 0.75;  // a pixel is 1/96 of an inch
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &out, point * picture.width,
                                                            point * picture.height),
                        &cairo_surface_destroy);
  check(cairo_surface_status(surface.get()));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  // The same picture is the same file.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                 "2000-01-01T00:00:00Z");
  cairo_surface_set_device_scale(surface.get(), point, point);
  paint(surface.get(), picture);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return out;
}

std::string raw_pixels(const Picture& picture) {
  const Surface surface = image_of(picture);
  const int width = cairo_image_surface_get_width(surface.get()),
            height = cairo_image_surface_get_height(surface.get()),
            stride = cairo_image_surface_get_stride(surface.get());
  const char* data = reinterpret_cast<const char*>(cairo_image_surface_get_data(surface.get()));
  std::string out;
  for (int row = 0; row < height; ++row)
    out.append(data + static_cast<std::ptrdiff_t>(row) * stride,
               4 * static_cast<std::size_t>(width));
  return out;
}

}  // namespace talus
