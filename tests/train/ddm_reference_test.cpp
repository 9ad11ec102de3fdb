// Direct Delta Mush of a real character against an independent implementation in double precision.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/mesh.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/reference_tensors.h"
#include "tests/support/shared_data.h"
#include "tests/support/textbook_ddm.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

struct Reference {
  explicit Reference(const Tensors& file)
      : skinning(file.get<double>("skinning")), ddm(file.get<double>("ddm")), gap(file.get<float>("gap")) {
    const auto positions = file.get<double>("vertices");
    const auto faces = file.get<std::int32_t>("faces");
    const auto dense = file.get<double>("weights");
    const std::size_t count = positions.size() / 3;
    rest = Eigen::Map<const Positions>(positions.data(), static_cast<Eigen::Index>(count), 3);
    triangles.resize(static_cast<Eigen::Index>(faces.size() / 3), 3);
    for (std::size_t k = 0; k < faces.size(); ++k) {
      triangles.data()[k] = static_cast<std::uint32_t>(faces[k]);
    }
    joints = dense.size() / count;
    weights.resize(count);
    for (std::size_t k = 0; k < dense.size(); ++k) {
      if (dense[k] > 0) weights[k / joints].push_back({static_cast<std::uint32_t>(k % joints), dense[k]});
    }
    box = box_diagonal(rest);
  }
  Positions rest;
  Triangles triangles;
  std::vector<std::vector<JointWeight>> weights;
  std::vector<double> skinning, ddm;
  std::vector<float> gap;
  std::size_t joints = 0;
  double box = 0;
};

// From the unpacked moments, in double precision, rotations by SVD.
Eigen::Vector3d evaluate(const VertexMoments& vertex, const double* skinning) {
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const auto matrix = [&](std::uint32_t j) { return Rows(Eigen::Map<const Rows>(skinning + 12 * j)); };
  Eigen::Matrix3d q = Eigen::Matrix3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  const Eigen::Vector3d base = matrix(vertex.joints[0].joint) * vertex.centre.homogeneous();
  for (const JointMoments& m : vertex.joints) {
    const Rows a = matrix(m.joint);
    const Eigen::Vector3d arm = a * vertex.centre.homogeneous() - base;
    q += a.leftCols<3>() * m.second + arm * m.first.transpose();
    t += m.omega * arm + vertex.radius2 * a.leftCols<3>() * m.first;
  }
  return base + t + testing::nearest_rotation(q) * vertex.offset;
}

// Largest distances from the reference over all frames, as parts of the bounding box's diagonal.
struct Distances {
  double unpacked = 0, packed = 0;
};

Distances distances(const Reference& reference, double prune) {
  const auto moments = ddm_moments(reference.rest, reference.triangles, reference.weights,
                                   {.radius = 0.045, .steps = 20, .prune = prune});
  const DdmTable table = pack_ddm(moments);
  const std::size_t count = reference.weights.size(), frames = reference.gap.size() / count;
  Distances result;
  for (std::size_t f = 0; f < frames; ++f) {
    const double* skinning = reference.skinning.data() + 12 * reference.joints * f;
    const std::vector<float> matrices(skinning, skinning + 12 * reference.joints);
    const std::vector<float> origin(4, 0.0f), nothing(3 * count, 0.0f);
    std::vector<float> posed(3 * count);
    cpu::pose_skin(table, static_cast<std::uint32_t>(reference.joints), matrices, origin, nothing, posed);
    for (std::size_t v = 0; v < count; ++v) {
      if (!(reference.gap[f * count + v] > 0.05)) continue;
      const Eigen::Map<const Eigen::Vector3d> expected(&reference.ddm[3 * (f * count + v)]);
      const Eigen::Vector3d packed = Eigen::Map<const Eigen::Vector3f>(&posed[3 * v]).cast<double>();
      result.unpacked = std::max(result.unpacked, (evaluate(moments[v], skinning) - expected).norm() / reference.box);
      result.packed = std::max(result.packed, (packed - expected).norm() / reference.box);
    }
  }
  return result;
}

TEST(DdmReference, CesiumMan) {
  const auto path = shared_data("reference/ddm/cesium_man.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Reference reference{Tensors(*path)};
  const Distances exact = distances(reference, 0), pruned = distances(reference, DdmOptions{}.prune);
  EXPECT_LT(exact.unpacked, 1e-9);
  EXPECT_LT(exact.packed, 1e-5);
  EXPECT_LT(pruned.packed, 1e-5);
  RecordProperty("packed", std::to_string(exact.packed));
  RecordProperty("pruned_and_packed", std::to_string(pruned.packed));
}

}  // namespace
}  // namespace bodyopt::trainer
