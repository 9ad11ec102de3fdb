// A tet mesh with reference values of a finite-element problem on it.
#pragma once

#include <string>

#include "geometry/tet_mesh.h"
#include "tests/support/reference_tensors.h"

namespace bodyopt {

Eigen::MatrixXd reference_field(const Tensors& file, const std::string& name);

TetMesh reference_mesh(const Tensors& file);

}  // namespace bodyopt
