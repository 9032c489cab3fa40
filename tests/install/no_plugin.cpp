// A shared library that has nothing to do with Talus.
extern "C" int answer() { return 42; }
