#include "tests/support/stand_in_human.h"

#include <algorithm>
#include <map>
#include <utility>

#include "runtime/host/rig.h"
#include "tests/support/shared_data.h"
#include "trainer/builtin/march.h"

namespace bodyopt {
namespace {

// A joint of the left side or the middle, and how thick the body is on the way there from its parent.
struct StandInJoint {
  const char *name, *parent;
  Vec3 place;     // metres, the left is +x, up +y, forwards +z
  double radius;  // 0: no flesh
};

constexpr StandInJoint kStandInJoints[] = {{"Hips", "", {0, 0.95, 0}, 0},
                                           {"LHipJoint", "Hips", {0, 0.95, 0}, 0},
                                           {"LeftUpLeg", "LHipJoint", {0.1, 0.88, 0}, 0.1},
                                           {"LeftLeg", "LeftUpLeg", {0.14, 0.5, 0.01}, 0.075},
                                           {"LeftFoot", "LeftLeg", {0.17, 0.09, -0.02}, 0.055},
                                           {"LeftToeBase", "LeftFoot", {0.19, 0.05, 0.12}, 0.045},
                                           {"LowerBack", "Hips", {0, 1.0, 0}, 0.13},
                                           {"Spine", "LowerBack", {0, 1.1, 0}, 0.13},
                                           {"Spine1", "Spine", {0, 1.25, 0}, 0.14},
                                           {"LeftShoulder", "Spine1", {0.03, 1.42, 0}, 0.09},
                                           {"LeftArm", "LeftShoulder", {0.2, 1.42, 0}, 0.06},
                                           {"LeftForeArm", "LeftArm", {0.38, 1.2, 0}, 0.05},
                                           {"LeftHand", "LeftForeArm", {0.55, 1.02, 0.08}, 0.04},
                                           {"LThumb", "LeftHand", {0.58, 0.98, 0.15}, 0.02},
                                           {"LeftFingerBase", "LeftHand", {0.6, 0.96, 0.1}, 0.03},
                                           {"LeftHandFinger1", "LeftFingerBase", {0.65, 0.9, 0.12}, 0.025},
                                           {"Neck", "Spine1", {0, 1.48, 0}, 0.06},
                                           {"Neck1", "Neck", {0, 1.54, 0.01}, 0.06},
                                           {"Head", "Neck1", {0, 1.62, 0.02}, 0.1}};

// The name on the other side, or the same: "LeftArm" is "RightArm", "LThumb" "RThumb".
std::string right_of(const std::string& name) {
  if (name.starts_with("Left")) return "Right" + name.substr(4);
  return name.starts_with("LHip") || name.starts_with("LThumb") ? "R" + name.substr(1) : name;
}

// Joints by the names that the human rig has (rigs/human). The bones of the right side do not mirror the left's: each
// is turned about by some angle of its own, as in files of other programs.
Skeleton stand_in_skeleton() {
  Skeleton skeleton;
  std::vector<Affine> world;
  const auto add = [&](const std::string& name, const std::string& parent, const Vec3& place) {
    Joint joint;
    joint.name = name;
    joint.parent = skeleton.find(parent);
    Affine bind =
        affine_from({place, axis_angle({0.6, 0, 0.8}, 0.3 * static_cast<double>(skeleton.size())), {1, 1, 1}});
    joint.inverse_bind = inverse(bind);
    joint.bind = decompose(joint.parent < 0 ? bind : inverse(world[static_cast<std::size_t>(joint.parent)]) * bind);
    joint.default_local = joint.bind;
    world.push_back(bind);
    skeleton.joints.push_back(joint);
  };
  for (const StandInJoint& joint : kStandInJoints) add(joint.name, joint.parent, joint.place);
  for (const StandInJoint& joint : kStandInJoints) {
    const std::string name = right_of(joint.name);
    if (name != joint.name) add(name, right_of(joint.parent), {-joint.place[0], joint.place[1], joint.place[2]});
  }
  return skeleton;
}

// The parts of the body, each with the joint whose bone it lies on.
std::vector<std::pair<std::uint32_t, RoundedPart>> stand_in_flesh(const Skeleton& skeleton) {
  std::map<std::string, double> radius;
  for (const StandInJoint& joint : kStandInJoints) radius[joint.name] = radius[right_of(joint.name)] = joint.radius;
  const auto at = [&](std::size_t j) {
    const Vec3 p = bind_place(skeleton, j);
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  std::vector<std::pair<std::uint32_t, RoundedPart>> flesh;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const double thick = radius.at(skeleton.joints[j].name);
    if (thick == 0) continue;
    flesh.emplace_back(parent, limb(at(static_cast<std::size_t>(parent)), at(j), thick, thick, 0.02));
  }
  return flesh;
}

}  // namespace

Character stand_in_human() {
  Character human;
  human.name = "stand-in";
  human.skeleton = stand_in_skeleton();
  const auto flesh = stand_in_flesh(human.skeleton);
  std::vector<RoundedPart> parts;
  for (const auto& [joint, part] : flesh) parts.push_back(part);
  const Solid solid(parts);
  const Surface skin = remesh(
      march(solid, {-0.8, -0.1, -0.3}, {0.8, 1.8, 0.3}, 0.02, 0),
      [&](const Eigen::Vector3d& point) { return solid.project(point); }, [](const Eigen::Vector3d&) { return 0.025; },
      6);
  human.vertices.resize(static_cast<Eigen::Index>(skin.points.size()), 3);
  human.triangles.resize(static_cast<Eigen::Index>(skin.triangles.size()), 3);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      human.triangles(static_cast<Eigen::Index>(t), k) =
          static_cast<std::uint32_t>(skin.triangles[t][static_cast<std::size_t>(k)]);
    }
  }
  human.output_triangles = human.triangles;
  for (std::size_t v = 0; v < skin.points.size(); ++v) {
    human.vertices.row(static_cast<Eigen::Index>(v)) = skin.points[v];
    const auto nearest = std::ranges::min_element(
        flesh, {}, [&](const auto& part) { return Solid({part.second}).distance(skin.points[v]); });
    human.weights.push_back({{nearest->first, 1.0}});
    human.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  return human;
}

std::vector<Character> humans(const std::string& file) {
  std::vector<Character> characters{stand_in_human()};
  if (const auto path = shared_data(file)) characters.push_back(read_character(*path));
  return characters;
}

}  // namespace bodyopt
