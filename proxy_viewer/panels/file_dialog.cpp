// A folder's list, to choose a file for a command from.
#include <algorithm>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kDialogWidth = 600, kDialogHeight = 380;

void run_with_file(Controls& controls) {
  const std::string line = controls.dialog->command + " " + controls.dialog->file();
  controls.dialog.reset();
  attempt(controls, line);
}

// What a click on the list asks for.
struct Choice {
  std::string folder;  // to be entered
  bool done = false;
};

Choice draw_entries(FileDialog& dialog) {
  Choice choice;
  ImGui::BeginChild("entries", {0, -2.9f * ImGui::GetFrameHeightWithSpacing()});
  for (const FolderEntry& entry : dialog.entries) {
    ImGui::PushID(&entry);
    const bool clicked = ImGui::Selectable("##entry", entry.name == dialog.name, ImGuiSelectableFlags_AllowDoubleClick);
    ImGui::SameLine(6);
    ImGui::TextUnformatted((entry.is_folder ? entry.name + "/" : entry.name).c_str());
    if (clicked && entry.is_folder) choice.folder = entry.name;
    if (clicked && !entry.is_folder) {
      dialog.name = entry.name;
      choice.done = ImGui::IsMouseDoubleClicked(0);
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
  return choice;
}

}  // namespace

void draw_file_dialog(Controls& controls, const PanelLayout& layout) {
  FileDialog& dialog = *controls.dialog;
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.5f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::max(80.0f, std::min(kDialogWidth, layout.width - 16)),
                            std::max(80.0f, std::min(kDialogHeight, layout.height - 16))});
  ImGui::Begin("File", nullptr, kOverWindow);
  const Command& command = *find_command(dialog.command);
  ImGui::Text("%s", label_of(command).c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", dialog.folder.string().c_str());
  const Choice choice = draw_entries(dialog);
  ImGui::TextDisabled("%s: %s", command.argument, command.help);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  bool done =
      ImGui::InputTextWithHint("##name", command.argument, &dialog.name, ImGuiInputTextFlags_EnterReturnsTrue) ||
      choice.done;
  const float width = share_of_line(2);
  ImGui::BeginDisabled(dialog.name.empty());
  done |= ImGui::Button(dialog.replaces() && writes_file(dialog.command) ? "Replace" : label_of(command).c_str(),
                        {width, 0});
  ImGui::EndDisabled();
  ImGui::SameLine();
  const bool left = ImGui::Button("Cancel", {width, 0}) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  ImGui::End();
  if (left) return controls.dialog.reset();
  if (!choice.folder.empty()) {
    controls.attempt([&] { dialog = browse_folder(dialog.command, dialog.folder / choice.folder, dialog.name); });
  } else if (done && !dialog.name.empty()) {
    run_with_file(controls);
  }
}

}  // namespace bodyopt
