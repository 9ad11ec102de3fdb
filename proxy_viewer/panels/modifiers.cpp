// What moves the skin beyond its joints: the modifiers of the lead, in their order, with a switch, the strength, and
// the controls of each; and jiggle.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

double value_of(const ControlRow& row, const Controls& controls) {
  return set_or(controls.settings.pose.controls, row.name, row.usual);
}

// Within its modifier, whose name stands above it.
std::string own_name(const ControlRow& row) {
  return row.name == row.modifier ? "strength" : row.name.substr(row.modifier.size() + 1);
}

void draw_row(const ControlRow& row, Controls& controls) {
  double value = value_of(row, controls);
  if (slide(own_name(row).c_str(), value, row.low, row.high, "%.2f", row.what.c_str())) {
    controls.settings.pose.controls[row.name] = value;
  }
}

void draw_switch(const ControlRow& strength, const std::string& type, Controls& controls) {
  bool on = value_of(strength, controls) > 0;
  if (!ImGui::Checkbox((strength.name + "##on").c_str(), &on)) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s", type.c_str());
    return;
  }
  controls.settings.pose.controls[strength.name] = on ? std::max(strength.usual, 1.0) : 0.0;
}

}  // namespace

void draw_modifiers(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.modifiers.empty()) ImGui::TextDisabled("none: 'bodyopt modifiers' gives a basis some");
  for (const ModifierRow& modifier : snapshot.modifiers) {
    ImGui::PushID(modifier.name.c_str());
    for (const ControlRow& row : snapshot.controls) {
      if (row.modifier != modifier.name) continue;
      if (row.name == modifier.name) draw_switch(row, modifier.type, controls);
      draw_row(row, controls);
    }
    ImGui::PopID();
  }
}

// Flesh that moves by inertia.
void draw_jiggle(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.cast.empty() || snapshot.cast.front().tets == 0) {
    ImGui::PushTextWrapPos();
    ImGui::TextDisabled("%s", set_or(controls.missing, "jiggle on", "no dynamics").c_str());
    ImGui::PopTextWrapPos();
    return;
  }
  command_tick(controls, "jiggle", "On");
  ImGui::SameLine();
  command_button(controls, "reset-jiggle", "Begin anew");
  ImGui::BeginDisabled(!controls.settings.jiggle.on);
  slide("Amount", controls.settings.jiggle.amount, 0, kMostJiggle, "%.2f x", find_command("jiggle-amount")->help);
  ImGui::EndDisabled();
}

}  // namespace bodyopt
