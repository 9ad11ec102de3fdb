// Bytes against millimetres: how much of what was learned a basis keeps.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/basis.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

// Gives the bytes to the parts of a residual that save the most error for each.
//
// A blend entry is a component in a block of vertices. It saves what its component takes off the mean square error in
// cross-validation, times the squared length of the component's vectors there. An entry for its rounding saves the
// coefficient's mean square times the squared length of what rounding left. Each costs its record; a component costs
// its row of weights besides, a region its features and centres. At a price per byte, an entry is kept that saves more
// than it costs. So is a component whose entries save more than they and its row cost. So is a region whose components
// save more than all of it costs, with the centres that leave most over. For what this takes, nothing saves more
// (Everett 1963, generalised Lagrange multipliers). The higher the price, the fewer the bytes.
class ByteAllocation {
 public:
  explicit ByteAllocation(const ResidualModel& model);

  // The selection kept at a price per byte, in mean squared displacements of a vertex.
  Selection at(double price) const;
  // Does so, but keeps all centres of every region.
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

// Root mean square (metres) of what a selection leaves of the displacements, over the vertices and at most 400 frames
// that cross-validation held out. An estimate: rounding to bytes is taken to cost nothing. The motion that no component
// of a region holds is taken to agree with that of the regions it overlaps.
double expected_error(const ResidualModel& model, const Selection& selection);

// The error that is left of one region in every frame, square metres over its vertices. `fit`: of the region, its
// errors of frames held out; without prediction errors where no fold held out.
std::vector<double> frame_energies(const RegionModel& region, const SelectedRegion& selected, const Regression& fit);

std::string curve_text(const std::vector<TradeOffPoint>& curve);
// Reads a basis' metadata; none where it was trained without shapes. Throws Error(file) where it is damaged.
std::vector<TradeOffPoint> read_curve(const Basis& basis);

class TradeOff {
 public:
  // `bare`: Direct Delta Mush and all fibres. Both must outlive this.
  TradeOff(const Basis& bare, const ResidualModel& model);

  // Chooses the best within the budget, or the smallest within the tolerance, or the best there is where that is not to
  // be reached. With neither it is what is worth its bytes to most, with all centres, by which coverage knows what was
  // learned. Of few frames (kFewFrames) it is all that saves anything, with the centres that leave least. Throws
  // Error(usage) where the budget leaves no room for anything learned.
  Selection choose(const TrainOptions& options) const;

  // Points from Direct Delta Mush alone to all that saves anything.
  std::vector<TradeOffPoint> curve() const;

 private:
  struct Bracket {
    double below, above;
  };
  // The prices between which `holds` turns from false to true; twice the lowest where it holds there.
  Bracket turn_of(const std::function<bool(const Selection&)>& holds) const;
  Selection within(double budget) const;

  const Basis& bare_;
  const ResidualModel& model_;
  ByteAllocation allocation_;
  double highest_;  // price, at which nothing is kept
};

// Residual and strains of a selection. `basis`: Direct Delta Mush and all fibres.
PackedResidual pack_into(Basis& basis, const ResidualModel& model, const Selection& selection);

double bytes_per_vertex(const Basis& basis);

// Refuses a budget below the bytes that are the least: `what` takes them.
[[noreturn]] void refuse_budget(double budget, double least, const std::string& what);

}  // namespace bodyopt::trainer
