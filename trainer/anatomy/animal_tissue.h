// The inside of any body but a human's, whose bones have tables.
#pragma once

#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {

// Throws nothing for bodies without bones: notes say what could not be placed.
InnerTissue find_animal_tissue(const HalfBody& body, const BodyGrid& grid, const InnerTissueOptions& options);

}  // namespace bodyopt
