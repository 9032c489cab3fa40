// Pictures in a row as one file that plays by itself: a page for any browser, which needs no
// network and no server, or an SVG that moves.
#pragma once

#include <string>
#include <vector>

#include "framework/report/draw_picture.h"

namespace talus {

struct Film {
  std::string title;
  std::vector<Picture> pictures;    // at least one, all of one size
  std::vector<std::string> titles;  // of each: "row 3"
  double rate = 12;                 // pictures a second
};

// With a button, a slider and keys. What several pictures have in common is in the file once.
std::string write_film_html(const Film& film);
std::string write_film_svg(const Film& film);  // SMIL, again and again

}  // namespace talus
