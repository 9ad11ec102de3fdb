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

// What is wrong with a skin, where advice depends on it.
enum class ErrorCause {
  other,
  no_faces,
  damaged,
  open_edges,
  crowded_edges,  // of more than two triangles
  flipped_edges,  // whose triangles wind oppositely
  loose_vertices,
  flat,
  crossing,     // skin passes through skin, and cannot be moved apart
  unfillable,   // with tetrahedra
  large_piece,  // that can neither be filled nor ride on the others
  several_pieces,
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message, ErrorCause cause = ErrorCause::other)
      : std::runtime_error(message), kind_(kind), cause_(cause) {}
  ErrorKind kind() const { return kind_; }
  ErrorCause cause() const { return cause_; }
  int exit_code() const { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
  ErrorCause cause_;
};

}  // namespace bodyopt
