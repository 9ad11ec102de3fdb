// The training frames in un-posed space, fetched from disk part by part.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {

// Vertices that fly away from their neighbours in single frames: slips of a solver or a scanner.

struct OutlierVertex {
  std::size_t frame = 0;     // index of the training frame
  std::uint32_t vertex = 0;  // runtime order
  double distance = 0;       // metres, between its displacement and that of its neighbours
};

// Distinguishes a vertex that flew away from a skin that folds. What its neighbours do is their median displacement. An
// outlier is further from it than the neighbours are from each other, and than this vertex is in other frames. It is
// further, too, than the skin's details are wide.
class OutlierVertices {
 public:
  // `character`: in runtime order.
  explicit OutlierVertices(const Character& character);

  // Replaces the displacements (frames x 3 vertices) of outliers by what their neighbours do, and returns them,
  // by frame and vertex. `vertices`: those of the columns, ascending; one with fewer than three neighbours, or some
  // that are not among the columns, is never an outlier. It takes many frames to know what is usual.
  std::vector<OutlierVertex> mend(Displacements& displacements, std::span<const std::size_t> frames,
                                  std::span<const std::uint32_t> vertices) const;

  // Ascending.
  std::vector<std::uint32_t> with_neighbours(const std::vector<std::uint32_t>& vertices) const;

 private:
  double size_;                                         // longest extent, metres
  std::vector<std::vector<std::uint32_t>> neighbours_;  // V
};

struct UnposedFrames {
  Displacements displacements;          // frames x 3 vertices, outliers put back among their neighbours
  std::vector<OutlierVertex> outliers;  // by frame and vertex
};

class UnposedShapes {
 public:
  // `ordered`: the character in runtime order; `order`: welded vertex of each runtime vertex. All must outlive this.
  UnposedShapes(const SampleSet& set, const Character& ordered, const Basis& basis,
                const std::vector<std::uint32_t>& order, Method::Unposing unposing)
      : set_(set), ordered_(ordered), basis_(basis), order_(order), unposing_(unposing), neighbours_(ordered) {}

  // Some vertices (runtime order, ascending) in some frames (indices of the set's training frames). Shows progress
  // under a title. Throws Error(mismatch) naming a frame whose shape does not fit the character or is not finite,
  // Error(file) one whose shape cannot be read.
  UnposedFrames operator()(const std::string& title, std::span<const std::size_t> frames,
                           std::span<const std::uint32_t> vertices) const;

  // Vertices and those beside them, ascending: all it takes to find the outliers among them.
  std::vector<std::uint32_t> with_neighbours(const std::vector<std::uint32_t>& vertices) const {
    return neighbours_.with_neighbours(vertices);
  }
  std::uint32_t vertex_count() const { return basis_.mesh.vertex_count(); }

 private:
  const SampleSet& set_;
  const Character& ordered_;
  const Basis& basis_;
  const std::vector<std::uint32_t>& order_;
  Method::Unposing unposing_;
  OutlierVertices neighbours_;
};

}  // namespace bodyopt::trainer
