// Skin that is compressed in a bend, evened out.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>

#include "geometry/mesh.h"
#include "runtime/deformer/deformer.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/bake_stack.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace relax_test {

using namespace trainer;

class Relax : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const TemporaryFolder folder;
    std::ofstream(folder / "stack.json")
        << R"({"schema": "bodyopt-modifiers-1", "modifiers": [{"name": "even", "type": "relax"}]})";
    basis_ = new Basis(build_ddm_basis(limb_character(), {}));
    std::vector<std::string> notes;
    basis_->modifiers = bake_stack(folder / "stack.json", *basis_, notes);
    validate(*basis_, "the test's basis");
  }
  static void TearDownTestSuite() { delete basis_; }

  static Positions shown(const Pose& pose, float strength) {
    Pose weighted = pose;
    weighted.modifiers = {strength};
    return EvaluatedSkin(*basis_)({&weighted, 1})[0];
  }
  static Pose bent() {
    Pose pose = bind_pose(basis_->skeleton);
    pose.joints[1].rotation = axis_angle({1, 0, 0}, 1.7);
    return pose;
  }

  // Of the triangles that the bend compresses to less than four fifths of their area: the standard deviation of the
  // logarithm of what they have left.
  static double unevenness(const Positions& skin) {
    const Positions rest = rows_of(basis_->mesh.rest), bend = shown(bent(), 0);
    const Triangles triangles = rows_of(basis_->mesh.triangles);
    const auto area = [&](const Positions& points, Eigen::Index t) {
      const Eigen::RowVector3d a = points.row(triangles(t, 0)), b = points.row(triangles(t, 1)),
                               c = points.row(triangles(t, 2));
      return (b - a).cross(c - a).norm();
    };
    std::vector<double> left;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      if (area(bend, t) < 0.8 * area(rest, t)) left.push_back(std::log(area(skin, t) / area(rest, t)));
    }
    const Eigen::Map<const Eigen::VectorXd> values(left.data(), static_cast<Eigen::Index>(left.size()));
    return std::sqrt((values.array() - values.mean()).square().mean());
  }

  static inline Basis* basis_ = nullptr;
};

TEST_F(Relax, EvensOutWhatIsCompressed) { EXPECT_LT(unevenness(shown(bent(), 1)), 0.8 * unevenness(shown(bent(), 0))); }

TEST_F(Relax, LeavesAloneWhatIsNot) {
  const Pose rest = bind_pose(basis_->skeleton);
  EXPECT_EQ(shown(rest, 1), shown(rest, 0));
  const Positions moved = shown(bent(), 1) - shown(bent(), 0);
  const Positions where = rows_of(basis_->mesh.rest);
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    const bool far = std::abs(where(v, 2) - 0.3) > 0.2;
    ASSERT_TRUE(!far || moved.row(v).norm() == 0) << "vertex " << v;
  }
  EXPECT_GT(moved.rowwise().norm().maxCoeff(), 1e-4);
}

}  // namespace relax_test
}  // namespace bodyopt::testing
