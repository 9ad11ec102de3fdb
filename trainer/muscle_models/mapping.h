// Assigns parts of a muscle model to parts of a character: a small file to be edited by hand.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/json_file.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt::trainer::muscle_models {

using NamePair = std::array<std::string, 2>;

// Metres: centres that are nearer to each other do not tell how long a segment is and which way it points.
constexpr double kNearestCentres = 1e-3;

// Segments of the model that one affine map takes to the character.
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

  // If there are some, every muscle is made twice: as it is, and mirrored across the model's median plane.
  std::vector<NamePair> mirror_joints;  // a part of a joint's name, and what stands in its place on the other side
  NamePair mirror_muscles;              // endings added to the muscles' names: this side, other side

  // The joint on the other side; itself where no pair fits.
  std::string mirrored_joint(const std::string& joint) const;
};

// Throws Error(file).
Mapping read_mapping(const std::filesystem::path& path);

// A mapping of muscles that was made for another rig, with the joints of this one.

// A segment whose first two centres go to joints at the same place: fit_muscles() refuses it.
struct UnplacedSegment {
  std::string segment;
  NamePair joints;
};

struct CarriedMapping {
  std::string name;                  // the file's, without folders
  Json json;                         // as the file's, to be written; every segment says where its joint is from
  std::vector<std::string> unknown;  // joints for which this rig has none of the same role: their names stay
  std::vector<UnplacedSegment> unplaced;
};

// Joints are exchanged for those of the same role (joint_roles). Throws Error(file) as read_mapping().
CarriedMapping carried_mapping(const std::filesystem::path& path, const Skeleton& skeleton);

// The mappings of rigs/human that make up a person (gait2392.json, myo_arm.json). Left out are those of which this rig
// has less than half of the joints.
std::vector<CarriedMapping> first_mappings(const Skeleton& skeleton);

}  // namespace bodyopt::trainer::muscle_models
