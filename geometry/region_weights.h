// A region of the skin, and what makes regions share it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace bodyopt {

// Region weights below this are dropped.
constexpr double kNegligibleRegionWeight = 0.03;

// A region's vertices, ascending, and its share of each, in (0, 1].
struct RegionWeights {
  std::string name;
  std::vector<std::uint32_t> vertices;
  std::vector<double> weights;
};

// The region of the vertices whose weight is above 0; weights: of every vertex.
[[nodiscard]] RegionWeights region_of(const std::string& name, const Eigen::VectorXd& weights);

// The mean over a region of what its vertices have, by its weights; 0 of none. value(k): of its k-th vertex.
template <typename Value>
double mean_over(const RegionWeights& region, const Value& value) {
  double sum = 0, weights = 0;
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    sum += region.weights[k] * value(k);
    weights += region.weights[k];
  }
  return weights > 0 ? sum / weights : 0;
}

// The sum of all regions' weights at each of `vertices` vertices.
Eigen::VectorXd sum_of_weights(const std::vector<RegionWeights>& regions, Eigen::Index vertices);

// Scales the weights to a sum of 1 where they exceed it. Sums that are 1 but for rounding stay as they are: what was
// written reads back the same.
void scale_down(std::vector<RegionWeights>& regions, Eigen::Index vertices);
// Scales the weights to a sum of 1 wherever there is any weight.
void scale_to_one(std::vector<RegionWeights>& regions, Eigen::Index vertices);

void drop_negligible(std::vector<RegionWeights>& regions);

// The regions on vertices that have other numbers: `number` of each vertex.
[[nodiscard]] std::vector<RegionWeights> renumbered(const std::vector<RegionWeights>& regions,
                                                    const std::vector<std::uint32_t>& number);

}  // namespace bodyopt
