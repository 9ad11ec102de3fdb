// The panels, one file each in panels/. Each reads the snapshot and writes the controls; none computes.
#pragma once

#include <functional>
#include <string>

#include "draw/view.h"
#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/panels/snapshot.h"

namespace bodyopt {

// All of them in a window of so many pixels; gives the part that is left to the characters.
Rectangle draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height);

// In the middle of a picture without anything else.
void draw_loading(const std::string& text);

// Where panels stand, pixels. What they leave free is the picture's area.
struct PanelLayout {
  float width, height;   // of the window
  float menu, timeline;  // heights
  float side;            // width
  float messages = 0;    // height, at the foot of the side panel

  float right() const { return width - side; }
  float bottom() const { return height - timeline; }
};

void draw_menu_bar(const Snapshot& snapshot, Controls& controls);
void draw_timeline(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout);
void draw_cheat_sheet(Controls& controls, const PanelLayout& layout);
void draw_prompt(Controls& controls, const PanelLayout& layout);
void draw_file_dialog(Controls& controls, const PanelLayout& layout);

// Over the picture.
// Points that the names of what is compared take at its top; 0 where none are shown.
float names_height(const Snapshot& snapshot, const Controls& controls);
void draw_comparison(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout);
// Points that the colours of a heat map and what they mean take at its right; 0 where none are shown.
float colour_bar_width(const Snapshot& snapshot, const Controls& controls);
void draw_colour_bar(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
void draw_colour_keys(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
void draw_hud(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
// At the foot of the side panel, which gives way; over the picture where there is none.
void draw_messages(Controls& controls, PanelLayout& layout);

// Sections of the side panel.
void draw_look(const Snapshot& snapshot, Controls& controls);
void draw_cameras(const Snapshot& snapshot, Controls& controls);
void draw_compare(const Snapshot& snapshot, Controls& controls);
void draw_curate(const Snapshot& snapshot, Controls& controls);
void draw_pose(const Snapshot& snapshot, Controls& controls);
void draw_keys(const Snapshot& snapshot, Controls& controls);
void draw_modifiers(const Snapshot& snapshot, Controls& controls);
void draw_muscles(const Snapshot& snapshot, Controls& controls);
void draw_jiggle(const Snapshot& snapshot, Controls& controls);
void draw_ghosts(const Snapshot& snapshot, Controls& controls);
void draw_cast(const Snapshot& snapshot, Controls& controls);
void draw_transfer(const Snapshot& snapshot, Controls& controls);
void draw_output(const Snapshot& snapshot, Controls& controls);

// Every text of the panels that people wrote, in any script: names in files, messages, what is being typed.
void visit_texts(const Snapshot& snapshot, const Controls& controls,
                 const std::function<void(const std::string&)>& visit);

}  // namespace bodyopt
