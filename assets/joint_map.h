// joint_map.json: which joint of a clip's file moves which joint of the character, where names do not tell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt {

struct MappedJoint {
  std::string from, to;  // of the clip's file, of the character
};

// Each joint of either side once. Throws Error(file).
std::vector<MappedJoint> read_joint_map(const std::filesystem::path& path);

}  // namespace bodyopt
