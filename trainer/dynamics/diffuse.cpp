#include "trainer/dynamics/diffuse.h"

#include <numeric>

#include "base/linear_algebra.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/simulate/metric.h"

namespace bodyopt {
namespace {

SparseMatrix laplacian_of(const TetMesh& mesh) {
  return tet_laplacian(mesh, std::vector<double>(static_cast<std::size_t>(mesh.tets.rows()), 1));
}

}  // namespace

DiffuseTable make_diffuse_table(const TetMesh& mesh, Eigen::Index surface_count) {
  const Eigen::Index nodes = mesh.nodes.rows(), inside = nodes - surface_count;
  const SparseMatrix laplacian = laplacian_of(mesh);
  DiffuseTable table;
  table.row_begin.assign(static_cast<std::size_t>(surface_count) + 1, 0);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> to_surface = laplacian.bottomLeftCorner(inside, surface_count);
  for (Eigen::Index row = 0; row < inside; ++row) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(to_surface, row); entry; ++entry) {
      table.columns.push_back(static_cast<std::uint32_t>(entry.col()));
      table.values.push_back(static_cast<float>(-entry.value()));
    }
    table.row_begin.push_back(static_cast<std::uint32_t>(table.columns.size()));
  }
  if (inside == 0) {
    table.inverse.unknown_count = static_cast<std::uint32_t>(nodes);
    return table;
  }
  const Positions points = mesh.nodes.bottomRows(inside);
  InverseNodes inner{points, std::vector<int>(static_cast<std::size_t>(inside)), static_cast<int>(nodes)};
  std::iota(inner.nodes.begin(), inner.nodes.end(), static_cast<int>(surface_count));
  table.inverse = invert(laplacian.bottomRightCorner(inside, inside), inner, 1);
  return table;
}

Eigen::MatrixXd diffuse(const TetMesh& mesh, const Eigen::MatrixXd& on_surface) {
  const Eigen::Index surface = on_surface.rows(), inside = mesh.nodes.rows() - surface;
  Eigen::MatrixXd values(mesh.nodes.rows(), on_surface.cols());
  values.topRows(surface) = on_surface;
  if (inside == 0) return values;
  const SparseMatrix laplacian = laplacian_of(mesh);
  const SparseSolver factor(laplacian.bottomRightCorner(inside, inside));
  if (!factor.is_solvable()) {
    throw Error(ErrorKind::mismatch, "the tetrahedra are too flat to carry values inwards");
  }
  const SparseMatrix to_surface = laplacian.bottomLeftCorner(inside, surface);
  values.bottomRows(inside) = factor.solve(-(to_surface * on_surface));
  return values;
}

}  // namespace bodyopt
