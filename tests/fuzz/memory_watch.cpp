#include "tests/fuzz/memory_watch.h"

#include <sanitizer/allocator_interface.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <iostream>

namespace bodyopt::fuzz {
namespace {

std::atomic<std::int64_t> allocated{0}, most{0};

void on_malloc(const volatile void*, std::size_t size) {
  const std::int64_t now = allocated += static_cast<std::int64_t>(size);
  const std::int64_t limit = most;
  if (limit == 0 || now <= limit) return;
  most = 0;  // what follows allocates, too
  std::cerr << "MEMORY: " << (now >> 20) << " MiB at once, expected " << (limit >> 20) << " MiB at most\n";
  std::abort();
}

void on_free(const volatile void* pointer) {
  allocated -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<void*>(pointer)));
}

}  // namespace

void watch_memory() { __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free); }

void begin_read(std::size_t most_mib) {
  allocated = 0;
  most = static_cast<std::int64_t>(most_mib << 20);
}

void end_read() { most = 0; }

}  // namespace bodyopt::fuzz
