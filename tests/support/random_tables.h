// Seeded random tables and poses for kernel tests: valid, small, without structure that a bug could hide behind.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt::testing {

inline constexpr std::array<std::uint32_t, 6> kSizes = {0, 1, 63, 64, 65, 1237};
inline constexpr std::array<std::uint32_t, 3> kFrames = {1, 2, 9};  // two groups of kFramesTogether, and one more

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  // The same values on every platform, unlike the standard distributions.
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_() % count); }

  std::vector<float> floats(std::size_t count, double low, double high);
  std::vector<double> partition(std::size_t count);  // `count` weights that sum to 1
  Quat turn(double angle);                           // about any axis, by at most that

 private:
  std::mt19937 engine_;
};

// frames x joints x 12: rigid, turned by at most `angle` radians.
std::vector<float> random_skinning(Random& random, std::uint32_t joints, std::uint32_t frames, double angle);

// Moments of a cloud of twelve points around each vertex, smoothing weights and skin weights random; every block has
// its own list of one to five joints. The last block is filled as far as `vertices` goes.
DdmTable random_ddm(Random& random, std::uint32_t vertices, std::uint32_t joints);

// `fibres` fibres of two to six points over `points` strain vertices (each a vertex of a skin of `vertices`).
StrainTable random_strain(Random& random, std::uint32_t fibres, std::uint32_t points, std::uint32_t vertices);

// Random numbers at the first `lanes` lanes, zeros after them.
BlendEntry random_blend_entry(Random& random, double scale, std::uint32_t coefficient, std::uint32_t lanes);

// A row of halves, two a word.
void append_halves(std::vector<std::uint32_t>& centres, const std::vector<float>& values);

// Number `column` of a row of `width` halves, counted from the row that begins at word `first`.
float half_in(const std::vector<std::uint32_t>& words, std::size_t first, std::size_t width, std::size_t row,
              std::size_t column);

// Value k of a centre of the region, counted from the region's first.
float centre_value(const ResidualTable& table, const Region& region, std::size_t centre, std::size_t k);

// What a coordinate of the region takes of its feature k.
float projection_value(const ResidualTable& table, const Region& region, std::size_t coordinate, std::size_t k);

// Regions over `features` features with one to four coordinates each, `centres` centres and `coefficients` coefficients
// in all; none when there are neither.
ResidualTable random_residual(Random& random, std::uint32_t features, std::uint32_t centres, std::uint32_t coefficients,
                              std::uint32_t vertices);

// Random triangles, two per vertex, the last vertex in none.
MeshTable random_mesh(Random& random, std::uint32_t vertices);

}  // namespace bodyopt::testing
