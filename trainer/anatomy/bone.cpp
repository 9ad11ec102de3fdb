#include "trainer/anatomy/bone.h"

#include <algorithm>

#include "base/parallel.h"

namespace bodyopt {

std::vector<Bone> corrected_bones(const std::vector<Bone>& bones, const HalfBody& body,
                                  const AnatomyCorrections& corrections) {
  std::vector<Bone> result;
  for (const Bone& bone : bones) {
    AnatomyCorrections::OfBone of;
    if (bone.joint >= 0) of = corrections.of_bone(body.joints[static_cast<std::size_t>(bone.joint)].name);
    if (!of.carries.value_or(true)) continue;
    result.push_back(bone);
    if (of.thicker == 0) continue;
    result.back().distance = [distance = bone.distance, thicker = of.thicker](const Spot& spot) {
      return distance(spot) - thicker;
    };
  }
  return result;
}

void find_bone(const BodySurvey& survey, const std::vector<Bone>& bones, InnerTissue& tissue) {
  const std::vector<Spot>& spots = survey.spots();
  tissue.bone.setConstant(static_cast<Eigen::Index>(spots.size()), kFarFromBone);
  tissue.bone_joint.assign(spots.size(), -1);
  parallel_for_short(spots.size(), [&](std::size_t s) {
    double& nearest = tissue.bone[static_cast<Eigen::Index>(s)];
    for (const Bone& bone : bones) {
      const double distance = std::max(bone.distance(spots[s]), bone.cover - spots[s].depth);
      if (distance >= nearest) continue;
      nearest = distance;
      tissue.bone_joint[s] = bone.joint;
    }
  });
}

}  // namespace bodyopt
