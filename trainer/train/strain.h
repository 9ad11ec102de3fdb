// Muscle fibres on the skin.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/dataset/muscles.h"

namespace bodyopt {

// `fibre_count` fibres per muscle: its path, shifted sideways, projected to the skin. Rest lengths are measured by the
// run-time kernels on the bind pose. Fibres that shrink to a point are left out, with a note.
StrainTable make_strain_table(const MeshTable& mesh, const DdmTable& ddm, const Skeleton& skeleton,
                              const std::vector<Muscle>& muscles, std::vector<std::string>& notes);

}  // namespace bodyopt
