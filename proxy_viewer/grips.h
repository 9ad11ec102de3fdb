// What the mouse takes hold of in the picture: rings that turn the joint that is selected, and pins.
#pragma once

#include "draw/view.h"
#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

// Under a pixel; none: nothing is there that can be dragged.
std::optional<Grip> grip_at(const Scene& scene, const Controls& controls, const Rectangle& picture, float x, float y);

// The mouse went from one pixel to another: a ring turns by the angle around its middle, a pin stays under the cursor,
// as far away as it was.
void drag_grip(const Scene& scene, const Rectangle& picture, const std::array<float, 2>& from,
               const std::array<float, 2>& to, Controls& controls);

}  // namespace bodyopt
