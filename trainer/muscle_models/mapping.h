// Which part of a muscle model is which part of a character: a small file to be edited by hand.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt::muscle_models {

using NamePair = std::array<std::string, 2>;

// Metres: centres that are nearer to each other do not tell how long a segment is and which way it points.
constexpr double kNearestCentres = 1e-3;

// Segments of the model that are carried to the character by one affine map.
struct SegmentMap {
  std::vector<std::string> segments;
  std::string joint;              // of the character: their points move with it
  std::vector<NamePair> centres;  // segment whose joint centre is meant, joint of the character it goes to
};

struct Mapping {
  std::string file;
  // Unit axes that correspond: columns up, forward, and their cross product.
  Eigen::Matrix3d model_axes, character_axes;
  std::vector<SegmentMap> segments;    // nearer to the trunk first
  std::vector<std::string> leave_out;  // muscles

  // Where not empty, every muscle is made twice: as it is, and mirrored across the model's median plane.
  std::vector<NamePair> mirror_joints;  // a part of a joint's name, and what stands in its place on the other side
  NamePair mirror_muscles;              // endings added to the muscles' names: this side, other side

  // The joint on the other side; itself where no pair fits.
  std::string mirrored_joint(const std::string& joint) const;
};

// Throws Error(file).
Mapping read_mapping(const std::filesystem::path& path);

}  // namespace bodyopt::muscle_models
