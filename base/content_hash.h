// A hash of numbers and strings, to know inputs again.
#pragma once

#include <xxhash.h>

#include <cstdint>
#include <string>

#include "runtime/core/transform.h"

namespace bodyopt {

// Only numbers and strings go in, never structs: padding has no meaning.
class ContentHash {
 public:
  void add(double value) { append(&value, sizeof(value)); }
  void add(std::uint64_t value) { append(&value, sizeof(value)); }
  void add(const std::string& text) {
    add(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  void add(const JointTransform& transform) {
    for (const double x : transform.translation) add(x);
    for (const double x : transform.rotation) add(x);
    for (const double x : transform.scale) add(x);
  }
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits(bytes_.data(), bytes_.size()); }

 private:
  std::string bytes_;
};

}  // namespace bodyopt
