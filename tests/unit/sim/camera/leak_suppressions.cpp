// Mesa keeps about a hundred bytes of every context it has destroyed; that is not ours to mend, and
// without this the leak check of the sanitizer build would fail on it.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa\n"; }
