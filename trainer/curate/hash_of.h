// Hashes of what modifiers are given.
#pragma once

#include "base/content_hash.h"
#include "geometry/mesh.h"

namespace bodyopt {

inline std::uint64_t hash_of(double number) { return XXH3_64bits(&number, sizeof(number)); }

inline std::uint64_t hash_of(const Positions& positions) {
  return XXH3_64bits(positions.data(), static_cast<std::size_t>(positions.size()) * sizeof(double));
}

}  // namespace bodyopt
