// Compiled into every program of a sanitizer build, and into nothing else: what the sanitizers must know about code that is not ours.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

// The Vulkan loader unloads the drivers before the leak check, which then cannot tell whose a leaked block was. Left loaded, a driver's
// leaks carry its name, so that they can be told from ours.
extern "C" __attribute__((visibility("default"))) int dlclose(void* /*handle*/) {
  return 0;
}

#endif

#if defined(__SANITIZE_ADDRESS__)

extern "C" const char* __asan_default_options() {
  return "detect_leaks=1:strict_string_checks=1:check_initialization_order=1";
}

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libvulkan_\n"
         "leak:libLLVM\n"
         "leak:libvk_swiftshader\n"
         "leak:libVkLayer_\n"
         "leak:libfontconfig\n"
         // HDF5 1.10 drops what it has read of a file that then proves broken.
         "leak:libhdf5_serial\n";
}

extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}

extern "C" const char* __ubsan_default_options() {
  return "print_stacktrace=1";
}

#endif

#if defined(__SANITIZE_THREAD__)

// The drivers and HDF5 are not instrumented: their own locks and atomics are invisible, so that what they do among themselves looks like
// races. libgcc's lock of unwind tables is taken where the sanitizer sees it and released where it does not, when a driver loads its code.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libvulkan_lvp.so\n"
         "called_from_lib:libvk_swiftshader.so\n"
         "called_from_lib:libLLVM-15.so.1\n"
         "called_from_lib:libVkLayer_khronos_validation.so\n"
         "mutex:libgcc_s.so.1\n";
}

#endif
