// Errors that come from outside: files, devices, arguments. Every message names the file or thing, what was expected,
// what was found and the likely cause; the kind decides the program's exit code.
#pragma once

#include <stdexcept>
#include <string>

namespace bodyopt {

enum class ErrorKind : int {
  quality = 2,       // a quality limit failed
  mismatch = 3,      // inputs do not belong together (topology, skeleton)
  file = 4,          // a file cannot be read or written, or its bytes are wrong
  device = 5,        // no such device, or the device failed
  usage = 64,        // wrong arguments
  interrupted = 75,  // interrupted, or a temporary failure: run again
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }
  int exit_code() const { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
};

}  // namespace bodyopt
