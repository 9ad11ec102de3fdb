#include "tests/support/random_tables.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "runtime/core/half.h"

namespace bodyopt::testing {

std::vector<float> Random::floats(std::size_t count, double low, double high) {
  std::vector<float> values(count);
  for (float& v : values) v = static_cast<float>(uniform(low, high));
  return values;
}

std::vector<double> Random::partition(std::size_t count) {
  std::vector<double> weights(count);
  double sum = 0;
  for (double& w : weights) sum += w = uniform(0.05, 1);
  for (double& w : weights) w /= sum;
  return weights;
}

Quat Random::turn(double angle) {
  Vec3 axis{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
  axis = (1 / std::max(1e-3, length(axis))) * axis;
  return axis_angle(axis, uniform(-angle, angle));
}

std::vector<float> random_skinning(Random& random, std::uint32_t joints, std::uint32_t frames, double angle) {
  std::vector<float> skinning;
  for (std::uint32_t k = 0; k < joints * frames; ++k) {
    JointTransform t;
    t.translation = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    t.rotation = random.turn(angle);
    const Affine m = affine_from(t);
    for (const auto& row : m.m) {
      for (const double value : row) skinning.push_back(static_cast<float>(value));
    }
  }
  return skinning;
}

DdmTable random_ddm(Random& random, std::uint32_t vertices, std::uint32_t joints) {
  constexpr std::size_t kCloud = 12;
  DdmTable ddm;
  ddm.block_begin.push_back(0);
  for (std::uint32_t first = 0; first < vertices; first += kBlockSize) {
    std::vector<std::uint32_t> list(joints);
    for (std::uint32_t j = 0; j < joints; ++j) list[j] = j;
    for (std::uint32_t j = joints; j > 1; --j) std::swap(list[j - 1], list[random.below(j)]);
    list.resize(1 + random.below(std::min(5u, joints)));
    const std::size_t entry = ddm.block_joints.size();
    ddm.block_joints.insert(ddm.block_joints.end(), list.begin(), list.end());
    ddm.block_begin.push_back(static_cast<std::uint32_t>(ddm.block_joints.size()));
    ddm.moments.resize(ddm.block_joints.size() * kMomentWords * kBlockSize);
    ddm.vertices.resize(ddm.vertices.size() + kBlockSize);
    for (std::uint32_t lane = 0; lane < kBlockSize && first + lane < vertices; ++lane) {
      const std::vector<double> smoothing = random.partition(kCloud);
      std::array<std::array<double, 3>, kCloud> cloud;
      std::array<double, 3> mean{};
      for (std::size_t k = 0; k < kCloud; ++k) {
        for (std::size_t i = 0; i < 3; ++i) mean[i] += smoothing[k] * (cloud[k][i] = random.uniform(-0.05, 0.05));
      }
      double radius2 = 0;
      std::vector<std::array<double, 10>> moments(list.size());  // S (6), s (3), omega of each joint
      for (std::size_t k = 0; k < kCloud; ++k) {
        const double x = cloud[k][0] - mean[0], y = cloud[k][1] - mean[1], z = cloud[k][2] - mean[2];
        radius2 += smoothing[k] * (x * x + y * y + z * z);
        const std::vector<double> skin = random.partition(list.size());
        const double terms[10] = {x * x, x * y, x * z, y * y, y * z, z * z, x, y, z, 1};
        for (std::size_t j = 0; j < list.size(); ++j) {
          for (std::size_t i = 0; i < 10; ++i) moments[j][i] += smoothing[k] * skin[j] * terms[i];
        }
      }
      std::size_t base = 0;
      for (std::size_t j = 0; j < list.size(); ++j) {
        if (moments[j][9] > moments[base][9]) base = j;
        std::uint32_t* words = ddm.moments.data() + (entry + j) * kMomentWords * kBlockSize + lane;
        const auto half = [&](std::size_t i) { return half_from_float(static_cast<float>(moments[j][i] / radius2)); };
        for (std::size_t w = 0; w < 3; ++w) words[w * kBlockSize] = half(2 * w) | half(2 * w + 1) << 16;
        for (std::size_t i = 0; i < 3; ++i) {
          words[(3 + i) * kBlockSize] = std::bit_cast<std::uint32_t>(static_cast<float>(moments[j][6 + i] / radius2));
        }
        words[6 * kBlockSize] = std::bit_cast<std::uint32_t>(static_cast<float>(moments[j][9]));
      }
      const std::vector<float> centre = random.floats(3, -1, 1), offset = random.floats(3, -0.02, 0.02);
      ddm.vertices[first + lane] = {centre[0], centre[1], centre[2], static_cast<float>(radius2),
                                    offset[0], offset[1], offset[2], list[base]};
    }
  }
  return ddm;
}

StrainTable random_strain(Random& random, std::uint32_t fibres, std::uint32_t points, std::uint32_t vertices) {
  StrainTable strain;
  for (std::uint32_t p = 0; p < points; ++p) strain.vertices.push_back(random.below(vertices));
  strain.fibre_begin.push_back(0);
  for (std::uint32_t f = 0; f < fibres; ++f) {
    for (std::uint32_t k = 2 + random.below(5); k > 0; --k) {
      const std::vector<double> w = random.partition(3);
      strain.points.push_back({random.below(points), random.below(points), random.below(points),
                               static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2])});
    }
    strain.fibre_begin.push_back(static_cast<std::uint32_t>(strain.points.size()));
    strain.rest_length.push_back(static_cast<float>(random.uniform(0.05, 0.5)));
    strain.names.push_back("muscle/" + std::to_string(f));
  }
  return strain;
}

BlendEntry random_blend_entry(Random& random, double scale, std::uint32_t coefficient, std::uint32_t lanes) {
  BlendEntry entry{half_from_float(static_cast<float>(scale)) | coefficient << 16, {}};
  for (std::uint32_t k = 0; k < 3 * kBlockSize; ++k) {
    if (k % kBlockSize < lanes) entry.numbers[k / 4] |= random.below(256) << 8 * (k % 4);
  }
  return entry;
}

void append_halves(std::vector<std::uint32_t>& centres, const std::vector<float>& values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % 2 == 0) centres.push_back(0);
    centres.back() |= half_from_float(values[k]) << 16 * (k % 2);
  }
}

float half_in(const std::vector<std::uint32_t>& words, std::size_t first, std::size_t width, std::size_t row,
              std::size_t column) {
  const std::uint32_t word = words[first + row * ((width + 1) / 2) + column / 2];
  return column % 2 == 0 ? half_low(word) : half_high(word);
}

float centre_value(const ResidualTable& table, const Region& region, std::size_t centre, std::size_t k) {
  return half_in(table.centres, region.centre_values, region.coordinate_count, centre, k);
}

float projection_value(const ResidualTable& table, const Region& region, std::size_t coordinate, std::size_t k) {
  return half_in(table.projections, region.projection_values, region.feature_count, coordinate, k);
}

ResidualTable random_residual(Random& random, std::uint32_t features, std::uint32_t centres, std::uint32_t coefficients,
                              std::uint32_t vertices) {
  ResidualTable table;
  for (std::uint32_t k = 0; k < features; ++k) {
    const double low = random.uniform(-1, 0), high = random.uniform(0, 1);
    table.features.push_back({static_cast<float>(low), static_cast<float>(high),
                              static_cast<float>(random.uniform(low, high)),
                              static_cast<float>(random.uniform(0.5, 4))});
  }
  for (std::uint32_t centre = 0, coefficient = 0; features > 0 && (centre < centres || coefficient < coefficients);) {
    Region r{};
    r.feature_begin = static_cast<std::uint32_t>(table.region_features.size());
    r.feature_count = 1 + random.below(std::min(6u, features));
    r.coordinate_begin = table.coordinate_count();
    r.coordinate_count = 1 + random.below(4);
    r.projection_values = static_cast<std::uint32_t>(table.projections.size());
    r.centre_begin = centre;
    r.centre_count = std::min(random.below(8), centres - centre);
    r.centre_values = static_cast<std::uint32_t>(table.centres.size());
    r.coefficient_begin = coefficient;
    r.coefficient_count = std::min(random.below(6), coefficients - coefficient);
    r.weight_values = static_cast<std::uint32_t>(table.weights.size());
    r.inverse_width2 = static_cast<float>(random.uniform(0.02, 0.5));
    const auto index = static_cast<std::uint32_t>(table.regions.size());
    for (std::uint32_t k = 0; k < r.feature_count; ++k) table.region_features.push_back(random.below(features));
    for (std::uint32_t k = 0; k < r.centre_count; ++k) {
      append_halves(table.centres, random.floats(r.coordinate_count, -2, 2));
    }
    for (std::uint32_t k = 0; k < r.coordinate_count; ++k) {
      append_halves(table.projections, random.floats(r.feature_count, -1, 1));
    }
    const std::vector<float> weights =
        random.floats(std::size_t{r.coefficient_count} * (1 + r.coordinate_count + r.centre_count), -1, 1);
    table.weights.insert(table.weights.end(), weights.begin(), weights.end());
    table.coordinate_region.insert(table.coordinate_region.end(), r.coordinate_count, index);
    table.centre_region.insert(table.centre_region.end(), r.centre_count, index);
    table.coefficient_region.insert(table.coefficient_region.end(), r.coefficient_count, index);
    table.regions.push_back(r);
    centre += r.centre_count;
    coefficient += r.coefficient_count;
  }
  table.blend_begin.push_back(0);
  for (std::uint32_t first = 0; first < vertices; first += kBlockSize) {
    for (std::uint32_t k = table.coefficient_count() == 0 ? 0 : random.below(9); k > 0; --k) {
      const double small = std::exp2(-random.uniform(0, 16)), scale = small * random.uniform(-0.01, 0.01);
      table.blend.push_back(
          random_blend_entry(random, scale, random.below(table.coefficient_count()), vertices - first));
    }
    table.blend_begin.push_back(static_cast<std::uint32_t>(table.blend.size()));
  }
  return table;
}

MeshTable random_mesh(Random& random, std::uint32_t vertices) {
  MeshTable mesh;
  mesh.rest = random.floats(3 * std::size_t{vertices}, -1, 1);
  std::vector<std::vector<std::uint32_t>> around(vertices);
  for (std::uint32_t t = 0; vertices > 1 && t < 2 * vertices; ++t) {
    for (int i = 0; i < 3; ++i) mesh.triangles.push_back(random.below(vertices - 1));
    std::vector<std::uint32_t> corners(mesh.triangles.end() - 3, mesh.triangles.end());
    for (const std::uint32_t v : corners) around[v].push_back(t);
  }
  mesh.vertex_triangle_begin.push_back(0);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    mesh.vertex_triangles.insert(mesh.vertex_triangles.end(), around[v].begin(), around[v].end());
    mesh.vertex_triangle_begin.push_back(static_cast<std::uint32_t>(mesh.vertex_triangles.size()));
    mesh.output_vertex.push_back(v);
  }
  mesh.output_triangles = mesh.triangles;
  return mesh;
}

}  // namespace bodyopt::testing
