// The mouse over the picture: left turns, middle or shift moves along, right and the wheel go nearer. A click picks a
// joint, also by the skin over it; rings and pins of the selected joint are dragged.
#pragma once

#include <array>
#include <optional>

#include "draw/view.h"
#include "viewport/brushing.h"
#include "viewport/commands/controls.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Steers within a picture of panels, before they are drawn. `area`: of the characters; `height`: of the window; pixels.
void steer_by_mouse(Scene& scene, const draw::Rectangle& area, std::uint32_t height, Controls& controls);

// Returns the mouse's pixel over the picture; none: a panel has it, or it is nowhere.
std::optional<std::array<double, 2>> mouse_over_picture();

// Brushes with the left button on the skin, a brush in hand; true: nothing else is to hear of the mouse then.
bool brush_by_mouse(Brushing& brushing, const draw::Rectangle& area, Controls& controls);

// Draws the ring of the brush over the picture.
void draw_brush(const Brushing& brushing, const Scene& scene, const draw::Rectangle& area, const Controls& controls);

}  // namespace bodyopt::viewport
