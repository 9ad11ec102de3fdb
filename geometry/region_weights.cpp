#include "geometry/region_weights.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bodyopt {
namespace {

bool is_one(double sum) {
  constexpr double kRounding = 1e-9;
  return std::abs(sum - 1) < kRounding;
}

// Every weight over the sum at its vertex, where that is not 1 and `scaled`(sum) holds.
template <typename Condition>
void scale(std::vector<RegionWeights>& regions, Eigen::Index vertices, Condition scaled) {
  const Eigen::VectorXd sums = sum_of_weights(regions, vertices);
  for (RegionWeights& region : regions) {
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      const double sum = sums[region.vertices[k]];
      if (!is_one(sum) && scaled(sum)) region.weights[k] /= sum;
    }
  }
}

RegionWeights renumbered(const RegionWeights& region, const std::vector<std::uint32_t>& number) {
  std::vector<std::pair<std::uint32_t, double>> entries;
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    entries.emplace_back(number[region.vertices[k]], region.weights[k]);
  }
  std::ranges::sort(entries);
  RegionWeights result{region.name, {}, {}};
  for (const auto& [vertex, weight] : entries) {
    result.vertices.push_back(vertex);
    result.weights.push_back(weight);
  }
  return result;
}

}  // namespace

RegionWeights region_of(const std::string& name, const Eigen::VectorXd& weights) {
  RegionWeights region{name, {}, {}};
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    if (!(weights[v] > 0)) continue;
    region.vertices.push_back(static_cast<std::uint32_t>(v));
    region.weights.push_back(weights[v]);
  }
  return region;
}

Eigen::VectorXd sum_of_weights(const std::vector<RegionWeights>& regions, Eigen::Index vertices) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(vertices);
  for (const RegionWeights& region : regions) {
    for (std::size_t k = 0; k < region.vertices.size(); ++k) sums[region.vertices[k]] += region.weights[k];
  }
  return sums;
}

void scale_down(std::vector<RegionWeights>& regions, Eigen::Index vertices) {
  scale(regions, vertices, [](double sum) { return sum > 1; });
}

void scale_to_one(std::vector<RegionWeights>& regions, Eigen::Index vertices) {
  scale(regions, vertices, [](double sum) { return sum > 0; });
}

void drop_negligible(std::vector<RegionWeights>& regions) {
  for (RegionWeights& region : regions) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      if (region.weights[k] < kNegligibleRegionWeight) continue;
      region.vertices[kept] = region.vertices[k];
      region.weights[kept++] = region.weights[k];
    }
    region.vertices.resize(kept);
    region.weights.resize(kept);
  }
}

std::vector<RegionWeights> renumbered(const std::vector<RegionWeights>& regions,
                                      const std::vector<std::uint32_t>& number) {
  std::vector<RegionWeights> result;
  for (const RegionWeights& region : regions) result.push_back(renumbered(region, number));
  return result;
}

}  // namespace bodyopt
