#include "trainer/train/residual_table.h"

#include <algorithm>
#include <string>

#include "runtime/basis/error.h"
#include "runtime/cpu/half.h"

namespace bodyopt {
namespace {

template <typename Matrix>
void append_row(std::vector<float>& values, const Matrix& row) {
  for (Eigen::Index k = 0; k < row.size(); ++k) values.push_back(static_cast<float>(row[k]));
}

std::uint32_t coefficient_count(const RegionModel& model, int components) {
  return static_cast<std::uint32_t>(std::min(model.weights.rows(), Eigen::Index{components}));
}

void append_region(const RegionModel& model, std::uint32_t coefficients, ResidualTable& residual) {
  const auto index = static_cast<std::uint32_t>(residual.regions.size());
  Region region{};
  region.feature_begin = static_cast<std::uint32_t>(residual.region_features.size());
  region.feature_count = static_cast<std::uint32_t>(model.features.size());
  region.centre_begin = residual.centre_count();
  region.centre_count = static_cast<std::uint32_t>(model.centres.rows());
  region.centre_values = static_cast<std::uint32_t>(residual.centres.size());
  region.coefficient_begin = residual.coefficient_count();
  region.coefficient_count = coefficients;
  region.weight_values = static_cast<std::uint32_t>(residual.weights.size());
  region.inverse_width2 = static_cast<float>(model.inverse_width2);
  residual.regions.push_back(region);
  residual.region_features.insert(residual.region_features.end(), model.features.begin(), model.features.end());
  residual.centre_region.insert(residual.centre_region.end(), region.centre_count, index);
  residual.coefficient_region.insert(residual.coefficient_region.end(), coefficients, index);
  for (Eigen::Index m = 0; m < model.centres.rows(); ++m) append_row(residual.centres, model.centres.row(m));
  for (Eigen::Index k = 0; k < Eigen::Index{coefficients}; ++k) append_row(residual.weights, model.weights.row(k));
}

BlendEntry blend_entry(const Eigen::Vector3f& b, std::uint32_t coefficient) {
  return {half_from_float(b.x()) | half_from_float(b.y()) << 16, half_from_float(b.z()) | coefficient << 16};
}

}  // namespace

void pack_residual(const std::vector<RegionModel>& models, std::uint32_t vertex_count, int components, double least,
                   ResidualTable& residual) {
  const ResidualTable old = std::move(residual);
  residual = {};
  residual.controls = old.controls;
  residual.features = old.features;
  std::vector<std::vector<BlendEntry>> entries(vertex_count);
  for (const RegionModel& model : models) {
    const std::uint32_t coefficients = coefficient_count(model, components), first = residual.coefficient_count();
    if (first + coefficients > 65536) {
      throw Error(ErrorKind::mismatch, std::to_string(models.size()) + " regions of up to " +
                                           std::to_string(components) +
                                           " components are more than 65536 coefficients: ask for fewer components");
    }
    append_region(model, coefficients, residual);
    for (std::size_t n = 0; n < model.vertices.size(); ++n) {
      for (std::uint32_t k = 0; k < coefficients; ++k) {
        const Eigen::Vector3f b = model.directions.col(k).segment<3>(static_cast<Eigen::Index>(3 * n));
        if (!(double{b.norm()} * model.largest[k] > least)) continue;
        entries[model.vertices[n]].push_back(blend_entry(b, first + k));
      }
    }
  }
  residual.blend_begin.push_back(0);
  for (const auto& list : entries) {
    residual.blend.insert(residual.blend.end(), list.begin(), list.end());
    residual.blend_begin.push_back(static_cast<std::uint32_t>(residual.blend.size()));
  }
}

}  // namespace bodyopt
