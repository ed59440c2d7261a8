// Linked into every test of a sanitized build: what LeakSanitizer overlooks because the leak is not
// ours. libhdf5 1.10 loses the buffers of a dataset whose chunk fails its checksum (H5Dread returns
// an error, H5close does not find them again), which the tests of damaged trajectories provoke.
// __lsan_default_suppressions is LeakSanitizer's documented hook.

extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }
