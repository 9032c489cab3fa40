// What the WebAssembly module offers to the page's worker: one function, text in, text out.
#ifdef __EMSCRIPTEN__
#include <emscripten.h>

#include "framework/play/session.h"

extern "C" EMSCRIPTEN_KEEPALIVE const char* talus_answer(const char* request) {
  static talus::PlaySession session;
  static std::string answer;
  answer = session.answer(request);
  return answer.c_str();
}
#endif
