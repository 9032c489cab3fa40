// Pictures in a row as GIF, MP4 or WebM, made by the program ffmpeg where it is installed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/report/draw_picture.h"

namespace talus {

bool ffmpeg_found();  // somewhere on the PATH

// The ending of `file` decides what is written. False where ffmpeg failed; it has said why on
// standard error, and nothing is written.
bool write_video(const std::string& file, const std::vector<Picture>& pictures, double rate,
                 const std::function<void(double)>& progress = {});

}  // namespace talus
