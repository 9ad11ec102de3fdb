// Fibres: the paths of muscles, projected on the skin.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

// fibre_count fibres per muscle, side by side on the half of its belly that faces the skin; fibres that collapse to a
// point there are left out. Rest lengths are measured by the runtime's kernels. `basis` needs skeleton, mesh and ddm.
// Without muscles, or without triangles, an empty table.
StrainTable make_strain_table(const Basis& basis, const std::vector<Muscle>& muscles);

// The table of some fibres, by ascending index.
StrainTable keep_fibres(const StrainTable& strain, const std::vector<std::uint32_t>& kept);

// Muscle of each fibre of the table, by the fibre's name.
std::vector<std::size_t> fibre_muscles(const StrainTable& strain, const std::vector<Muscle>& muscles);

}  // namespace bodyopt
