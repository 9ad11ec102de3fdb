#include <gtest/gtest.h>

#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "tests/simulate/limb.h"
#include "tests/support/fem_reference.h"
#include "tests/support/shared_data.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_fields.h"

namespace bodyopt::trainer {
namespace {

// The run time's answer for values on the first nodes, surface x 3, in single precision.
Eigen::MatrixXd carried(const DiffuseTable& table, Eigen::Index nodes, const Eigen::MatrixXd& on_surface) {
  std::vector<float> values(static_cast<std::size_t>(3 * nodes)), right(values.size()), scratch;
  for (Eigen::Index n = 0; n < on_surface.rows(); ++n) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      values[static_cast<std::size_t>(3 * n + i)] = static_cast<float>(on_surface(n, i));
    }
  }
  for (std::size_t n = 0; n + 1 < table.row_begin.size(); ++n) {
    for (std::uint32_t e = table.row_begin[n]; e < table.row_begin[n + 1]; ++e) {
      for (std::size_t i = 0; i < 3; ++i) right[3 * n + i] += table.values[e] * values[3 * table.columns[e] + i];
    }
  }
  cpu::block_solve(table.inverse, right, 3, 3, scratch, values);
  return rows_of(values);
}

TEST(Diffuse, SphereHasTheReferencesFieldsInside) {
  const auto path = shared_data("reference/fem/laplace_sphere.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Tensors file(*path);
  const TetMesh given = reference_mesh(file);
  // Surface nodes first, as the tables want them.
  std::vector<int> order, place(static_cast<std::size_t>(given.nodes.rows()), -1);
  const auto put = [&](int node) {
    place[static_cast<std::size_t>(node)] = static_cast<int>(order.size());
    order.push_back(node);
  };
  for (const std::int32_t n : file.get<std::int32_t>("surface")) put(n);
  const auto surface = static_cast<Eigen::Index>(order.size());
  for (int n = 0; n < given.nodes.rows(); ++n) {
    if (place[static_cast<std::size_t>(n)] < 0) put(n);
  }
  TetMesh mesh = given;
  mesh.nodes = given.nodes(order, Eigen::all).eval();
  for (Eigen::Index k = 0; k < mesh.tets.size(); ++k) {
    mesh.tets.data()[k] = place[static_cast<std::size_t>(given.tets.data()[k])];
  }
  const DiffuseTable table = make_diffuse_table(mesh, surface);
  for (const char* name : {"field_linear", "field_bend"}) {
    const Eigen::MatrixXd field = reference_field(file, name)(order, Eigen::all);
    const double size = field.cwiseAbs().maxCoeff();
    EXPECT_LT((diffuse(mesh, field.topRows(surface)) - field).cwiseAbs().maxCoeff(), 1e-9 * size) << name;
    EXPECT_LT((carried(table, mesh.nodes.rows(), field.topRows(surface)) - field).cwiseAbs().maxCoeff(), 1e-6 * size)
        << name;
  }
}

TEST(Diffuse, LinearFieldsAreExact) {
  const Character limb = make_limb();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000);
  const TetMesh& mesh = tets.cage.mesh;
  const auto surface = static_cast<Eigen::Index>(tets.surface.size());
  ASSERT_GT(mesh.nodes.rows(), surface);
  Eigen::Matrix3d linear;
  linear << 0.2, -1.1, 0.4, 0.9, 0.3, -0.2, 0.1, 0.5, 1.3;
  const Eigen::MatrixXd field = mesh.nodes * linear.transpose();
  const DiffuseTable table = make_diffuse_table(mesh, surface);
  const Eigen::MatrixXd found = carried(table, mesh.nodes.rows(), field.topRows(surface));
  EXPECT_LT((found - field).cwiseAbs().maxCoeff(), 1e-6 * field.cwiseAbs().maxCoeff());
  // Nodes inside alone have rows, of nodes on the skin alone.
  EXPECT_EQ(table.row_begin[static_cast<std::size_t>(surface)], 0u);
  for (const std::uint32_t column : table.columns) ASSERT_LT(column, static_cast<std::uint32_t>(surface));
}

}  // namespace
}  // namespace bodyopt::trainer
