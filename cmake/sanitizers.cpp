// Linked into every program of a sanitizer build: what libraries allocate and never free is left out of the leak check.
#include <dlfcn.h>

// Static objects of shared libraries: made after the pre-initialisers and before the program's constructors.
extern "C" void __lsan_disable();
extern "C" void __lsan_enable();
__attribute__((section(".preinit_array"), used)) static void (*const before_libraries)() = __lsan_disable;
__attribute__((constructor)) static void after_libraries() { __lsan_enable(); }

// Those of libraries that are loaded later, such as Netgen's.
extern "C" void* dlopen(const char* file, int mode) {
  static const auto load = reinterpret_cast<void* (*)(const char*, int)>(dlsym(RTLD_NEXT, "dlopen"));
  __lsan_disable();
  void* const library = load(file, mode);
  __lsan_enable();
  return library;
}

// Vulkan's software driver and validation layer: libraries stay loaded, so that the leak checker can name who
// allocated.
extern "C" int dlclose(void*) { return 0; }

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libvulkan_lvp.so\n"
         "leak:libng\n"  // Netgen's libraries and
         "leak:libTK\n"  // Open CASCADE's: static objects
         "leak:libLLVM\n"
         "leak:libVkLayer_khronos_validation.so\n";
}
