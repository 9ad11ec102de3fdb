#include "tests/support/odd_addresses.h"

#include <cstdint>
#include <cstdlib>
#include <new>

namespace bodyopt::testing {
namespace {

constexpr std::size_t kOff = 4;
thread_local bool gives_odd_addresses = false;

void* allocated(std::size_t size) {
  if (!gives_odd_addresses) return std::malloc(size);
  auto* at = static_cast<std::byte*>(std::malloc(size + kOff));
  return at == nullptr ? nullptr : at + kOff;
}

}  // namespace

OddNew::OddNew() { gives_odd_addresses = true; }
OddNew::~OddNew() { gives_odd_addresses = false; }

}  // namespace bodyopt::testing

// In place of the standard library's, for the whole program.
void* operator new(std::size_t size) {
  if (void* at = bodyopt::testing::allocated(size)) return at;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return bodyopt::testing::allocated(size); }
void operator delete(void* at) noexcept {
  constexpr std::size_t kAligned = 16;  // as malloc gives them
  std::free(static_cast<std::byte*>(at) - reinterpret_cast<std::uintptr_t>(at) % kAligned);
}
void operator delete(void* at, std::size_t) noexcept { ::operator delete(at); }
void operator delete(void* at, const std::nothrow_t&) noexcept { ::operator delete(at); }
