#include "trainer/train/data/learned_poses.h"

#include <algorithm>
#include <map>

#include "base/content_hash.h"
#include "runtime/core/hexadecimal.h"

namespace bodyopt {
namespace {

constexpr std::size_t kDigits = 8;

// A control that is 0 says as much as one that the set does not have.
std::string digits_of(const SampleSet& set, const Pose& pose) {
  ContentHash hash;
  for (const JointTransform& joint : pose.own_joints()) hash.add(joint);
  std::map<std::string, float> controls;
  for (std::size_t k = 0; k < pose.controls.size(); ++k) {
    if (pose.controls[k] != 0) controls[set.controls[k]] = pose.controls[k];
  }
  for (const auto& [name, value] : controls) {
    hash.add(name);
    hash.add(double{value});
  }
  return hexadecimal(hash.value()).substr(0, kDigits);
}

}  // namespace

std::string learned_poses_text(const SampleSet& set) {
  std::vector<std::string> poses;
  for (const Sample& sample : set.train) poses.push_back(digits_of(set, sample.pose));
  std::sort(poses.begin(), poses.end());
  std::string text;
  for (const std::string& digits : poses) text += digits;
  return text;
}

LearnedPoses::LearnedPoses(const Basis& basis) {
  const auto text = basis.metadata.find(kLearnedPoses);
  if (text == basis.metadata.end()) return;
  for (std::size_t k = 0; k < text->second.size(); k += kDigits) poses_.push_back(text->second.substr(k, kDigits));
}

bool LearnedPoses::has(const SampleSet& set, const Pose& pose) const {
  return !poses_.empty() && std::binary_search(poses_.begin(), poses_.end(), digits_of(set, pose));
}

}  // namespace bodyopt
