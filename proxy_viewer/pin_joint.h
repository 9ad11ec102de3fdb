// Pins on the limbs of the lead.
#pragma once

#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

// Holds the end of a limb of the lead, where it is or at a point. Throws Error(usage) where two joints above it lack.
void pin_joint(const PinRequest& request, const Scene& scene, Controls& controls);

}  // namespace bodyopt
