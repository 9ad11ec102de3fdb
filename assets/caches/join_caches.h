// Caches of the parts of a shot to one of the whole.
#pragma once

#include <filesystem>
#include <vector>

namespace bodyopt {

// Does the ending tell a format whose parts can be joined?
bool can_join(const std::filesystem::path& cache);

// PC2 or .usda, by the ending of `out`, which the parts have, too. The parts may be given in any order; what is written
// are the bytes that one evaluation of all their frames writes. Throws Error(file); Error(mismatch) where parts are of
// other meshes or have frames in common; Error(usage) for no parts.
void join_caches(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& out);

}  // namespace bodyopt
