// All keys, menu by menu, and what the mouse does.
#include <algorithm>

#include "proxy_viewer/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kColumn = 318, kKey = 88;  // widths
constexpr std::pair<const char*, const char*> kMouse[] = {
    {"left", "turn around the character"},         {"middle, Shift+left", "move across"},
    {"right, wheel", "nearer, further"},           {"click", "select a joint, with the skeleton shown"},
    {"Ctrl+click", "type the number of a slider"}, {"drop a file", "open it"}};

void draw_title(const char* title) {
  ImGui::Spacing();
  ImGui::TextColored({0.95f, 0.62f, 0.25f, 1}, "%s", title);
}

void draw_line(const char* key, const char* help, float key_width) {
  const float left = ImGui::GetCursorPosX();
  ImGui::TextUnformatted(key);
  ImGui::SameLine(left + key_width);
  ImGui::TextDisabled("%s", help);
}

void draw_menu(const char* menu) {
  draw_title(menu);
  for (const Command& command : commands()) {
    if (*command.key != 0 && std::string(menu) == command.menu) draw_line(command.key, command.help, kKey);
  }
}

int lines_of(const char* menu) {
  return 2 + static_cast<int>(std::ranges::count_if(commands(), [&](const Command& command) {
           return *command.key != 0 && std::string(menu) == command.menu;
         }));
}

}  // namespace

void draw_cheat_sheet(Controls& controls, const Layout& layout) {
  const int columns = std::clamp(static_cast<int>((layout.width - 60) / kColumn), 1, 3);
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.5f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {layout.width, layout.height});
  ImGui::Begin("Keys", nullptr, kFixedWindow | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  int total = 2 + static_cast<int>(std::size(kMouse));
  for (const char* menu : kMenus) total += lines_of(menu);
  int lines = 0, column = 0;
  ImGui::BeginGroup();
  const auto next = [&](int count) {
    const bool full = lines > 0 && lines + count / 2 > total * (column + 1) / columns;
    if (full && column + 1 < columns) {
      ImGui::EndGroup();
      ImGui::SameLine(static_cast<float>(++column) * kColumn + ImGui::GetStyle().WindowPadding.x);
      ImGui::BeginGroup();
    }
    lines += count;
  };
  for (const char* menu : kMenus) {
    next(lines_of(menu));
    draw_menu(menu);
  }
  next(2 + static_cast<int>(std::size(kMouse)));
  draw_title("Mouse");
  for (const auto& [key, help] : kMouse) draw_line(key, help, kKey + 36);
  draw_line("hold X", "see what is compared with", kKey + 36);
  ImGui::EndGroup();
  const bool clicked = ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsWindowAppearing();
  if (clicked || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) controls.cheat_sheet = false;
  ImGui::End();
}

}  // namespace bodyopt
