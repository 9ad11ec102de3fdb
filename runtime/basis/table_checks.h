// Checks that tables share; every refusal names the array, what was expected and what was found.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {

class TableChecks {
 public:
  // Products and sums of numbers up to this size stay finite in every kernel's single precision.
  static constexpr double kLargest = 1e9;
  static constexpr float kWeightTolerance = 1e-4f;  // of a sum of barycentric weights
  // A share of the skin's extent: what is bound to the skin stands no further from its place there at rest.
  static constexpr double kSamePlace = 1e-4;

  // Throws Error(file) whose text starts with `origin`.
  explicit TableChecks(const std::string& origin) : origin_(origin) {}

 protected:
  using Indices = std::vector<std::uint32_t>;

  static std::string element(const char* name, std::size_t k) {
    return std::string(name) + "[" + std::to_string(k) + "]";
  }

  [[noreturn]] void refuse(const auto&... what) const {
    throw Error(ErrorKind::file, origin_, ": ", what..., " (damaged, or made by a defective program)");
  }

  void expect_size(const char* name, std::size_t found, std::size_t expected) const {
    if (found != expected) refuse(name, " has ", found, " entries, expected ", expected);
  }

  void expect_below(const char* name, std::span<const std::uint32_t> indices, std::size_t limit) const {
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (indices[k] < limit) continue;
      refuse(element(name, k), " is ", indices[k], ", expected an index below ", limit);
    }
  }

  void expect_offsets(const char* name, const Indices& begin, std::size_t rows, std::size_t end) const {
    expect_size(name, begin.size(), rows + 1);
    if (begin[0] != 0) refuse(name, " starts at ", begin[0], ", expected 0");
    for (std::size_t k = 0; k < rows; ++k) {
      if (begin[k] <= begin[k + 1]) continue;
      refuse(element(name, k + 1), " is ", begin[k + 1], ", expected at least ", begin[k]);
    }
    if (begin[rows] != end) refuse(name, " ends at ", begin[rows], ", expected ", end);
  }

  void expect_number(const char* name, std::size_t k, double value) const {
    if (std::abs(value) <= kLargest) return;  // false for NaN
    refuse(element(name, k), " is ", value, ", expected a number of at most 1e9");
  }

  void expect_numbers(const char* name, std::span<const float> values) const {
    for (std::size_t k = 0; k < values.size(); ++k) expect_number(name, k, static_cast<double>(values[k]));
  }

 private:
  const std::string& origin_;
};

}  // namespace bodyopt
