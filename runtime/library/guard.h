// The border between C and C++: exceptions become results, pointers and structures are checked.
#pragma once

#include <cstddef>
#include <cstring>
#include <exception>

#include "include/bodyopt/bodyopt.h"
#include "runtime/core/error.h"

namespace bodyopt {

// Keeps what the exception says for bodyopt_last_error(), and gives its result. Throws nothing.
bodyopt_result keep_error(const std::exception_ptr& error) noexcept;

// Keeps this for bodyopt_last_error(), and gives the result.
bodyopt_result keep_failure(bodyopt_result result, const char* text) noexcept;

// Tells the host's log, where there is one.
void write_log(bodyopt_log_level level, const char* message) noexcept;

// Calls function(); a failure becomes the result, and goes to the log.
template <typename Function>
bodyopt_result guarded(const Function& function) noexcept {
  try {
    function();
    return BODYOPT_OK;
  } catch (...) {
    const bodyopt_result result = keep_error(std::current_exception());
    write_log(BODYOPT_LOG_ERROR, bodyopt_last_error());
    return result;
  }
}

// Throws Error(usage) for a null pointer. `name`: of the argument.
template <typename T>
void require(T* pointer, const char* name) {
  if (pointer == nullptr) throw Error(ErrorKind::usage, "the argument '", name, "' is a null pointer");
}

// The object that an aligned pointer points to. Throws as above.
template <typename T>
T& required(T* pointer, const char* name) {
  require(pointer, name);
  return *pointer;
}

// Throws Error(usage) unless `found` is the size of a structure of a version up to this one.
void require_struct_size(std::size_t found, std::size_t first, std::size_t present, const char* name);

// A structure as a caller of this or of an earlier version gives it; what the earlier one lacks is 0. `first_size`: of
// the first version. Throws Error(usage).
template <typename Structure>
Structure read_struct(const Structure* given, std::size_t first_size, const char* name) {
  const std::size_t size = required(given, name).struct_size;
  require_struct_size(size, first_size, sizeof(Structure), name);
  Structure result{};
  std::memcpy(&result, given, size);
  return result;
}

// An array of structures whose elements may be those of an earlier version. Throws as read_struct().
template <typename Structure>
class StructArray {
 public:
  StructArray(Structure* first, std::size_t count, std::size_t first_size, const char* name) : first_(first) {
    if (count > 0) size_ = read_struct(first, first_size, name).struct_size;
  }

  std::size_t element_size() const { return size_; }
  Structure& operator[](std::size_t k) const {
    return *reinterpret_cast<Structure*>(reinterpret_cast<std::byte*>(first_) + k * size_);
  }

 private:
  Structure* first_;
  std::size_t size_ = 0;  // bytes from one to the next
};

}  // namespace bodyopt
