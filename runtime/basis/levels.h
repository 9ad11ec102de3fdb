// Levels of detail: a character with fewer vertices in one file. Each is an ordinary basis with a skin of its own, and
// says how it carries the full skin.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

constexpr std::size_t kMostLevels = 16;

// A vertex of the full skin on a triangle of a level. The barycentric weights (255 - b - c, b, c) / 255 of its corners
// give a point. From there an offset leads on, the same in every pose, in the frame of runtime/host/carry_skin.h. As
// the offset begins where the rounded weights are, these cost no accuracy.
struct CarriedPoint {
  std::uint32_t triangle = 0;               // of the level's mesh.output_triangles
  std::uint8_t b = 0, c = 0;                // sum 255 at most
  std::int16_t along_normal = 0;            // steps
  std::int16_t along_edge = 0, across = 0;  // steps
};
static_assert(sizeof(CarriedPoint) == 12);

struct CarriedSkin {
  std::vector<CarriedPoint> points;  // of every output vertex of the full character
  float step = 0;                    // of the offsets, metres

  bool empty() const { return points.empty(); }
  std::size_t size() const { return points.size(); }
  std::size_t bytes() const { return points.size() * sizeof(CarriedPoint); }
};

struct Level {
  Basis basis;
  CarriedSkin carried;  // empty in an ordinary basis
};

// Checks each basis, every number of the maps, and that the levels are of one character: the same skeleton, controls
// and number of carried points. Throws Error(file) whose text starts with `origin`.
void validate(const std::vector<Level>& levels, const std::string& origin);

// A file of levels, finest first: load_basis() of it gives the first. What is measured of them is the metadata "levels"
// of the first (docs/formats.md). Throws Error(file).
void save_levels(const std::vector<Level>& levels, const std::filesystem::path& path);
// The path of a basis' lighter levels: hero.proxy.safetensors beside hero.safetensors.
std::filesystem::path proxy_beside(std::filesystem::path basis);
// An ordinary basis gives itself alone.
std::vector<Level> load_levels(const std::filesystem::path& path);

}  // namespace bodyopt
