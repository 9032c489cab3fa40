#ifdef __EMSCRIPTEN__
#endif
