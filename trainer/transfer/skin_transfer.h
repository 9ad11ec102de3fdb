// Un-posed displacements of one character's skin, carried to another's.
#pragma once

#include "runtime/basis/basis.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/deformation_transfer.h"
#include "trainer/transfer/smooth_fill.h"

namespace bodyopt {

// Deformation transfer from the source's rest skin to the same triangles laid onto the target; from these to the
// target's vertices; where the correspondence is unsure filled in smoothly (harmonically) from around; turned from the
// common pose to the target's own rest. Linear; zero of zero.
class SkinTransfer {
 public:
  SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence, TransferSize size);

  // V x 3, runtime order of the source, to V' x 3, runtime order of the target; metres, un-posed. On any thread.
  Positions operator()(const Positions& displacements) const;

  // Of the target's skin, runtime order, where the correspondence is unsure.
  const SmoothFill& fill() const { return fill_; }
  Eigen::Index unsure() const { return static_cast<Eigen::Index>(fill_.unknown().size()); }  // vertices filled in

 private:
  const Correspondence& correspondence_;
  DeformationTransfer transfer_;
  SmoothFill fill_;
};

}  // namespace bodyopt
