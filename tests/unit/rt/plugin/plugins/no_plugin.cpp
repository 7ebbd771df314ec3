// A shared library unrelated to palpate.

extern "C" int answer();
extern "C" int answer() { return 42; }
