// Errors that come from outside: files, devices, arguments. Every message names the file or thing, what was expected,
// what was found and the likely cause; the kind decides the program's exit code.
#pragma once

#include <concepts>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace bodyopt {

enum class ErrorKind : int {
  quality = 2,       // a quality limit failed
  mismatch = 3,      // inputs do not belong together (topology, skeleton)
  file = 4,          // a file cannot be read or written, or its bytes are wrong
  device = 5,        // no such device, or the device failed
  usage = 64,        // wrong arguments
  interrupted = 75,  // interrupted, or a temporary failure: run again
};

// The defect of a skin or a dataset, where advice depends on it.
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
  large_piece,  // that can neither be filled nor follow others
  several_pieces,
  unweighted,  // it follows no joint
  too_few_vertices,
  too_few_frames,
};

// A text, a character, a file's name, or a number, which is written as std::to_string() does.
template <typename Part>
concept MessagePart = std::convertible_to<const Part&, std::string_view> || std::same_as<Part, std::filesystem::path> ||
    (std::is_arithmetic_v<Part> && !std::same_as<Part, bool>);

// Joins all parts of a message to one text.
template <MessagePart... Parts>
std::string concat(const Parts&... parts) {
  std::string text;
  const auto append = [&]<typename Part>(const Part& part) {
    if constexpr (std::same_as<Part, std::filesystem::path>) {
      text += part.string();
    } else if constexpr (std::is_arithmetic_v<Part> && !std::same_as<Part, char>) {
      text += std::to_string(part);
    } else {
      text += part;
    }
  };
  (append(parts), ...);
  return text;
}

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message, ErrorCause cause = ErrorCause::other)
      : std::runtime_error(message), kind_(kind), cause_(cause) {}
  // The message from its parts.
  template <MessagePart... Parts>
  explicit Error(ErrorKind kind, const Parts&... parts) : Error(kind, concat(parts...)) {}
  ErrorKind kind() const { return kind_; }
  ErrorCause cause() const { return cause_; }
  int exit_code() const { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
  ErrorCause cause_;
};

}  // namespace bodyopt
