// The mouse over the picture: left turns, middle or shift moves along, right and the wheel go nearer; a click picks a
// joint, also by the skin over it; rings and pins of the joint that is selected are dragged.
#pragma once

#include "draw/view.h"
#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

// Within a picture of panels, before they are drawn. `area`: of the characters; `height`: of the window; pixels.
void steer_by_mouse(Scene& scene, const Rectangle& area, std::uint32_t height, Controls& controls);

}  // namespace bodyopt
