// Two bases are the same bit for bit.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt::testing {

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_bits(const Skeleton& a, const Skeleton& b);

// The name of the first part that differs, or nothing.
std::string difference(const Basis& a, const Basis& b);

}  // namespace bodyopt::testing
