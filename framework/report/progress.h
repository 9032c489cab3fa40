// How far a long computation is: one line on a terminal's standard error, rewritten while the
// object lives and cleared when it goes.
//
//     Progress bar(!quiet, "reading");
//     bar("fitting", 0.25);                  // the step, the share of the whole; of any thread
//
//     fitting        [#######                       ]  25 %, about 2 min left
//
// Nothing is shown in the first half second, nor where standard error is no terminal. A step
// without a share shows the time that has gone.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace talus {

using Telling = std::function<void(const std::string& step, double share)>;

class Progress {
 public:
  explicit Progress(bool wanted, std::string step = "");
  ~Progress();
  Progress(const Progress&) = delete;
  void operator()(const std::string& step, double share);
  Telling teller() {
    return [this](const std::string& step, double share) { (*this)(step, share); };
  }

 private:
  using Clock = std::chrono::steady_clock;
  void draw();  // under the lock

  std::mutex lock_;
  std::condition_variable ended_;
  std::string step_, shown_;      // what stands on the terminal
  double share_ = 0, left_ = -1;  // seconds left when the share was told; unknown below 0
  Clock::time_point start_ = Clock::now(), told_ = start_;
  bool over_ = false;
  std::thread painter_;
};

// "about 40 s left", "about 2 min left"
std::string time_left(double seconds);
// The whole line, at most `columns` wide.
std::string progress_line(const std::string& step, double share, double gone, double left,
                          std::size_t columns);

bool is_terminal(int file);              // and one that understands control sequences
std::size_t terminal_columns(int file);  // 80 where it does not say

}  // namespace talus
