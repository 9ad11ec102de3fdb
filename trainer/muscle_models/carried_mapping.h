// A mapping of muscles that was made for another rig, with the joints of this one.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "assets/json_file.h"
#include "runtime/basis/skeleton.h"
#include "trainer/muscle_models/mapping.h"

namespace bodyopt::muscle_models {

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

// Those of rigs/human that make up a person (gait2392.json, myo_arm.json), each of which this rig has half of the
// joints for, at least.
std::vector<CarriedMapping> first_mappings(const Skeleton& skeleton);

}  // namespace bodyopt::muscle_models
