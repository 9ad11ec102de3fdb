#include "runtime/library/guard.h"

#include <new>

namespace bodyopt {
namespace {

// Not a string: keeping an error must not fail for want of memory.
thread_local char last_error[2048] = "";

bodyopt_result result_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::mismatch:
      return BODYOPT_MISMATCH;
    case ErrorKind::file:
      return BODYOPT_FILE;
    case ErrorKind::device:
      return BODYOPT_DEVICE;
    case ErrorKind::usage:
      return BODYOPT_USAGE;
    default:
      return BODYOPT_INTERNAL;  // the runtime has no others
  }
}

}  // namespace

bodyopt_result keep_failure(bodyopt_result result, const char* text) noexcept {
  std::strncpy(last_error, text, sizeof(last_error) - 1);
  return result;
}

bodyopt_result keep_error(const std::exception_ptr& error) noexcept {
  try {
    std::rethrow_exception(error);
  } catch (const Error& e) {
    return keep_failure(result_of(e.kind()), e.what());
  } catch (const std::bad_alloc&) {
    return keep_failure(BODYOPT_MEMORY, "there is not enough memory");
  } catch (const std::exception& e) {
    return keep_failure(BODYOPT_INTERNAL, e.what());
  } catch (...) {
    return keep_failure(BODYOPT_INTERNAL, "an exception of no known kind");
  }
}

void require_struct_size(std::size_t found, std::size_t first, std::size_t present, const char* name) {
  if (first <= found && found <= present) return;
  throw Error(ErrorKind::usage, "the struct_size of '", name, "' is ", found, ", expected ", first, " to ", present,
              ": it was not set to the structure's sizeof, or the program was compiled for "
              "another version than the library ",
              bodyopt_version());
}

}  // namespace bodyopt

using namespace bodyopt;

const char* bodyopt_version() { return BODYOPT_VERSION; }

const char* bodyopt_last_error() { return last_error; }
