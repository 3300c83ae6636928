// What the sanitizers shall not report in a program that renders, or reads STEP. OSMesa keeps some
// 160 bytes of every context that is destroyed, OpenCASCADE (libTK...) some of each shape; OSMesa's
// atomic counters, and those of the LLVM that it draws with, are not instrumented, so the thread
// sanitizer takes what they guard for a race.
#if defined(__SANITIZE_ADDRESS__)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\n"
         "leak:libTK";
}
#elif defined(__SANITIZE_THREAD__)
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race:libOSMesa.so\n"
         "race:libLLVM";
}
#endif
