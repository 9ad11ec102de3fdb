// All keys, menu by menu, and what the mouse does.
#include <algorithm>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kNarrowestColumn = 318, kKey = 92, kMouseKey = 132;  // widths
constexpr std::pair<const char*, const char*> kMouse[] = {
    {"left", "turn around the character"},         {"middle, Shift+left", "move across"},
    {"right, wheel", "nearer, further"},           {"click", "select a joint, or that under the skin"},
    {"Ctrl+click", "type the number of a slider"}, {"drop a file", "open it"},
    {"hold X", "see what is compared with"}};

void draw_title(const char* title) {
  ImGui::Spacing();
  ImGui::TextColored({0.95f, 0.62f, 0.25f, 1}, "%s", title);
}

void draw_line(const char* key, const char* help, float key_width, float width) {
  const float left = ImGui::GetCursorPosX();
  ImGui::TextUnformatted(key);
  ImGui::SameLine();
  ImGui::SetCursorPosX(left + key_width);
  ImGui::PushTextWrapPos(left + width - 16);
  ImGui::TextDisabled("%s", help);
  ImGui::PopTextWrapPos();
}

void draw_menu(const char* menu, float width) {
  draw_title(menu);
  for (const Command& command : commands()) {
    if (*command.key != 0 && std::string(menu) == command.menu) draw_line(command.key, command.help, kKey, width);
  }
}

int lines_of(const char* menu) {
  return 2 + static_cast<int>(std::ranges::count_if(commands(), [&](const Command& command) {
           return *command.key != 0 && std::string(menu) == command.menu;
         }));
}

void draw_mouse(float width) {
  draw_title("Mouse");
  for (const auto& [key, help] : kMouse) draw_line(key, help, kMouseKey, width);
}

}  // namespace

void draw_cheat_sheet(Controls& controls, const PanelLayout& layout) {
  const int columns = std::clamp(static_cast<int>((layout.width - 40) / kNarrowestColumn), 1, 3);
  const float width = std::min(400.0f, (layout.width - 40) / static_cast<float>(columns));
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.5f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {layout.width, layout.height});
  ImGui::Begin("Keys", nullptr, kOverWindow | ImGuiWindowFlags_AlwaysAutoResize);
  const int mouse_lines = 2 + static_cast<int>(std::size(kMouse));
  int total = mouse_lines;
  for (const char* menu : kMenus) total += lines_of(menu);
  int lines = 0, column = 0;
  ImGui::BeginGroup();
  // The next part, of so many lines: in this column or the next.
  const auto begin_part = [&](int count) {
    if (column + 1 < columns && lines + count / 2 > total * (column + 1) / columns) {
      ImGui::EndGroup();
      ++column;
      ImGui::SameLine();
      ImGui::SetCursorPosX(ImGui::GetStyle().WindowPadding.x + static_cast<float>(column) * width);
      ImGui::BeginGroup();
    }
    lines += count;
  };
  for (const char* menu : kMenus) {
    begin_part(lines_of(menu));
    draw_menu(menu, width);
  }
  begin_part(mouse_lines);
  draw_mouse(width);
  ImGui::EndGroup();
  const bool clicked = ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsWindowAppearing();
  if (clicked || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) controls.cheat_sheet = false;
  ImGui::End();
}

}  // namespace bodyopt
