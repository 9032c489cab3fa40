#include "framework/report/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace talus {
namespace {

constexpr double kFirst = 0.5, kAgain = 0.2;  // s until the line is drawn, and drawn anew
constexpr double kEnough = 0.03;              // share that must be done to tell the time left

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

bool is_terminal(int file) {
  const char* kind = std::getenv("TERM");
  return isatty(file) && !(kind && std::string(kind) == "dumb");
}

std::size_t terminal_columns(int file) {
  winsize size{};
  return ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string time_left(double seconds) {
  if (seconds < 90) return fmt::format("about {:.0f} s left", std::max(1.0, std::ceil(seconds)));
  if (seconds < 90 * 60) return fmt::format("about {:.0f} min left", seconds / 60);
  return fmt::format("about {:.0f} h left", seconds / 3600);
}

std::string progress_line(const std::string& step, double share, double gone, double left,
                          std::size_t columns) {
  std::string after = fmt::format(" {:.0f} s", gone);
  if (share > 0) {
    after = fmt::format(" {:3.0f} %", 100 * share);
    if (left >= 0 && share < 1) after += ", " + time_left(left);
    const int room = static_cast<int>(columns) - 42, width = std::clamp(room, 0, 30);
    const int full = static_cast<int>(share * width);
    if (width >= 5)
      after =
          fmt::format(" [{}{}]", std::string(full, '#'), std::string(width - full, ' ')) + after;
  }
  return (fmt::format("{:<14}", step) + after).substr(0, columns - 1);
}

Progress::Progress(bool wanted, std::string step) : step_(std::move(step)) {
  if (!wanted || !is_terminal(STDERR_FILENO)) return;
  painter_ = std::thread([this] {
    std::unique_lock<std::mutex> lock(lock_);
    for (double wait = kFirst; !over_; wait = kAgain) {
      if (ended_.wait_for(lock, std::chrono::duration<double>(wait), [this] { return over_; }))
        return;
      draw();
    }
  });
}

Progress::~Progress() {
  if (!painter_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(lock_);
    over_ = true;
  }
  ended_.notify_all();
  painter_.join();
  if (shown_.empty()) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

void Progress::operator()(const std::string& step, double share) {
  if (!painter_.joinable()) return;
  const std::lock_guard<std::mutex> lock(lock_);
  step_ = step;
  told_ = Clock::now();
  share_ = std::clamp(share, share_, 1.0);  // never backwards, whichever thread is late
  left_ = share_ > kEnough ? seconds(told_ - start_) * (1 - share_) / share_ : -1;
}

void Progress::draw() {
  const auto now = Clock::now();
  const double left = left_ < 0 ? -1 : std::max(0.0, left_ - seconds(now - told_));
  const std::string line =
      progress_line(step_, share_, seconds(now - start_), left, terminal_columns(STDERR_FILENO));
  if (line == shown_) return;
  fmt::print(stderr, "\r{}\x1b[K", line);
  std::fflush(stderr);
  shown_ = line;
}

}  // namespace talus
