#include <algorithm>

#include "trainer/anatomy/human_bones.h"
#include "trainer/anatomy/shapes.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

// Behind the ribs, under the skin of the back.
Vector3d behind_cage(const HumanSkeleton& skeleton, const RibCage& cage, double aside, double height, double behind) {
  const auto depths = skeleton.survey.depths(height, aside);
  if (!depths) return {aside, height, 0};
  const double step = skeleton.mm(2);
  const double under_skin =
      depths->back + skeleton.survey.spot({aside, height, depths->back + step}).fat + skeleton.mm(12);
  for (double z = depths->back; z < depths->front; z += step) {
    if (cage.distance(skeleton.survey.spot({aside, height, z})) < 0)
      return {aside, height, std::max(z - behind, under_skin)};
  }
  return {aside, height, depths->back + skeleton.mm(22)};
}

// The end of the collar bone at the breastbone.
Vector3d sternal_end(const HumanSkeleton& skeleton, double height) {
  const double aside = skeleton.mm(22);
  const auto depths = skeleton.survey.depths(height, aside);
  if (!depths) return {aside, height, 0};
  const double fat = skeleton.survey.spot({aside, height, depths->front - skeleton.mm(3)}).fat;
  return {aside, height, depths->front - fat - skeleton.mm(12)};
}

}  // namespace

void add_shoulder_girdle(HumanSkeleton& skeleton, const RibCage& cage) {
  const HumanFrame& frame = skeleton.frame;
  if (!frame.shoulder) return;
  const Vector3d shoulder = frame.shoulder->at;
  const int joint = frame.clavicle ? frame.clavicle->joint : frame.spine_joint(shoulder.y());
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const Vector3d acromion = shoulder + skeleton.mm(4, 34, -8), glenoid = shoulder - skeleton.mm(24, 0, 0);
  const Vector3d sternal = sternal_end(skeleton, (frame.clavicle ? frame.clavicle->at.y() : shoulder.y()) + mm(12));
  const std::vector<ChainLink> clavicle{{sternal, mm(9)},
                                        {sternal + 0.35 * (acromion - sternal) + skeleton.mm(0, 4, 14), mm(6.5)},
                                        {acromion + skeleton.mm(-14, 0, 8), mm(7)}};
  skeleton.add(
      joint, [=](const Spot& spot) { return chain_distance(spot.point, clavicle); }, 4);

  const Vector3d above = behind_cage(skeleton, cage, mm(62), shoulder.y() + mm(40), mm(14));
  const Vector3d below = behind_cage(skeleton, cage, mm(85), shoulder.y() - mm(95), mm(14));
  const Vector3d root = behind_cage(skeleton, cage, mm(60), shoulder.y() + mm(12), mm(17));
  const Vector3d neck = glenoid + skeleton.mm(-14, 0, -6), corner = glenoid + skeleton.mm(-6, 0, -8);
  const Vector3d coracoid[2] = {glenoid + skeleton.mm(-8, 10, 6), glenoid + skeleton.mm(4, 16, 32)};
  const std::vector<ChainLink> spine{
      {root, mm(5)}, {0.5 * (root + acromion) + skeleton.mm(0, 6, -14), mm(8)}, {acromion, mm(9)}};
  const double blade = mm(4.5), rim = mm(15), neck_radius = mm(10), head = mm(24.5);
  const double coracoid_radius[2] = {mm(8), mm(7)};
  const auto scapula = [=](const Spot& spot) {
    const Vector3d& p = spot.point;
    const double socket = std::max(cone_distance(p, glenoid, neck, rim, neck_radius), head - (p - shoulder).norm());
    return std::min({plate_distance(p, above, below, corner, blade), socket, chain_distance(p, spine),
                     cone_distance(p, coracoid[0], coracoid[1], coracoid_radius[0], coracoid_radius[1])});
  };
  skeleton.add(joint, scapula, 5);
  skeleton.landmarks["acromion"] = acromion;
  skeleton.landmarks["glenoid"] = glenoid;
  skeleton.landmarks["sternal_end_of_clavicle"] = sternal;
  skeleton.landmarks["superior_angle_of_scapula"] = above;
  skeleton.landmarks["inferior_angle_of_scapula"] = below;
  skeleton.landmarks["root_of_scapular_spine"] = root;
  skeleton.landmarks["coracoid_process"] = coracoid[1];
}

}  // namespace bodyopt
