// What panels are made of. Most widgets are commands: their label, help and key come from the table of commands, so
// that a panel, a menu and a script say and do the same.
#pragma once

#include <imgui.h>
#include <imgui_stdlib.h>

#include <array>
#include <string>
#include <vector>

#include "proxy_viewer/commands/commands.h"

namespace bodyopt {

constexpr ImU32 kAccent = IM_COL32(242, 158, 64, 255), kQuiet = IM_COL32(122, 122, 126, 255);
constexpr ImU32 kErrorColour = IM_COL32(220, 90, 70, 255);

// Of linear RGB.
ImU32 opaque(const std::array<float, 3>& linear);

// Of what lies over everything, and of panels that are always there.
constexpr ImGuiWindowFlags kOverWindow = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                         ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                         ImGuiWindowFlags_NoSavedSettings;
constexpr ImGuiWindowFlags kFixedWindow = kOverWindow | ImGuiWindowFlags_NoBringToFrontOnFocus;

// "step-back": "Step back".
std::string label_of(const Command& command);

// Runs a line; what it refuses is said in the window.
void attempt(Controls& controls, const std::string& line);

// Over the item before: what the command does, and its key.
void explain(const char* command);
void explain(const Command& command);

// Of a command by its name. `text`: instead of its label.
void command_button(Controls& controls, const char* command, const char* text = nullptr, float width = 0);
// Lit while it is on.
void command_switch(Controls& controls, const char* command, const char* text, float width);
void command_tick(Controls& controls, const char* command, const char* text = nullptr);
// One of the words of its argument, after a label (null: none); `available`: those that can be had now (null: all).
void command_choice(Controls& controls, const char* command, const char* text,
                    const std::vector<std::string>* available = nullptr);

// A number with a label before it, as a bar to drag; Ctrl and a click to type. `help` may be null.
bool slide(const char* label, double& value, double low, double high, const char* format, const char* help,
           ImGuiSliderFlags flags = 0);
bool slide(const char* label, int& value, int low, int high, const char* format, const char* help);

// The label before a widget that fills the rest of the line.
void label_before(const char* text);
// Of `count` widgets in a line.
float share_of_line(int count);

}  // namespace bodyopt
