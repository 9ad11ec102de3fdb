// Every command that has a place in the menus.
#include <imgui.h>

#include <string>

#include "proxy_viewer/commands.h"
#include "proxy_viewer/panels.h"

namespace bodyopt {
namespace {

// "step-back": "Step back".
std::string label(const Command& command) {
  std::string text = command.name;
  for (char& c : text) {
    if (c == '-') c = ' ';
  }
  text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

void draw_menu(const char* menu, Controls& controls) {
  if (!ImGui::BeginMenu(menu)) return;
  for (const Command& command : commands()) {
    if (std::string(menu) != command.menu) continue;
    if (ImGui::MenuItem(label(command).c_str(), command.key)) command.run(controls, "");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", command.help);
  }
  ImGui::EndMenu();
}

}  // namespace

void draw_menu_bar(const Snapshot& snapshot, Controls& controls) {
  if (!ImGui::BeginMainMenuBar()) return;
  for (const char* menu : {"File", "Playback", "Camera", "Look", "Compare", "Pose", "View"}) draw_menu(menu, controls);
  if (!snapshot.cast.empty()) {
    const CharacterRow& lead = snapshot.cast.front();
    const std::string text = lead.clip.empty() ? lead.name : lead.name + "  \xe2\x80\x93  " + lead.clip;
    ImGui::SameLine(ImGui::GetWindowWidth() - ImGui::CalcTextSize(text.c_str()).x - 14);
    ImGui::TextDisabled("%s", text.c_str());
  }
  ImGui::EndMainMenuBar();
}

}  // namespace bodyopt
