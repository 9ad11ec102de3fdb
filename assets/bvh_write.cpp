#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "assets/bvh_clip.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

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

class BvhText {
 public:
  BvhText(const Clip& clip, const Skeleton& skeleton) : clip_(clip), skeleton_(skeleton) { text_.precision(9); }

  std::string write() {
    text_ << "HIERARCHY\n";
    add_joint(0, 0);
    text_ << "MOTION\nFrames: " << clip_.poses.size() << "\nFrame Time: " << 1 / clip_.fps << "\n";
    for (const Pose& pose : clip_.poses) add_frame(pose);
    return text_.str();
  }

 private:
  // Those that go elsewhere than they stand at rest, and the root.
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

  void add_joint(std::size_t joint, std::size_t depth) {
    const std::string tabs(depth, '\t'), inner(depth + 1, '\t');
    const Vec3& offset = skeleton_.joints[joint].bind.translation;
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

  void add_frame(const Pose& pose) {
    const char* between = "";
    for (const std::size_t joint : order_) {
      const Vec3& at = pose.joints[joint].translation;
      if (moves_[joint] != 0) {
        text_ << between << at[0] << " " << at[1] << " " << at[2];
        between = " ";
      }
      for (const double angle : zxy_angles(pose.joints[joint].rotation)) {
        text_ << between << angle;
        between = " ";
      }
    }
    text_ << "\n";
  }

  const Clip& clip_;
  const Skeleton& skeleton_;
  std::ostringstream text_;
  std::vector<char> moves_ = moving_joints();
  std::vector<std::size_t> order_;  // of the joints in the file
};

}  // namespace

void write_bvh(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path) {
  const auto roots = std::ranges::count(skeleton.joints, -1, &Joint::parent);
  if (roots != 1 || clip.poses.empty() || !(clip.fps > 0)) {
    throw Error(ErrorKind::file, path.string() +
                                     ": not written; a BVH takes a skeleton with one root and a clip with " +
                                     "frames, there are " + std::to_string(roots) + " roots and " +
                                     std::to_string(clip.poses.size()) + " frames");
  }
  const std::string text = BvhText(clip, skeleton).write();
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace bodyopt
