// Un-posed displacements of one character's skin, carried to another's.
#pragma once

#include "runtime/basis/basis.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/deformation_transfer.h"

namespace bodyopt {

// Deformation transfer from the source's rest skin to the same triangles laid onto the target; from these to the
// target's vertices; where the correspondence is unsure filled in smoothly (harmonically) from around; turned from the
// common pose to the target's own rest. Linear; zero of zero.
class SkinTransfer {
 public:
  SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence, TransferSize size);

  // V x 3, runtime order of the source, to V' x 3, runtime order of the target; metres, un-posed. On any thread.
  Positions operator()(const Positions& displacements) const;

  Eigen::Index unsure() const { return static_cast<Eigen::Index>(unsure_.size()); }  // vertices filled in

 private:
  void prepare_filling(const Triangles& triangles);
  void fill_unsure(Positions& displacements) const;

  const Correspondence& correspondence_;
  DeformationTransfer transfer_;
  std::vector<int> unsure_;
  Eigen::SparseMatrix<double> to_sure_;  // unsure x V': the membrane between them and all others
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> fill_;
};

}  // namespace bodyopt
