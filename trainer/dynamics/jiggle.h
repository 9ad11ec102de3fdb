// Jiggle: the linear finite-element step of what moves on the quasi-static body.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/simulate/metric.h"

namespace bodyopt {

struct Basis;
struct JiggleNode;
struct JiggleStep;
struct JiggleTable;

// K, 3N x 3N, N/m, unknown 3 x node + axis: K_ab = volume (lambda dN_a dN_b^T + mu dN_b dN_a^T + mu (dN_a . dN_b) I).
// One material per tet.
SparseMatrix elastic_stiffness(const TetMesh& mesh, const std::vector<TetMaterial>& materials);

// N, kg: a quarter of each tet's. density: kg/m^3.
Eigen::VectorXd lumped_mass(const TetMesh& mesh, double density);

// M u'' + C u' + (K + springs) u = f, C = mass_damping M + beta (K + springs).
struct JiggleSystem {
  std::vector<TetMaterial> materials;  // T, of K
  Eigen::VectorXd mass;                // N, kg
  Eigen::VectorXd mass_damping;        // N, 1/s
  double stiffness_damping = 0;        // beta, s
  SparseMatrix springs;                // N x N, N/m, alike in all directions
};

// The settings in numbers: stiffness is that of the tissues, by their shares, over the softness; of bodies larger
// than a person by the square of how much larger. Damping ratios are
// met at 3 Hz. Nodes that are held, and pieces of the body that no bone holds, get springs of their own, which `notes`
// tells of.
JiggleSystem make_jiggle_system(const JiggleSettings& settings, const JiggleFields& fields, const Skeleton& skeleton,
                                const TetMesh& mesh, const JiggleAnatomy& anatomy, const Materials& materials,
                                std::vector<std::string>& notes);

// A = M / d^2 + C / d + K + springs, 3N x 3N, unknown 3 x node + axis. Of `step` its length alone is looked at.
SparseMatrix jiggle_matrix(const TetMesh& mesh, const JiggleSystem& system, const JiggleStep& step);

// A, inverted; nodes without muscles. `step` gets the system's beta. Throws
// Error(usage) where its frames a second or substeps are not above 0.
JiggleTable make_jiggle_table(const TetMesh& mesh, const JiggleSystem& system, JiggleStep step);

// The springs of active muscles: every node is of the muscle that has the largest share of it, if the strain table or a
// control knows it. tension: Hz.
void set_muscles(const JiggleAnatomy& anatomy, const std::vector<Muscle>& muscles, const Basis& basis, double tension,
                 std::vector<JiggleNode>& nodes);

}  // namespace bodyopt
