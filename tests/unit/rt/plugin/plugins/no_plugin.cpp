// Some shared library that has nothing to do with palpate.

extern "C" int answer();
extern "C" int answer() { return 42; }
