// Jiggle: the linear finite-element step of what moves on the quasi-static body.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/simulate/metric.h"

namespace bodyopt {
struct Basis;
struct JiggleNode;
struct JiggleStep;
struct JiggleTable;
struct Dynamics;
struct NodeMotion;
}  // namespace bodyopt

namespace bodyopt::trainer {

// Characters bring no ribs and no pelvis, and bones found along joints are thin where a trunk is wide. So tissue deeper
// under the skin than `flesh` (N, metres) is held as bone is, fully from a quarter deeper on. `stiffness`: N/m per
// cubic metre. -> N x N, N/m.
SparseMatrix core_springs(const Positions& vertices, const Triangles& triangles, const Cage& cage,
                          const Eigen::VectorXd& flesh, double stiffness);

// K_ab = volume (lambda dN_a dN_b^T + mu dN_b dN_a^T + mu (dN_a . dN_b) I).
// One material per tet. -> K, 3N x 3N, N/m, unknown 3 x node + axis.
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

// Stiffness is that of the tissues, by their shares, over the softness. For a body n times larger than a person it is
// n^2 times as high. Damping ratios are met at 3 Hz. Nodes that are held, and pieces of the body that no bone holds,
// get springs of their own. `notes` reports such pieces.
JiggleSystem make_jiggle_system(const JiggleSettings& settings, const JiggleFields& fields, const Skeleton& skeleton,
                                const TetMesh& mesh, const JiggleAnatomy& anatomy, const Materials& materials,
                                std::vector<std::string>& notes);

// A = M / d^2 + C / d + K + springs, 3N x 3N, unknown 3 x node + axis. Of `step` its length alone is looked at.
SparseMatrix jiggle_matrix(const TetMesh& mesh, const JiggleSystem& system, const JiggleStep& step);

// A, inverted; nodes without muscles. `step` gets the system's beta. Throws
// Error(usage) where its frames a second or substeps are not above 0.
JiggleTable make_jiggle_table(const TetMesh& mesh, const JiggleSystem& system, JiggleStep step);

// Sets the springs of active muscles. Every node belongs to the muscle with the largest share of it. It has a spring if
// the strain table or a control knows that muscle. tension: Hz.
void set_muscles(const JiggleAnatomy& anatomy, const std::vector<Muscle>& muscles, const Basis& basis, double tension,
                 std::vector<JiggleNode>& nodes);

// Keeps thin tips, and parts that no bone is in, from swinging slower than flesh does.

// Tissue is linear, so parts that swing slowly go far. A tip of 1 Hz moves a quarter of a metre under 1 g, and more
// while a clip lasts. A node's give is its displacement under 1 m/s^2, metres, along its softest axis. It is 1 / w^2 of
// the part that swings there (Rayleigh's quotient of the static shape). Nodes of parts slower than `lowest` /
// sqrt(softness) hertz get springs of their own (N/m in system.springs), which raise that frequency to within a tenth.
// `notes` names joints whose tissue this held, and how slow it was. lowest: Hz, 0: nothing is held. softness: N. Throws
// Error(mismatch) where tets are too flat to compute with.
void hold_slow_parts(double lowest, const Eigen::VectorXd& softness, const Skeleton& skeleton, const TetMesh& mesh,
                     const JiggleAnatomy& anatomy, JiggleSystem& system, std::vector<std::string>& notes);

// Measures what diffuse and jiggle do in a frame.

struct JiggleMeasure {
  std::uint32_t inverted_tets = 0;  // inside out where diffuse carries them
  double rms_mm = 0, max_mm = 0;    // of the skin's vertices, from the quasi-static skin
  // Vertices that without their limit would move beyond it, and the one of these
  // that would go furthest for it, in runtime order.
  std::uint32_t limited = 0, most_limited = 0;
};

// motion: after the frame, as JiggleState holds it.
JiggleMeasure measure_jiggle(const Dynamics& dynamics, const NodeMotion& motion);

}  // namespace bodyopt::trainer
