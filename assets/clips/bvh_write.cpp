#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "assets/clips/axis_turns.h"
#include "assets/clips/bvh_clip.h"
#include "base/wording.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt {
namespace {

// Degrees about z, x, y: the rotation is Rz Rx Ry.
Vec3 zxy_angles(const Quat& rotation) {
  const auto r = rotation_matrix(normalized(rotation));
  const double x = std::asin(std::clamp(r[2][1], -1.0, 1.0));
  const bool locked = std::abs(r[2][1]) > 1 - 1e-12;  // z and y turn about one axis: all of it is given to z
  const double z = locked ? std::atan2(r[1][0], r[0][0]) : std::atan2(-r[0][1], r[1][1]);
  const double y = locked ? 0 : std::atan2(-r[2][0], r[2][2]);
  const double degrees = 180 / std::numbers::pi;
  return {degrees * z, degrees * x, degrees * y};
}

// The bind pose, stood upright as a whole.
Pose standing_pose(const Skeleton& skeleton) {
  Pose pose = bind_pose(skeleton);
  const Quat upright = turn_upright(skeleton);
  JointTransform& root = pose.joints[0];
  root.translation = rotate(upright, root.translation);
  root.rotation = upright * root.rotation;
  return pose;
}

Vec3 linear_part_times(const Affine& a, const Vec3& displacement) { return a * displacement - a * Vec3{0, 0, 0}; }

class BvhText {
 public:
  BvhText(const Clip& clip, const Skeleton& skeleton)
      : clip_(clip),
        skeleton_(skeleton),
        rest_(posed_joints(skeleton, standing_pose(skeleton).joints)),
        rest_rotation_(world_rotations(skeleton, standing_pose(skeleton))) {
    text_.precision(9);
  }

  std::string write() {
    text_ << "HIERARCHY\n";
    add_joint(0, 0);
    text_ << "MOTION\nFrames: " << clip_.poses.size() << "\nFrame Time: " << 1 / clip_.fps << "\n";
    for (const Pose& pose : clip_.poses) add_frame(pose);
    return text_.str();
  }

 private:
  // Marks the root, and joints that move from where they are at rest.
  std::vector<char> moving_joints() const {
    std::vector<char> moves(skeleton_.size(), 0);
    for (std::size_t joint = 0; joint < moves.size(); ++joint) {
      moves[joint] = joint == 0 || std::ranges::any_of(clip_.poses, [&](const Pose& pose) {
                       return pose.joints[joint].translation != skeleton_.joints[joint].bind.translation;
                     });
    }
    return moves;
  }

  static std::string token(std::string name) {
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isspace(c) != 0; }, '_');
    return name.empty() ? "_" : name;
  }

  // The offset from the parent at rest, in the world's axes.
  Vec3 offset_of(std::size_t joint) const {
    const Vec3 place = rest_[joint] * Vec3{0, 0, 0};
    const int parent = skeleton_.joints[joint].parent;
    return parent < 0 ? place : place - rest_[static_cast<std::size_t>(parent)] * Vec3{0, 0, 0};
  }

  void add_joint(std::size_t joint, std::size_t depth) {
    const std::string tabs(depth, '\t'), inner(depth + 1, '\t');
    const Vec3 offset = offset_of(joint);
    order_.push_back(joint);
    text_ << tabs << (depth == 0 ? "ROOT " : "JOINT ") << token(skeleton_.joints[joint].name) << "\n"
          << tabs << "{\n"
          << inner << "OFFSET " << offset[0] << " " << offset[1] << " " << offset[2] << "\n"
          << inner << (moves_[joint] != 0 ? "CHANNELS 6 Xposition Yposition Zposition " : "CHANNELS 3 ")
          << "Zrotation Xrotation Yrotation\n";
    bool ends = true;
    for (std::size_t child = joint + 1; child < skeleton_.size(); ++child) {
      if (skeleton_.joints[child].parent != static_cast<int>(joint)) continue;
      add_joint(child, depth + 1);
      ends = false;
    }
    if (ends) text_ << inner << "End Site\n" << inner << "{\n" << inner << "\tOFFSET 0 0 0\n" << inner << "}\n";
    text_ << tabs << "}\n";
  }

  // The joint's place in the pose, as a position channel gives it.
  Vec3 position(const Pose& pose, std::size_t joint) const {
    const int parent = skeleton_.joints[joint].parent;
    const Vec3& at = pose.joints[joint].translation;
    if (parent < 0) return at;
    const Vec3 moved = at - skeleton_.joints[joint].bind.translation;
    return offset_of(joint) + linear_part_times(rest_[static_cast<std::size_t>(parent)], moved);
  }

  void add_frame(const Pose& pose) {
    std::vector<Quat> away = world_rotations(skeleton_, pose);  // from rest
    for (std::size_t joint = 0; joint < away.size(); ++joint) {
      away[joint] = away[joint] * conjugate(rest_rotation_[joint]);
    }
    const char* between = "";
    for (const std::size_t joint : order_) {
      if (moves_[joint] != 0) {
        const Vec3 at = position(pose, joint);
        text_ << between << at[0] << " " << at[1] << " " << at[2];
        between = " ";
      }
      const int parent = skeleton_.joints[joint].parent;
      const Quat own = parent < 0 ? away[joint] : conjugate(away[static_cast<std::size_t>(parent)]) * away[joint];
      for (const double angle : zxy_angles(own)) {
        text_ << between << angle;
        between = " ";
      }
    }
    text_ << "\n";
  }

  const Clip& clip_;
  const Skeleton& skeleton_;
  std::vector<Affine> rest_;         // per joint, world
  std::vector<Quat> rest_rotation_;  // per joint, world
  std::ostringstream text_;
  std::vector<char> moves_ = moving_joints();
  std::vector<std::size_t> order_;  // of the joints in the file
};

// How far a joint, or what is one length from it in any of its axes, lies from where it should, metres.
double distance_between(const Affine& a, const Affine& b, double length_of_axes) {
  double largest = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const double apart = std::abs(a.m[row][column] - b.m[row][column]);
      largest = std::max(largest, column < 3 ? length_of_axes * apart : apart);
    }
  }
  return largest;
}

// The distance from the first to the farthest joint at rest, metres.
double size_of(const Skeleton& skeleton) {
  const std::vector<Affine> rest = posed_joints(skeleton, bind_pose(skeleton).joints);
  double size = 0;
  for (const Affine& joint : rest) size = std::max(size, length(joint * Vec3{0, 0, 0} - rest[0] * Vec3{0, 0, 0}));
  return size;
}

// The text, read again, must give the pose of every frame.
void check_read_back(const std::string& text, const Clip& clip, const Skeleton& skeleton,
                     const std::filesystem::path& path) {
  constexpr double kSame = 1e-4;  // of the character's size
  const auto itself = [&](const auto&) { return skeleton; };
  const Clip again = carry_bvh(parse_bvh(text, path), path, itself, {.fps = clip.fps});
  const double size = size_of(skeleton);
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const std::vector<Affine> meant = posed_joints(skeleton, clip.poses[k].joints),
                              found = posed_joints(skeleton, again.poses.at(k).joints);
    for (std::size_t joint = 0; joint < meant.size(); ++joint) {
      const double apart = distance_between(meant[joint], found[joint], 0.1 * size);
      if (apart <= kSame * size) continue;
      throw Error(ErrorKind::file, path, ": not written; read again, the joint '", skeleton.joints[joint].name,
                  "' would be off by ", rounded(1e3 * apart), " mm in frame ", clip.first_frame + static_cast<int>(k),
                  ": a BVH holds no scale of joints, and no blanks in their names. Write a .glb");
    }
  }
}

}  // namespace

void write_bvh(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path) {
  const auto roots = std::ranges::count(skeleton.joints, -1, &Joint::parent);
  if (roots != 1 || clip.poses.empty() || !(clip.fps > 0)) {
    throw Error(ErrorKind::file, path,
                ": not written; a BVH takes a skeleton with one root and a clip with frames, there are ", roots,
                " roots and ", clip.poses.size(), " frames");
  }
  const std::string text = BvhText(clip, skeleton).write();
  check_read_back(text, clip, skeleton, path);
  write_file_atomically(path, text);
}

}  // namespace bodyopt
