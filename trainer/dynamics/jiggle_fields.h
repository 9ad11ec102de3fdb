// The settings of jiggle, spread over the body.
#pragma once

#include <vector>

#include "assets/characters/muscles.h"
#include "geometry/region_weights.h"
#include "geometry/tet_mesh.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/simulate/bone_springs.h"

namespace bodyopt {
struct DiffuseTable;
}

namespace bodyopt::trainer {

// Diffuse: from the skin's nodes to those inside.

// The first `surface_count` nodes of the mesh are given, the others follow: the finite-element Laplacian of the rest
// tets, split, and its inner part inverted. Throws Error(mismatch) where that is singular.
DiffuseTable make_diffuse_table(const TetMesh& mesh, Eigen::Index surface_count);

// Diffuses columns of values in double precision: surface_count x any -> N x the same.
using NodeValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
NodeValues diffuse(const TetMesh& mesh, const NodeValues& on_surface);

// The parts of a body that tetrahedra belong to: bones, muscles, parts that move with joints.
struct JiggleAnatomy {
  TetTissue tissue;
  SparseMatrix bone_springs;     // N x N, N/m
  NodeWeights joint_share;       // N x J, rows sum to 1
  std::vector<bool> is_end;      // J: a limb ends with this joint (a head, hand, foot, tip of a tail)
  Eigen::MatrixXd muscle_share;  // N x M: the part of a node's tissue that each muscle is
};

// Finds them in a cage as simulation does. field: of the character and its `muscle_count` muscles.
JiggleAnatomy find_anatomy(const Character& character, const AnatomyField& field, std::size_t muscle_count,
                           const Cage& cage, const Materials& materials);

struct JiggleFields {
  Eigen::VectorXd softness, damping, amount, flesh;  // N, of the nodes
  std::vector<double> skin_amount;                   // V; exactly 0 where the skin is held
  std::vector<double> skin_limit;                    // V, metres: what no displacement reaches
};

// Throws Error(mismatch) where the settings name what the character, its muscles or `painted` lack.
void require_names(const JiggleSettings& settings, const Character& character, const std::vector<Muscle>& muscles,
                   const std::vector<RegionWeights>& painted);

// Joints spread by their weights, muscles by their share of the tissue, painted regions by their weights on the skin.
// Diffuse takes those inwards as it does positions. Softness and flesh are blended by their logarithms.
// Flesh that the settings leave open is a share of the body's extent, where it is thin of its thickness.
// Throws as require_possible and require_names.
JiggleFields spread_settings(const JiggleSettings& settings, const Character& character,
                             const std::vector<Muscle>& muscles, const std::vector<RegionWeights>& painted,
                             const DynamicsTets& tets, const JiggleAnatomy& anatomy);

// Returns settings to edit, which spread as the given ones do. Where those leave the flesh open, joints of thin tissue
// get regions with a factor of 1, unless a region gives them flesh. These come first; comments give the choice, metres.
JiggleSettings chosen_settings(const JiggleSettings& settings, const JiggleFields& fields, const Character& character,
                               const JiggleAnatomy& anatomy);

}  // namespace bodyopt::trainer
