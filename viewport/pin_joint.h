// Pins on the limbs of the lead.
#pragma once

#include "viewport/commands/controls.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Holds the end of a limb of the lead, where it is or at a point. Throws Error(usage) where it has no two joints above
// it.
void pin_joint(const PinRequest& request, const Scene& scene, Controls& controls);

}  // namespace bodyopt::viewport
