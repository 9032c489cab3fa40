// Work over numbered chunks on several threads. Who does a chunk is left to chance, what a chunk is
// is not: results are kept per chunk and joined in order, so they are the same for any number of
// threads. Where there are no threads (in a browser) it is done by the caller.
#pragma once

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace talus {

template <class F>  // f(chunk, worker)
void parallel_chunks(int chunks, int threads, F f) {
#ifdef __cpp_lib_jthread
  threads = std::min(threads, chunks);
#else
  threads = 1;
#endif
  if (threads <= 1) {
    for (int c = 0; c < chunks; ++c) f(c, 0);
    return;
  }
#ifdef __cpp_lib_jthread
  std::atomic<int> next{0};
  std::vector<std::exception_ptr> errors(threads);
  auto work = [&](int worker) {
    try {
      for (int c = next++; c < chunks; c = next++) f(c, worker);
    } catch (...) {
      errors[worker] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int t = 1; t < threads; ++t) pool.emplace_back(work, t);
    work(0);
  }
  for (auto& error : errors)
    if (error) std::rethrow_exception(error);
#endif
}

}  // namespace talus
