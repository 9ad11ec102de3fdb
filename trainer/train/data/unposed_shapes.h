// The training frames in un-posed space, fetched from disk part by part.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/data/stray_vertices.h"
#include "trainer/train/options.h"
#include "trainer/train/regression/components.h"

namespace bodyopt {

struct UnposedFrames {
  Displacements displacements;      // frames x 3 vertices, stray ones put back among their neighbours
  std::vector<StrayVertex> strays;  // by frame and vertex
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

  // Vertices and those beside them, ascending: all it takes to find the stray ones among them.
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
  StrayVertices neighbours_;
};

}  // namespace bodyopt
