#include <bit>
#include <cmath>
#include <span>

#include "runtime/basis/basis.h"
#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

// Checks of one basis; every refusal names the array, what was expected and what was found.
class Validator {
 public:
  Validator(const Basis& basis, const std::string& origin) : basis_(basis), origin_(origin) {}

  void run() const {
    check_skeleton();
    check_mesh();
    check_ddm();
    check_strain();
    check_residual();
    check_regions();
    check_blend();
  }

 private:
  using Indices = std::vector<std::uint32_t>;

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::file, origin_ + ": " + what + " (damaged, or written by something else)");
  }

  void expect_size(const char* name, std::size_t found, std::size_t expected) const {
    if (found != expected) {
      refuse(std::string(name) + " has " + std::to_string(found) + " entries, expected " + std::to_string(expected));
    }
  }

  void expect_below(const char* name, std::span<const std::uint32_t> indices, std::size_t limit) const {
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (indices[k] < limit) continue;
      refuse(std::string(name) + "[" + std::to_string(k) + "] is " + std::to_string(indices[k]) +
             ", expected an index below " + std::to_string(limit));
    }
  }

  void expect_offsets(const char* name, const Indices& begin, std::size_t rows, std::size_t end) const {
    expect_size(name, begin.size(), rows + 1);
    if (begin[0] != 0) refuse(std::string(name) + " does not start at 0");
    for (std::size_t k = 0; k < rows; ++k) {
      if (begin[k] > begin[k + 1]) refuse(std::string(name) + " falls at row " + std::to_string(k));
    }
    if (begin[rows] != end) {
      refuse(std::string(name) + " ends at " + std::to_string(begin[rows]) + ", expected " + std::to_string(end));
    }
  }

  void expect_finite(const char* name, std::span<const float> values) const {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!std::isfinite(values[k])) refuse(std::string(name) + "[" + std::to_string(k) + "] is not a finite number");
    }
  }

  static bool finite_halves(std::uint32_t word) {
    return (word & 0x7c00u) != 0x7c00u && ((word >> 16) & 0x7c00u) != 0x7c00u;
  }

  static bool finite(const JointTransform& t) {
    double sum = 0;
    for (const double x : t.translation) sum += std::abs(x);
    for (const double x : t.rotation) sum += std::abs(x);
    for (const double x : t.scale) sum += std::abs(x);
    return std::isfinite(sum);
  }

  void check_skeleton() const {
    const auto& joints = basis_.skeleton.joints;
    if (joints.empty()) refuse("it has no joints");
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Joint& joint = joints[j];
      const std::string name = "joint " + std::to_string(j) + " ('" + joint.name + "')";
      if (joint.parent < -1 || joint.parent >= static_cast<int>(j)) {
        refuse(name + " has parent " + std::to_string(joint.parent) + ", expected one before it");
      }
      double sum = 0;
      for (const auto& row : joint.inverse_bind.m) {
        for (const double x : row) sum += std::abs(x);
      }
      if (!finite(joint.bind) || !finite(joint.default_local) || !std::isfinite(sum)) {
        refuse(name + " has a transform that is not of finite numbers");
      }
    }
  }

  void check_mesh() const {
    const MeshTable& mesh = basis_.mesh;
    const std::size_t vertices = mesh.rest.size() / 3;
    if (mesh.rest.empty() || mesh.rest.size() % 3 != 0) refuse("mesh.rest is not V x 3");
    if (mesh.triangles.size() % 3 != 0 || mesh.output_triangles.size() % 3 != 0) refuse("triangles are not T x 3");
    expect_finite("mesh.rest", mesh.rest);
    expect_below("mesh.triangles", mesh.triangles, vertices);
    expect_below("mesh.output_vertex", mesh.output_vertex, vertices);
    expect_below("mesh.output_triangles", mesh.output_triangles, mesh.output_vertex.size());
    expect_offsets("mesh.vertex_triangle_begin", mesh.vertex_triangle_begin, vertices, mesh.vertex_triangles.size());
    expect_size("mesh.vertex_triangles", mesh.vertex_triangles.size(), mesh.triangles.size());
    expect_below("mesh.vertex_triangles", mesh.vertex_triangles, mesh.triangles.size() / 3);
    for (std::size_t v = 0; v < vertices; ++v) {
      for (std::uint32_t k = mesh.vertex_triangle_begin[v]; k < mesh.vertex_triangle_begin[v + 1]; ++k) {
        const std::uint32_t* t = mesh.triangles.data() + 3 * std::size_t{mesh.vertex_triangles[k]};
        if (t[0] != v && t[1] != v && t[2] != v) {
          refuse("mesh.vertex_triangles[" + std::to_string(k) + "] names a triangle that does not touch vertex " +
                 std::to_string(v));
        }
      }
    }
  }

  void check_ddm() const {
    const DdmTable& ddm = basis_.ddm;
    const std::size_t vertices = basis_.mesh.vertex_count();
    const std::size_t blocks = (vertices + kBlockSize - 1) / kBlockSize;
    expect_offsets("ddm.block_begin", ddm.block_begin, blocks, ddm.block_joints.size());
    expect_below("ddm.block_joints", ddm.block_joints, basis_.skeleton.size());
    expect_size("ddm.moments", ddm.moments.size(), ddm.block_joints.size() * kMomentWords * kBlockSize);
    expect_size("ddm.vertices", ddm.vertices.size(), blocks * kBlockSize);
    for (std::size_t k = 0; k < ddm.moments.size(); ++k) {
      const std::uint32_t word = ddm.moments[k];
      const bool halves = (k / kBlockSize) % kMomentWords < 3;
      if (halves ? !finite_halves(word) : !std::isfinite(std::bit_cast<float>(word))) {
        refuse("ddm.moments[" + std::to_string(k) + "] is not a finite number");
      }
    }
    for (std::size_t v = 0; v < ddm.vertices.size(); ++v) {
      const DdmVertex& vertex = ddm.vertices[v];
      const float numbers[] = {vertex.centre_x, vertex.centre_y, vertex.centre_z, vertex.radius2,
                               vertex.offset_x, vertex.offset_y, vertex.offset_z};
      expect_finite("ddm.vertices", numbers);
      if (vertex.base_joint >= basis_.skeleton.size()) {
        refuse("ddm.vertices[" + std::to_string(v) + "] has base joint " + std::to_string(vertex.base_joint) +
               ", expected one of " + std::to_string(basis_.skeleton.size()));
      }
    }
  }

  void check_strain() const {
    const StrainTable& strain = basis_.strain;
    const std::size_t fibres = strain.rest_length.size();
    if (fibres > 0 || !strain.fibre_begin.empty()) {
      expect_offsets("strain.fibre_begin", strain.fibre_begin, fibres, strain.points.size());
    }
    expect_size("the fibres' names", strain.names.size(), fibres);
    expect_below("strain.vertices", strain.vertices, basis_.mesh.vertex_count());
    for (std::size_t k = 0; k < strain.points.size(); ++k) {
      const FibrePoint& p = strain.points[k];
      const std::uint32_t indices[] = {p.a, p.b, p.c};
      expect_below("strain.points", indices, strain.vertices.size());
      if (!(std::abs(p.wa + p.wb + p.wc - 1) < 1e-4f) || !(std::abs(p.wa) + std::abs(p.wb) + std::abs(p.wc) < 10)) {
        refuse("strain.points[" + std::to_string(k) + "] has weights that do not sum to 1");
      }
    }
    for (std::size_t k = 0; k < fibres; ++k) {
      if (!(strain.rest_length[k] > 0) || !std::isfinite(strain.rest_length[k])) {
        refuse("strain.rest_length[" + std::to_string(k) + "] is not above 0");
      }
    }
  }

  void check_residual() const {
    const ResidualTable& residual = basis_.residual;
    const std::size_t blend_rows = basis_.mesh.vertex_count();
    expect_offsets("residual.blend_begin", residual.blend_begin, blend_rows, residual.blend.size());
    std::size_t joint_features = 0;
    for (const Joint& joint : basis_.skeleton.joints) joint_features += joint.parent >= 0 ? 9 : 0;
    const std::size_t features = joint_features + basis_.strain.rest_length.size() + residual.controls.size();
    if (residual.regions.empty() && residual.features.empty()) {
      if (!residual.controls.empty()) refuse("it has controls but no features");
    } else {
      expect_size("residual.features", residual.features.size(), features);
    }
    for (std::size_t k = 0; k < residual.features.size(); ++k) {
      const FeatureRange& range = residual.features[k];
      const float numbers[] = {range.low, range.high, range.mean, range.inverse_scale};
      expect_finite("residual.features", numbers);
      if (range.low > range.high || range.inverse_scale < 0) {
        refuse("residual.features[" + std::to_string(k) + "] has an empty range or a negative scale");
      }
    }
    expect_below("residual.region_features", residual.region_features, residual.features.size());
    expect_finite("residual.centres", residual.centres);
    expect_finite("residual.weights", residual.weights);
  }

  // Regions must tile every array they point into, in order.
  void check_regions() const {
    const ResidualTable& residual = basis_.residual;
    std::size_t features = 0, centres = 0, centre_values = 0, coefficients = 0, weights = 0;
    for (std::size_t r = 0; r < residual.regions.size(); ++r) {
      const Region& region = residual.regions[r];
      if (region.feature_begin != features || region.centre_begin != centres || region.centre_values != centre_values ||
          region.coefficient_begin != coefficients || region.weight_values != weights) {
        refuse("residual.regions[" + std::to_string(r) + "] does not follow the one before it");
      }
      if (!(region.inverse_width2 >= 0) || !std::isfinite(region.inverse_width2)) {
        refuse("residual.regions[" + std::to_string(r) + "] has a kernel width that is no number");
      }
      features += region.feature_count;
      centres += region.centre_count;
      centre_values += std::size_t{region.centre_count} * region.feature_count;
      coefficients += region.coefficient_count;
      weights += std::size_t{region.coefficient_count} *
                 (1 + std::size_t{region.feature_count} + std::size_t{region.centre_count});
      if (coefficients > 65536 || centres > residual.centre_region.size() ||
          coefficients > residual.coefficient_region.size()) {
        refuse("residual.regions[" + std::to_string(r) + "] points outside the tables");
      }
      for (std::uint32_t m = 0; m < region.centre_count; ++m) {
        if (residual.centre_region[region.centre_begin + m] != r)
          refuse("residual.centre_region disagrees with regions");
      }
      for (std::uint32_t c = 0; c < region.coefficient_count; ++c) {
        if (residual.coefficient_region[region.coefficient_begin + c] != r) {
          refuse("residual.coefficient_region disagrees with regions");
        }
      }
    }
    expect_size("residual.region_features", residual.region_features.size(), features);
    expect_size("residual.centre_region", residual.centre_region.size(), centres);
    expect_size("residual.centres", residual.centres.size(), centre_values);
    expect_size("residual.coefficient_region", residual.coefficient_region.size(), coefficients);
    expect_size("residual.weights", residual.weights.size(), weights);
  }

  void check_blend() const {
    const ResidualTable& residual = basis_.residual;
    for (std::size_t k = 0; k < residual.blend.size(); ++k) {
      const BlendEntry& entry = residual.blend[k];
      if ((entry.z_coefficient >> 16) >= residual.coefficient_region.size() || !finite_halves(entry.xy) ||
          !finite_halves(entry.z_coefficient & 0xffffu)) {
        refuse("residual.blend[" + std::to_string(k) + "] names no coefficient or holds no finite number");
      }
    }
  }

  const Basis& basis_;
  const std::string& origin_;
};

}  // namespace

void validate(const Basis& basis, const std::string& origin) { Validator(basis, origin).run(); }

}  // namespace bodyopt
