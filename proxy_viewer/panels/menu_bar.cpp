// Every command, in its menu: those with a choice of words as menus of their own, those with any other argument by the
// prompt.
#include <algorithm>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

bool needs_argument(const Command& command) { return *command.argument != 0 && *command.argument != '['; }

void draw_choices(const Command& command, const std::vector<std::string>& choices, Controls& controls) {
  const bool open = ImGui::BeginMenu(label_of(command).c_str());
  if (!open) return explain(command);
  const std::string current = command.value ? command.value(controls) : "";
  for (const std::string& choice : choices) {
    if (ImGui::MenuItem(choice.c_str(), nullptr, choice == current)) {
      attempt(controls, std::string(command.name) + " " + choice);
    }
  }
  ImGui::EndMenu();
}

void draw_item(const Command& command, Controls& controls) {
  const std::vector<std::string> choices = choices_of(command);
  if (!choices.empty()) return draw_choices(command, choices, controls);
  const std::vector<std::string> browsed = browsed_commands();
  const bool browses = std::ranges::find(browsed, command.name) != browsed.end(), types = needs_argument(command);
  const bool on = command.value && command.value(controls) == "on";
  const std::string label = label_of(command) + (browses || types ? "\xe2\x80\xa6" : "");
  if (ImGui::MenuItem(label.c_str(), command.key, on)) {
    if (browses) {
      attempt(controls, std::string("browse ") + command.name);
    } else if (types) {
      controls.typed.prompt = std::string(command.name) + " ";
      controls.prompt = true;
    } else {
      attempt(controls, command.name);
    }
  }
  explain(command);
}

void draw_title(const Snapshot& snapshot) {
  if (snapshot.cast.empty()) return;
  const CharacterRow& lead = snapshot.cast.front();
  const std::string text = lead.clip.empty() ? lead.name : lead.name + "  \xe2\x80\x93  " + lead.clip;
  const float at = ImGui::GetWindowWidth() - ImGui::CalcTextSize(text.c_str()).x - 14;
  if (at < ImGui::GetCursorPosX()) return;
  ImGui::SameLine(at);
  ImGui::TextDisabled("%s", text.c_str());
}

}  // namespace

void draw_menu_bar(const Snapshot& snapshot, Controls& controls) {
  if (!ImGui::BeginMainMenuBar()) return;
  for (const char* menu : kMenus) {
    if (!ImGui::BeginMenu(menu)) continue;
    for (const Command& command : commands()) {
      if (std::string(menu) == command.menu) draw_item(command, controls);
    }
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndMenu();
  }
  draw_title(snapshot);
  ImGui::EndMainMenuBar();
}

}  // namespace bodyopt
