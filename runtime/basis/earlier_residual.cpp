#include "runtime/basis/earlier_residual.h"

namespace bodyopt {
namespace {

constexpr std::uint32_t kHalfOne = 0x3c00;

// Rows of an identity matrix of halves, two a word.
void append_identity(std::uint32_t size, std::vector<std::uint32_t>& words) {
  const std::uint32_t row_words = (size + 1) / 2;
  for (std::uint32_t k = 0; k < size; ++k) {
    words.resize(words.size() + row_words);
    words[words.size() - row_words + k / 2] = kHalfOne << 16 * (k % 2);
  }
}

}  // namespace

void take_earlier_regions(const std::vector<EarlierRegion>& earlier, ResidualTable& residual) {
  for (const EarlierRegion& e : earlier) {
    residual.regions.push_back({.feature_begin = e.feature_begin,
                                .feature_count = e.feature_count,
                                .coordinate_begin = residual.coordinate_count(),
                                .coordinate_count = e.feature_count,
                                .projection_values = static_cast<std::uint32_t>(residual.projections.size()),
                                .centre_begin = e.centre_begin,
                                .centre_count = e.centre_count,
                                .centre_values = e.centre_values,
                                .coefficient_begin = e.coefficient_begin,
                                .coefficient_count = e.coefficient_count,
                                .weight_values = e.weight_values,
                                .inverse_width2 = e.inverse_width2});
    const auto number = static_cast<std::uint32_t>(residual.regions.size() - 1);
    residual.coordinate_region.insert(residual.coordinate_region.end(), e.feature_count, number);
    append_identity(e.feature_count, residual.projections);
  }
}

}  // namespace bodyopt
