// The panels, one file each in panels/. Each reads the snapshot and writes the controls; none computes.
#pragma once

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "draw/view.h"
#include "viewport/commands/commands.h"
#include "viewport/commands/controls.h"
#include "viewport/panels/snapshot.h"

namespace bodyopt::viewport {

// Parts of panels. Most widgets are commands: their label, help and key come from the table of commands. So a panel, a
// menu and a script say and do the same.

constexpr ImU32 kAccent = IM_COL32(242, 158, 64, 255), kQuiet = IM_COL32(122, 122, 126, 255);
constexpr ImU32 kErrorColour = IM_COL32(220, 90, 70, 255), kCameraColour = IM_COL32(110, 200, 150, 255);

// Converts linear RGB.
ImU32 opaque(const std::array<float, 3>& linear);

// Flags of windows over everything, and of panels that are always there.
constexpr ImGuiWindowFlags kOverWindow = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                         ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                         ImGuiWindowFlags_NoSavedSettings;
constexpr ImGuiWindowFlags kFixedWindow = kOverWindow | ImGuiWindowFlags_NoBringToFrontOnFocus;

// "step-back": "Step back".
std::string label_of(const Command& command);
// Returns the label of one of the words of its argument.
std::string label_of(const Command& command, const std::string& choice);

// Runs a line; what it refuses is said in the window.
void attempt(Controls& controls, const std::string& line);

// These explain the item before: what the command does, and its key.
void explain(const char* command);
void explain_text(const std::string& text);
void explain(const Command& command);

// Draws a button for a command's name. `text`: instead of its label.
void command_button(Controls& controls, const char* command, const char* text = nullptr, float width = 0);
// Lit while it is on.
void command_switch(Controls& controls, const char* command, const char* text, float width);
void command_tick(Controls& controls, const char* command, const char* text = nullptr);
// Draws the words of its argument after a label (null: none); `available`: those to be had now (null: all).
void command_choice(Controls& controls, const char* command, const char* text,
                    const std::vector<std::string>* available = nullptr);

// A number with a label before it, as a bar to drag; Ctrl and a click to type. `help` may be null.
bool slide(const char* label, double& value, double low, double high, const char* format, const char* help,
           ImGuiSliderFlags flags = 0);
bool slide(const char* label, int& value, int low, int high, const char* format, const char* help);

// The label before a widget that fills the rest of the line.
void label_before(const char* text);
// Returns the width of one of `count` widgets in a line.
float share_of_line(int count);

// The edges of the picture over which something stands, points: framing leaves them free of bodies. What would take too
// much of it stands elsewhere, or nowhere.
struct Overlaid {
  float top = 0, right = 0, bottom = 0, left = 0;
};

// The part of a window that panels leave to the characters.
struct PictureRoom {
  draw::Rectangle area;
  Overlaid overlaid;
};

// Draws all panels in a window of so many points.
PictureRoom draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height);

// Draws the text in the middle of a picture without anything else.
void draw_loading(const std::string& text);

// Places of panels, pixels. What they leave free is the picture's area.
struct PanelLayout {
  float width, height;   // of the window
  float menu, timeline;  // heights
  float side;            // width
  float messages = 0;    // height, at the foot of the side panel
  float sheet = 0;       // height, at the foot of the timeline
  Overlaid overlaid{};   // of the picture

  float right() const { return width - side; }
  float bottom() const { return height - timeline; }
};

// Frames from left to right in a bar, points.
struct FrameBar {
  ImVec2 at, size;
  int first, last;
  float inset = 0;  // of the first and the last from the bar's ends

  float x(double frame) const {
    const double t = last > first ? (frame - first) / (last - first) : 0;
    return at.x + inset + static_cast<float>(std::clamp(t, 0.0, 1.0)) * (size.x - 2 * inset);
  }
  bool shows(int frame) const { return first <= frame && frame <= last; }
  // The frame nearest to a place.
  int frame(float x) const {
    const auto t = static_cast<double>((x - at.x - inset) / std::max(1.0f, size.x - 2 * inset));
    return first + static_cast<int>(std::lround(std::clamp(t, 0.0, 1.0) * (last - first)));
  }
};

void draw_menu_bar(const Snapshot& snapshot, Controls& controls);
void draw_timeline(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout);
void draw_cheat_sheet(Controls& controls, const PanelLayout& layout);
void draw_prompt(Controls& controls, const PanelLayout& layout);
// Whether work is to be saved, or brought back.
void draw_question(Controls& controls, const PanelLayout& layout);
void draw_file_dialog(Controls& controls, const PanelLayout& layout);

// Over the picture.
// Does the picture show two views, one beside the other?
bool shows_two_views(const Snapshot& snapshot, const Controls& controls);
// Points that the names of what is compared take at its top; 0 where there are none.
float names_height(const Snapshot& snapshot, const Controls& controls);
void draw_comparison(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout);
// Points that the colours of a heat map and what they mean take at its right; 0 where there are none. Where these have
// no room, they lie at its foot, in the first of the lines of draw_colour_keys().
float colour_bar_width(const Snapshot& snapshot, const Controls& controls);
// Points that as many of its lines as fit into `most` take at the picture's foot.
float colour_keys_height(const Snapshot& snapshot, const Controls& controls, bool bar_lies, float most);
void draw_colour_bar(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
void draw_colour_keys(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
constexpr float kHudWidth = 160;
void draw_hud(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout);
// Draws at the foot of the side panel, which gives way, with the figures that have no room over the picture. Without a
// side panel messages are over the timeline, and without that over the picture.
void draw_messages(const Snapshot& snapshot, Controls& controls, PanelLayout& layout);

// Sections of the side panel.
void draw_look(const Snapshot& snapshot, Controls& controls);
void draw_cameras(const Snapshot& snapshot, Controls& controls);
void draw_compare(const Snapshot& snapshot, Controls& controls);
void draw_curate(const Snapshot& snapshot, Controls& controls);
void draw_pose(const Snapshot& snapshot, Controls& controls);
void draw_poses(const Snapshot& snapshot, Controls& controls);
void draw_keys(const Snapshot& snapshot, Controls& controls);
constexpr float kSoundHeight = 32;  // of the waveform under the timeline
constexpr float kDiamond = 4.5f;    // half of what a key is drawn as
// A line for all keys, one for each thing that is keyed, and one for the camera: its name, and its keys between two
// frames.
void draw_key_lines(Controls& controls, float name_width, float width, int first, int last);
// In the same place: the values of the keys as curves.
void draw_curves(Controls& controls, float name_width, float width, int first, int last);
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

}  // namespace bodyopt::viewport
