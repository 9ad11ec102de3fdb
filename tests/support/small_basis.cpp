#include "tests/support/small_basis.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "runtime/core/half.h"
#include "runtime/host/rig.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

class SmallBasisBuilder {
 public:
  Basis build() {
    build_skeleton();
    build_skin();
    build_output();
    build_ddm();
    build_strain();
    build_residual();
    basis_.metadata = {{"provenance", "made by tests/support/small_basis.h"}, {"units", "metres"}, {"note", "\"é\"\n"}};
    return std::move(basis_);
  }

 private:
  static constexpr std::uint32_t kRings = 20, kSides = 10, kCap = kRings * kSides, kVertices = kCap + 2;
  static constexpr double kRadius = 0.1, kHeight = 1.0, kSigma = 0.06;

  static std::uint32_t at(std::uint32_t ring, std::uint32_t side) { return ring * kSides + side % kSides; }

  Vec3 rest(std::uint32_t v) const {
    const float* u = basis_.mesh.rest.data() + 3 * std::size_t{v};
    return {static_cast<double>(u[0]), static_cast<double>(u[1]), static_cast<double>(u[2])};
  }

  void build_skeleton() {
    Joint lower, upper;
    lower.name = "lower";
    lower.bind.rotation = axis_angle({0, 1, 0}, 0.4);
    lower.default_local = lower.bind;
    upper.name = "upper";
    upper.parent = 0;
    upper.bind.translation = {0, kHeight / 2, 0};
    upper.bind.rotation = axis_angle({0, 0, 1}, 1.2);
    upper.default_local = upper.bind;
    upper.default_local.rotation = axis_angle({1, 0, 0}, 0.3);
    upper.default_local.scale = {1, 1.1, 1};
    basis_.skeleton.joints = {lower, upper};
    const std::vector<Affine> world = posed_joints(basis_.skeleton, bind_pose(basis_.skeleton).joints);
    for (std::size_t j = 0; j < 2; ++j) basis_.skeleton.joints[j].inverse_bind = inverse(world[j]);
  }

  void build_skin() {
    MeshTable& mesh = basis_.mesh;
    const auto add_vertex = [&](double x, double y, double z) {
      for (const double value : {x, y, z}) mesh.rest.push_back(static_cast<float>(value));
    };
    for (std::uint32_t r = 0; r < kRings; ++r) {
      for (std::uint32_t s = 0; s < kSides; ++s) {
        const double angle = 2 * std::acos(-1.0) * s / kSides;
        add_vertex(kRadius * std::sin(angle), kHeight * r / (kRings - 1), kRadius * std::cos(angle));
      }
    }
    add_vertex(0, -kRadius / 2, 0);
    add_vertex(0, kHeight + kRadius / 2, 0);
    add_triangles(mesh.triangles, [](std::uint32_t ring, std::uint32_t side) { return at(ring, side); });

    std::vector<std::vector<std::uint32_t>> around(kVertices);
    for (std::uint32_t c = 0; c < mesh.triangles.size(); ++c) around[mesh.triangles[c]].push_back(c / 3);
    mesh.vertex_triangle_begin.push_back(0);
    for (const auto& list : around) {
      mesh.vertex_triangles.insert(mesh.vertex_triangles.end(), list.begin(), list.end());
      mesh.vertex_triangle_begin.push_back(static_cast<std::uint32_t>(mesh.vertex_triangles.size()));
    }
  }

  // Outward triangles of sides and caps; `vertex(ring, side)` with side up to kSides, so that a seam can be cut.
  template <typename Vertex>
  static void add_triangles(std::vector<std::uint32_t>& triangles, Vertex vertex) {
    for (std::uint32_t s = 0; s < kSides; ++s) {
      for (std::uint32_t r = 0; r + 1 < kRings; ++r) {
        const std::uint32_t a = vertex(r, s), b = vertex(r, s + 1), c = vertex(r + 1, s), d = vertex(r + 1, s + 1);
        triangles.insert(triangles.end(), {a, b, d, a, d, c});
      }
      triangles.insert(triangles.end(), {kCap, vertex(0, s + 1), vertex(0, s)});
      triangles.insert(triangles.end(), {kCap + 1, vertex(kRings - 1, s), vertex(kRings - 1, s + 1)});
    }
  }

  // Output vertices: the seam at side 0 is cut, and the order is reversed.
  void build_output() {
    MeshTable& mesh = basis_.mesh;
    const std::uint32_t count = kVertices + kRings;
    for (std::uint32_t o = 0; o < count; ++o) {
      const std::uint32_t v = count - 1 - o;
      mesh.output_vertex.push_back(v < kVertices ? v : at(v - kVertices, 0));
    }
    add_triangles(mesh.output_triangles, [](std::uint32_t ring, std::uint32_t side) {
      return side == kSides ? kVertices + ring : at(ring, side);
    });
    for (std::uint32_t& v : mesh.output_triangles) v = count - 1 - v;
  }

  // Weight of the upper joint: a smooth step of 0.4 m around the middle, exactly 0 and 1 outside it.
  static double upper_weight(const Vec3& u) {
    const double t = std::clamp((u[1] - kHeight / 2) / 0.4 + 0.5, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }

  using Moments = std::array<double, 10>;  // S_xx S_xy S_xz S_yy S_yz S_zz, s_x s_y s_z, omega

  // The moments of one vertex per joint, with Gaussian smoothing weights cut off at three sigma.
  std::array<Moments, 2> vertex_moments(std::uint32_t v, DdmVertex& out) const {
    std::vector<std::pair<Vec3, double>> cloud;
    const Vec3 u = rest(v);
    double sum = 0;
    for (std::uint32_t k = 0; k < kVertices; ++k) {
      const double distance = length(rest(k) - u);
      if (distance > 3 * kSigma) continue;
      cloud.emplace_back(rest(k), std::exp(-distance * distance / (2 * kSigma * kSigma)));
      sum += cloud.back().second;
    }
    Vec3 centre{0, 0, 0};
    for (auto& [point, weight] : cloud) centre = centre + (weight /= sum) * point;
    std::array<Moments, 2> moments{};
    double radius2 = 0;
    for (const auto& [point, weight] : cloud) {
      const Vec3 r = point - centre;
      radius2 += weight * dot(r, r);
      const Moments terms = {r[0] * r[0], r[0] * r[1], r[0] * r[2], r[1] * r[1], r[1] * r[2],
                             r[2] * r[2], r[0],        r[1],        r[2],        1};
      const double upper = upper_weight(point);
      for (std::size_t i = 0; i < terms.size(); ++i) {
        moments[0][i] += weight * (1 - upper) * terms[i];
        moments[1][i] += weight * upper * terms[i];
      }
    }
    for (Moments& m : moments) {
      for (std::size_t i = 0; i < 9; ++i) m[i] /= radius2;
    }
    const Vec3 d = u - centre;
    const auto f = [](double x) { return static_cast<float>(x); };
    out = {f(centre[0]), f(centre[1]), f(centre[2]), f(radius2),
           f(d[0]),      f(d[1]),      f(d[2]),      moments[1][9] > moments[0][9] ? 1u : 0u};
    return moments;
  }

  void build_ddm() {
    DdmTable& ddm = basis_.ddm;
    ddm.block_begin.push_back(0);
    for (std::uint32_t first = 0; first < kVertices; first += kBlockSize) {
      const std::uint32_t lanes = std::min(kBlockSize, kVertices - first);
      ddm.vertices.resize(ddm.vertices.size() + kBlockSize);
      std::vector<std::array<Moments, 2>> block;
      for (std::uint32_t l = 0; l < lanes; ++l) block.push_back(vertex_moments(first + l, ddm.vertices[first + l]));
      for (std::uint32_t joint = 0; joint < 2; ++joint) {
        if (std::none_of(block.begin(), block.end(), [&](const auto& m) { return m[joint][9] > 0; })) continue;
        ddm.block_joints.push_back(joint);
        for (std::size_t word = 0; word < kMomentWords; ++word) {
          for (std::uint32_t l = 0; l < kBlockSize; ++l) {
            ddm.moments.push_back(l < lanes ? packed(block[l][joint], word) : 0);
          }
        }
      }
      ddm.block_begin.push_back(static_cast<std::uint32_t>(ddm.block_joints.size()));
    }
  }

  static std::uint32_t packed(const Moments& m, std::size_t word) {
    const auto f = [&](std::size_t i) { return static_cast<float>(m[i]); };
    if (word < 3) return half_from_float(f(2 * word)) | half_from_float(f(2 * word + 1)) << 16;
    return std::bit_cast<std::uint32_t>(f(word + 3));
  }

  // Two fibres along the cylinder, across the bend.
  void build_strain() {
    StrainTable& strain = basis_.strain;
    strain.fibre_begin.push_back(0);
    for (std::uint32_t fibre = 0; fibre < 2; ++fibre) {
      double total = 0;
      Vec3 last{};
      for (std::uint32_t ring = 5; ring < 14; ++ring) {
        const std::uint32_t corners[3] = {at(ring, 3 * fibre), at(ring, 3 * fibre + 1), at(ring + 1, 3 * fibre + 1)};
        const float weights[3] = {0.25f, 0.25f, 0.5f};
        Vec3 point{};
        for (std::size_t i = 0; i < 3; ++i) point = point + static_cast<double>(weights[i]) * rest(corners[i]);
        if (ring > 5) total += length(point - last);
        last = point;
        const std::uint32_t first = static_cast<std::uint32_t>(strain.vertices.size());
        strain.vertices.insert(strain.vertices.end(), corners, corners + 3);
        strain.points.push_back({first, first + 1, first + 2, weights[0], weights[1], weights[2]});
      }
      strain.fibre_begin.push_back(static_cast<std::uint32_t>(strain.points.size()));
      strain.rest_length.push_back(static_cast<float>(total));
      strain.names.push_back("flexor/" + std::to_string(fibre));
    }
  }

  void build_residual() {
    ResidualTable& residual = basis_.residual;
    residual.controls = {"breath"};
    for (int k = 0; k < 9; ++k) residual.features.push_back({-1.5f, 0.75f, -0.1f, 2.5f});  // the upper joint's rotation
    for (int k = 0; k < 2; ++k) residual.features.push_back({-0.3f, 0.2f, -0.02f, 8.0f});  // strains
    residual.features.push_back({0.0f, 1.0f, 0.5f, 2.0f});                                 // breath
    add_region({0, 1, 2, 3, 4, 5, 6, 7, 8}, 4, 0, 3, 0.0f);
    add_region({9, 10, 11}, 3, 5, 4, 0.3f);
    residual.blend_begin.push_back(0);
    for (std::uint32_t first = 0; first < kVertices; first += kBlockSize) {
      const std::uint32_t lanes = std::min(kBlockSize, kVertices - first);
      const std::uint32_t count = upper_weight(rest(first + lanes - 1)) > 0 ? residual.coefficient_count() : 2;
      for (std::uint32_t c = 0; c < count; ++c) {
        residual.blend.push_back(random_blend_entry(random_, random_.uniform(0.005, 0.01), c, lanes));
      }
      residual.blend_begin.push_back(static_cast<std::uint32_t>(residual.blend.size()));
    }
    // Training never bent the joint about x, and the second region minds.
    residual.fade = {.joint_begin = {0, 1},
                     .joints = {0},
                     .direction_begin = {0, 1},
                     .directions = {0, 0, 0, 0, 0, -0.6f, 0, 0.8f, 0},
                     .tolerance = {0.01f},
                     .region_begin = {0, 0, 1},
                     .region_joints = {0},
                     .region_weights = {3.0f}};
  }

  void add_region(const std::vector<std::uint32_t>& features, std::uint32_t coordinates, std::uint32_t centres,
                  std::uint32_t coefficients, float inverse_width2) {
    ResidualTable& residual = basis_.residual;
    const auto size = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
    const std::uint32_t index = size(residual.regions);
    residual.regions.push_back({size(residual.region_features), size(features), size(residual.coordinate_region),
                                coordinates, size(residual.projections), size(residual.centre_region), centres,
                                size(residual.centres), size(residual.coefficient_region), coefficients,
                                size(residual.weights), inverse_width2});
    residual.region_features.insert(residual.region_features.end(), features.begin(), features.end());
    residual.coordinate_region.insert(residual.coordinate_region.end(), coordinates, index);
    for (std::uint32_t k = 0; k < coordinates; ++k) {
      append_halves(residual.projections, random_.floats(features.size(), -1, 1));
    }
    residual.centre_region.insert(residual.centre_region.end(), centres, index);
    residual.coefficient_region.insert(residual.coefficient_region.end(), coefficients, index);
    for (std::uint32_t k = 0; k < centres; ++k) {
      append_halves(residual.centres, random_.floats(coordinates, -1, 1));
    }
    for (std::size_t k = 0; k < coefficients * (1 + coordinates + centres); ++k) {
      residual.weights.push_back(static_cast<float>(random_.uniform(-0.5, 0.5)));
    }
  }

  Random random_{20240607};
  Basis basis_;
};

}  // namespace

Basis small_basis() { return SmallBasisBuilder().build(); }

Basis knowing_basis() {
  Basis basis = small_basis();
  CoverageTable& coverage = basis.coverage;
  coverage = {.names = {"stem", "tip"},
              .joint_begin = {0, 2, 3},
              .joints = {0, 1, 1},
              .sizes = {120, 82},
              .growth = {1e-5f, 4e-5f},
              .usual = {0.5f, 0.25f},
              .local = {0.0004f},
              .motion = {0.003f},
              .metric = {}};
  for (std::uint32_t k = 0; k < basis.residual.regions[1].centre_count; ++k) {
    coverage.local.push_back(0.0005f + 0.0001f * static_cast<float>(k));
    coverage.motion.push_back(0.004f);
  }
  return basis;
}

}  // namespace bodyopt::testing
