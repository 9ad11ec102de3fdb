// Vertices that fly away from their neighbours in single frames: slips of a solver or a scanner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/character.h"
#include "trainer/train/regression/components.h"

namespace bodyopt {

struct StrayVertex {
  std::size_t frame = 0;     // index of the training frame
  std::uint32_t vertex = 0;  // runtime order
  double distance = 0;       // metres, between its displacement and that of its neighbours
};

// Tells a vertex that flew away from a skin that folds: what its neighbours do is their median displacement, and a
// stray one is further from it than the neighbours are from each other, than this vertex is in other frames, and than
// the skin's details are wide.
class StrayVertices {
 public:
  // `character`: in runtime order.
  explicit StrayVertices(const Character& character);

  // Replaces the displacements (frames x 3 vertices) of stray vertices by what their neighbours do, and returns them,
  // by frame and vertex. `vertices`: those of the columns, ascending; one with fewer than three neighbours, or some
  // that are not among the columns, is never stray. It takes many frames to know what is usual.
  std::vector<StrayVertex> mend(Displacements& displacements, std::span<const std::size_t> frames,
                                std::span<const std::uint32_t> vertices) const;

  // Ascending.
  std::vector<std::uint32_t> with_neighbours(const std::vector<std::uint32_t>& vertices) const;

 private:
  double size_;                                         // longest extent, metres
  std::vector<std::vector<std::uint32_t>> neighbours_;  // V
};

}  // namespace bodyopt
