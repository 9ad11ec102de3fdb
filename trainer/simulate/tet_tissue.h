// The tissue of a body's tets, by volume.
#pragma once

#include <functional>
#include <vector>

#include "trainer/anatomy/field.h"
#include "trainer/simulate/tissue.h"
#include "trainer/tets/cage.h"

namespace bodyopt::trainer {

struct PointTissue {
  TissueAt at;
  Eigen::Vector3d fibre = Eigen::Vector3d::Zero();  // unit, rest space; of a muscle
};
// Returns the tissue at a point of rest space. Called from several threads.
using TissueField = std::function<PointTissue(const Eigen::Vector3d&)>;
// `anatomy` must outlive it.
TissueField tissue_field(const AnatomyField& anatomy);

// Parts of a tet's volume: together 1, or less where the tet reaches beyond the skin.
struct TissueShares {
  double bone = 0, fat = 0, cavity = 0, muscle = 0;
  double lean = 0;  // tendon, and what is no muscle's

  double sum() const { return bone + fat + cavity + muscle + lean; }
};

// The bone of one joint in a tet.
struct BonePart {
  int tet, joint;
  Eigen::Matrix4d moments;  // cubic metres: the integral over the bone of the products of barycentric weights

  double volume() const { return moments.sum(); }
};

struct TetTissue {
  std::vector<TissueShares> shares;  // T
  std::vector<BonePart> bones;       // by tet
  // Sorted by tet: muscles that are kLeastShare of it or more, and all of muscles that are so nowhere. Their directions
  // are means. The rest of a muscle counts as lean.
  std::vector<FibreTet> fibres;

  static constexpr double kLeastShare = 0.02;
};

// Reads 84 samples a tet, 20 in each eighth of one of second order. What the field does not know, as where a skin was
// mended, is fat.
TetTissue find_tissue(const TetMesh& mesh, const TissueField& field);

// Tets of a lattice reach beyond the skin and overlap: they are as full as the cage's samples.
TetTissue find_tissue(const Cage& cage, const TissueField& field);

// Slips of a muscle that share a region have equal shares of its fibres.
TetTissue find_tissue(const Cage& cage, const AnatomyField& anatomy);

// T: means of what is in them. Bone, which springs hold, is as stiff as muscle.
std::vector<TetMaterial> tet_materials(const std::vector<TissueShares>& shares, const Materials& materials);

}  // namespace bodyopt::trainer
