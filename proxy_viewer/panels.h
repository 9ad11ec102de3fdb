// The panels, one file each in panels/. Each reads the snapshot and writes the controls; none computes.
#pragma once

#include "proxy_viewer/controls.h"
#include "proxy_viewer/render/view.h"
#include "proxy_viewer/snapshot.h"

namespace bodyopt {

// All of them in a window of so many pixels; gives the part that is left to the characters.
Rectangle draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height);

// Where panels stand, pixels.
struct Layout {
  float width, height;   // of the window
  float menu, timeline;  // heights
  float side;            // width
};

void draw_menu_bar(const Snapshot& snapshot, Controls& controls);
void draw_timeline(const Snapshot& snapshot, Controls& controls, const Layout& layout);
void draw_hud(const Snapshot& snapshot, const Controls& controls, const Layout& layout);
void draw_messages(Controls& controls, const Layout& layout);

}  // namespace bodyopt
