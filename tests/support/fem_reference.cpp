#include "tests/support/fem_reference.h"

namespace bodyopt {

Eigen::MatrixXd reference_field(const Tensors& file, const std::string& name) {
  const std::vector<double> values = file.get<double>(name);
  return Eigen::Map<const Positions>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3);
}

TetMesh reference_mesh(const Tensors& file) {
  TetMesh mesh;
  mesh.nodes = reference_field(file, "vertices");
  const std::vector<std::int32_t> tets = file.get<std::int32_t>("tets");
  mesh.tets = Eigen::Map<const Tets>(tets.data(), static_cast<Eigen::Index>(tets.size() / 4), 4);
  orient(mesh);
  return mesh;
}

}  // namespace bodyopt
