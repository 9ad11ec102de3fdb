// Levels of detail: light twins of a character in one file, each an ordinary basis with a skin of its own, and how each
// carries the full skin.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

constexpr std::size_t kMostLevels = 16;

// A vertex of the full skin on a triangle of a level: the point at the barycentric weights (1 - b - c, b, c) of its
// corners, and from there, in the frame of runtime/carry_skin.h, an offset that is the same in every pose.
struct CarriedPoint {
  std::uint32_t triangle = 0;        // of the level's mesh.output_triangles
  float b = 0, c = 0;                // >= 0, sum 1 at most
  float along_normal = 0;            // metres
  float along_edge = 0, across = 0;  // metres
};

struct Level {
  Basis basis;
  std::vector<CarriedPoint> carried;  // of every output vertex of the full character; empty in an ordinary basis
};

// Checks each basis, every number of the maps, and that the levels are of one character: the same skeleton, controls
// and number of carried points. Throws Error(file) whose text starts with `origin`.
void validate(const std::vector<Level>& levels, const std::string& origin);

// A file of levels, finest first: load_basis() of it gives the first. What is measured of them is the metadata "levels"
// of the first (docs/formats.md). Throws Error(file).
void save_levels(const std::vector<Level>& levels, const std::filesystem::path& path);
// Of an ordinary basis: itself alone.
std::vector<Level> load_levels(const std::filesystem::path& path);

}  // namespace bodyopt
