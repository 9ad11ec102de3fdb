// The mouse over the picture: left turns, middle or shift moves along, right and the wheel go nearer; a click picks a
// joint, also by the skin over it; rings and pins of the joint that is selected are dragged.
#pragma once

#include <array>
#include <optional>

#include "draw/view.h"
#include "proxy_viewer/brushing.h"
#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

// Within a picture of panels, before they are drawn. `area`: of the characters; `height`: of the window; pixels.
void steer_by_mouse(Scene& scene, const Rectangle& area, std::uint32_t height, Controls& controls);

// Where the mouse is over the picture, pixels; none: a panel has it, or it is nowhere.
std::optional<std::array<double, 2>> mouse_over_picture();

// With a brush in hand, the left button on the skin brushes: true, nothing else is to hear of the mouse then.
bool brush_by_mouse(Brushing& brushing, const Rectangle& area, Controls& controls);

// The ring of the brush, over the picture.
void draw_brush(const Brushing& brushing, const Scene& scene, const Rectangle& area, const Controls& controls);

}  // namespace bodyopt
