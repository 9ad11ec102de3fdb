#include "trainer/train/features/learned_features.h"

#include "assets/joints_with_skin.h"
#include "runtime/host/rig.h"

namespace bodyopt {

std::vector<JointFeatures> learned_features(const Character& character) {
  const std::vector<bool> of_all_skin = joints_of_all_skin(character);
  const std::vector<JointFeatures> usual = joint_features_of(character.skeleton);
  std::vector<JointFeatures> features = usual;
  for (JointFeatures& of : features) {
    if (of_all_skin[of.joint]) of.above = of.joint;
  }
  return features == usual ? std::vector<JointFeatures>{} : features;
}

}  // namespace bodyopt
