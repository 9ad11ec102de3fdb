// Which parts of a residual get the bytes: those that save the most error for each.
//
// A blend entry (a component in a block of vertices) saves what its component takes off the mean square error in
// cross-validation, times the squared length of the component's vectors in the block. An entry for its rounding saves
// the coefficient's mean square times the squared length of what rounding left. Each costs its record; a component
// costs its row of weights besides, a region its features and centres. At a price per byte, an entry is kept that saves
// more than it costs, a component whose entries save more than they and its row cost, a region whose components save
// more than all of it costs, with the centres that leave most over: for what this takes, nothing saves more (Everett
// 1963, generalised Lagrange multipliers). The higher the price, the fewer the bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "trainer/train/pack/residual.h"

namespace bodyopt {

class ByteAllocation {
 public:
  explicit ByteAllocation(const ResidualModel& model);

  // What is kept at a price per byte, in mean squared displacements of a vertex.
  Selection at(double price) const;
  // The same, but every region with all its centres.
  Selection with_all_centres(double price) const;

 private:
  struct Entry {
    std::uint32_t block;
    double saved, fine_saved;  // square metres
  };
  // A region with one of its fits.
  struct Candidate {
    std::vector<std::vector<Entry>> components;
    double bytes, component_bytes;  // of the region itself; of each component without its entries
  };
  static Candidate candidate(const RegionModel& region, const Regression& fit, const std::vector<Eigen::Index>& frames);
  struct Bid {
    SelectedRegion region;
    double gain;  // square metres, what is saved less the price
  };
  static Bid bid(const Candidate& candidate, double per_byte);
  Selection best(double price, std::size_t most_fits) const;

  std::vector<std::vector<Candidate>> regions_;  // by fit
  double vertex_motion_ = 0;                     // square metres, mean over vertices and frames
};

}  // namespace bodyopt
