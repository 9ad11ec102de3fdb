// Bytes against millimetres: how much of what was learned a basis keeps.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dataset/results.h"
#include "runtime/basis/basis.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/byte_allocation.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt {

std::string curve_text(const std::vector<TradeOffPoint>& curve);
// Of a basis' metadata; none where it was trained without shapes. Throws Error(file) where it is damaged.
std::vector<TradeOffPoint> read_curve(const Basis& basis);

class TradeOff {
 public:
  // `bare`: Direct Delta Mush and all fibres. Both must outlive this.
  TradeOff(const Basis& bare, const ResidualModel& model);

  // What the options ask for: the best within the budget; the smallest within the tolerance, the best there is where
  // that is not to be reached; or what is worth its bytes to most, with all centres, by which coverage knows what was
  // learned, and of few frames (kFewFrames) all that saves anything, with the centres that leave least. Throws
  // Error(usage) where the budget leaves no room for anything learned.
  Selection choose(const TrainOptions& options) const;

  // From Direct Delta Mush alone to all that saves anything.
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

}  // namespace bodyopt
