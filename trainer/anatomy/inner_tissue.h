// Bone, fat and cavity of one half of a body, at the samples of its grid.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/body_grid.h"
#include "trainer/anatomy/body_kind.h"

namespace bodyopt::trainer {

// The parts that volumes are reported by.
enum class BodyRegion : std::uint8_t { trunk, hip, neck, head, thigh, calf, foot, upper_arm, forearm, hand, tail, fin };
constexpr int kBodyRegions = 12;
const char* name_of(BodyRegion region);
enum class TissueKind : std::uint8_t { outside, bone, fat, cavity, muscle, tendon, other_lean };
const char* name_of(TissueKind kind);

// The fields are signed, so that they are read between samples, too. Bone comes before fat, fat before cavity; the rest
// is lean tissue, which muscles share.
struct InnerTissue {
  Eigen::VectorXd bone;            // S: distance to the surface of the nearest bone, roughly, metres; negative inside
  std::vector<int> bone_joint;     // S: the joint of that bone
  Eigen::VectorXd fat;             // S: depth beyond the inner border of the fat, metres; negative in fat and skin
  Eigen::VectorXd cavity;          // S: distance to the wall of chest or belly, roughly, metres; negative inside
  std::vector<BodyRegion> region;  // S
  double brain = 0;                // cubic metres of this half that are bone here, and brain in truth

  // Places of bones that muscles are tied to and pictures name, by name: "iliac_crest", "acromion", ... half space.
  std::map<std::string, Eigen::Vector3d> landmarks;
  std::vector<std::string> notes;  // what of the skeleton could not be placed, one sentence each

  TissueKind kind(int sample) const;  // bone, fat, cavity, or other_lean
};

struct InnerTissueOptions {
  double body_fat = 0.15;  // of the body's mass, 0.02 to 0.6
  BodyKind kind = BodyKind::biped;
  AnatomyCorrections corrections{};  // of bones and fat
};
InnerTissue find_inner_tissue(const HalfBody& body, const BodyGrid& grid, const InnerTissueOptions& options);

// The samples of a half body that muscles can have: neither bone, fat nor cavity.

struct LeanSamples {
  const BodyGrid& grid;
  const InnerTissue& tissue;
  std::vector<int> sample;                     // L: in the grid
  std::vector<int> lean;                       // S: in `sample`, -1: other tissue
  Positions points;                            // L x 3
  std::vector<std::array<int, 6>> neighbours;  // L: lean samples that share a face, along -x, +x, -y ...; -1: none

  LeanSamples(const BodyGrid& grid, const InnerTissue& tissue);
  std::size_t size() const { return sample.size(); }
  BodyRegion region(std::size_t lean_sample) const {
    return tissue.region[static_cast<std::size_t>(sample[lean_sample])];
  }
};

}  // namespace bodyopt::trainer
