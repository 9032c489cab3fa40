// A bar on standard error that tells how far a long computation is; nothing where that is not a
// terminal.
//
//     Progress bar("axes");
//     bar(0.25);              // of any thread; draws when a per cent is full
//
// Cleared when the object goes.
#pragma once

#include <atomic>
#include <mutex>
#include <string>

namespace talus {

class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  void operator()(double share);

 private:
  std::string what_;
  bool terminal_;
  std::mutex drawing_;
  std::atomic<int> shown_{-1};
};

}  // namespace talus
