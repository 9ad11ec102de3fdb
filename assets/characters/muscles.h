// muscles.json: named muscles as polylines bound to joints.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

struct MusclePoint {
  std::uint32_t joint;  // the point moves rigidly with this joint
  Vec3 position;        // rest space, metres
};

struct Muscle {
  std::string name;
  std::vector<MusclePoint> path;  // origin, via points, insertion; 2 or more
  double radius = 0.02;           // metres, at the belly
  int fibre_count = 3;            // fibres projected on the skin
  double max_activation = 1;      // 0..1
};

// Points are stored by joint name. Throws Error(file) for bad bytes, Error(mismatch) for joints the skeleton lacks.
std::vector<Muscle> read_muscles(const std::filesystem::path& path, const Skeleton& skeleton);
// Parses a file's text that is in memory already; messages call it `path`.
std::vector<Muscle> parse_muscles(std::string_view text, const std::filesystem::path& path, const Skeleton& skeleton);
void write_muscles(const std::vector<Muscle>& muscles, const Skeleton& skeleton, const std::filesystem::path& path);

// Throws Error(mismatch) for a skeleton without joints, and a radius that is not above 0. It also does for a path of
// fewer than two points, or bound to a joint that the skeleton lacks.
void require_fit(const std::vector<Muscle>& muscles, const Skeleton& skeleton);

}  // namespace bodyopt
