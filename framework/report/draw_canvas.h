// A picture as PNG, PDF or raw pixels, painted by cairo.
#pragma once

#include <string>

#include "framework/report/draw_picture.h"

namespace talus {

std::string write_png(const Picture& picture);
std::string write_pdf(const Picture& picture, const std::string& title);
// Rows from the top, four bytes a pixel: blue, green, red, unused.
std::string raw_pixels(const Picture& picture);

}  // namespace talus
