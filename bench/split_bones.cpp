#include "bench/split_bones.h"

#include <algorithm>

#include "runtime/host/rig.h"

namespace bodyopt::bench {
namespace {

Eigen::Vector3d place_of(const Affine& joint) { return {joint.m[0][3], joint.m[1][3], joint.m[2][3]}; }

// How far along a bone a point lies: 0 at its beginning, 1 at its end.
double along(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, const Eigen::Vector3d& point) {
  const Eigen::Vector3d bone = end - begin;
  return std::clamp((point - begin).dot(bone) / bone.squaredNorm(), 0.0, 1.0);
}

void share_weights(Character& character, std::uint32_t from, std::uint32_t to, const Eigen::Vector3d& begin,
                   const Eigen::Vector3d& end) {
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    std::vector<JointWeight>& weights = character.weights[v];
    const auto own = std::find_if(weights.begin(), weights.end(), [&](const auto& w) { return w.joint == from; });
    if (own == weights.end()) continue;
    const auto part = static_cast<decltype(own->weight)>(
        along(begin, end, character.vertices.row(static_cast<Eigen::Index>(v)).transpose()));
    JointWeight taken = *own;
    own->weight *= 1 - part;
    taken.joint = to;
    taken.weight *= part;
    if (taken.weight > 0) weights.push_back(taken);
    std::erase_if(weights, [](const JointWeight& w) { return !(w.weight > 0); });
    std::sort(weights.begin(), weights.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  }
}

}  // namespace

Character split_bones(Character character) {
  Skeleton& skeleton = character.skeleton;
  std::vector<Affine> places;
  for (const Joint& joint : skeleton.joints) places.push_back(inverse(joint.inverse_bind));
  const std::size_t count = skeleton.size();
  std::vector<bool> split(count, false);
  for (std::size_t child = 0; child < count; ++child) {
    const int parent = skeleton.joints[child].parent;
    if (parent < 0 || split[static_cast<std::size_t>(parent)]) continue;
    split[static_cast<std::size_t>(parent)] = true;
    const Affine& at = places[static_cast<std::size_t>(parent)];
    const Eigen::Vector3d begin = place_of(at), end = place_of(places[child]);
    if (!((end - begin).norm() > 1e-6)) continue;
    Joint middle = skeleton.joints[static_cast<std::size_t>(parent)];
    middle.name += "_middle";
    middle.parent = parent;
    middle.bind = middle.default_local = JointTransform{};
    const Eigen::Vector3d shift = 0.5 * (end - begin);
    // Its axes are its parent's.
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) middle.bind.translation[static_cast<std::size_t>(i)] += at.m[k][i] * shift[k];
    }
    middle.default_local = middle.bind;
    Affine place = at;
    for (int i = 0; i < 3; ++i) place.m[i][3] += shift[i];
    middle.inverse_bind = inverse(place);
    skeleton.joints.push_back(middle);
    share_weights(character, static_cast<std::uint32_t>(parent), static_cast<std::uint32_t>(skeleton.size() - 1), begin,
                  end);
  }
  return character;
}

}  // namespace bodyopt::bench
