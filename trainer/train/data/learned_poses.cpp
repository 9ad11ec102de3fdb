#include "trainer/train/data/learned_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "assets/characters/joints_with_skin.h"
#include "base/content_hash.h"
#include "runtime/core/text.h"

namespace bodyopt::trainer {
namespace {

constexpr std::size_t kDigits = 8;

// Whole steps of 1e-4; no -0.
double in_steps(double value) { return std::round(1e4 * value) + 0.0; }

// Equal for q and -q, which are the same turn: the last of the numbers that is not 0 is positive.
std::array<double, 4> in_steps(const Quat& turn) {
  std::array<double, 4> result{};
  for (std::size_t k = 0; k < 4; ++k) result[k] = in_steps(turn[k]);
  const auto last = std::find_if(result.rbegin(), result.rend(), [](double x) { return x != 0; });
  if (last == result.rend() || *last > 0) return result;
  for (double& x : result) x = 0.0 - x;
  return result;
}

// A control that is 0 says as much as one that the set does not have.
std::string digits_of(const SampleSet& set, const std::vector<std::uint32_t>& joints, const Pose& pose) {
  ContentHash hash;
  for (const std::uint32_t joint : joints) {
    for (const double x : in_steps(pose.own_joints()[joint].rotation)) hash.add(x);
  }
  std::map<std::string, double> controls;
  for (std::size_t k = 0; k < pose.controls.size(); ++k) {
    const double value = in_steps(pose.controls[k]);
    if (value != 0) controls[set.controls[k]] = value;
  }
  for (const auto& [name, value] : controls) {
    hash.add(name);
    hash.add(value);
  }
  return hexadecimal(hash.value()).substr(0, kDigits);
}

}  // namespace

std::string learned_poses_text(const SampleSet& set) {
  const std::vector<std::uint32_t> joints = joints_that_bend(set.character);
  std::vector<std::string> poses;
  for (const Sample& sample : set.train) poses.push_back(digits_of(set, joints, sample.pose));
  std::sort(poses.begin(), poses.end());
  std::string text;
  for (const std::string& digits : poses) text += digits;
  return text;
}

bool tells_learned_poses(const Basis& basis) { return basis.metadata.contains(kLearnedPoses); }

LearnedPoses::LearnedPoses(const Basis& basis, const SampleSet& set)
    : set_(set), joints_(joints_that_bend(set.character)) {
  const auto text = basis.metadata.find(kLearnedPoses);
  if (text == basis.metadata.end()) return;
  for (std::size_t k = 0; k < text->second.size(); k += kDigits) poses_.push_back(text->second.substr(k, kDigits));
}

bool LearnedPoses::has(const Pose& pose) const {
  return !poses_.empty() && std::binary_search(poses_.begin(), poses_.end(), digits_of(set_, joints_, pose));
}

}  // namespace bodyopt::trainer
