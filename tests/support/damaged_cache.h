// A point cache with a number that its writer would not take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace bodyopt {

// Puts a NaN in the place of number `k` (x, y or z of a point) of a sample.
void put_nan(const std::filesystem::path& cache, std::uint32_t sample, std::size_t k);

}  // namespace bodyopt
