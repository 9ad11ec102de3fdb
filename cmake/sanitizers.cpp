// Linked into every program of a sanitizer build. Vulkan's software driver and validation layer and Netgen's static
// objects allocate what they never free: libraries stay loaded, so that the leak checker can name who allocated, and leaks of these are left out.
extern "C" int dlclose(void*) { return 0; }

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libvulkan_lvp.so\n"
         "leak:libLLVM\n"
         "leak:libVkLayer_khronos_validation.so\n"
         "leak:libnglib.so\n"
         "leak:libngcore.so\n";
}
