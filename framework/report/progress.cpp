#include "framework/report/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace talus {

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO)) {}

Progress::~Progress() {
  if (terminal_ && shown_ >= 0) fmt::print(stderr, "\r\033[K");
}

void Progress::operator()(double share) {
  if (!terminal_) return;
  const int percent = std::clamp(static_cast<int>(100 * share), 0, 100);
  if (percent <= shown_) return;
  const std::lock_guard<std::mutex> lock(drawing_);
  if (percent <= shown_) return;
  shown_ = percent;
  const std::string full(static_cast<std::size_t>(percent / 4), '#');
  fmt::print(stderr, "\r{} [{:<25}] {:3} %", what_, full, percent);
  std::fflush(stderr);
}

}  // namespace talus
