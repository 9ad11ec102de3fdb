// The dope sheet: what is keyed, a line each.
#include <algorithm>
#include <cmath>
#include <set>

#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

constexpr float kNames = 0.42f;  // of the section's width
constexpr float kRow = 18;

// Joints, axes, controls and pins of a key.
std::set<std::string> names_of(const shots::ViewSettings::PoseKey& key) {
  std::set<std::string> names;
  for (const auto& [name, value] : key.joints) names.insert(name);
  for (const auto& [name, value] : key.axes) names.insert(name);
  for (const auto& [name, value] : key.controls) names.insert(name);
  for (const auto& [name, value] : key.pins) names.insert("pin " + name);
  for (const auto& [name, value] : key.moves) names.insert("move " + name);
  return names;
}

struct KeyedLine {
  std::string name;
  std::map<int, shots::KeyEase> keys{};  // all there are
  std::set<int> frames{};                // of those that say something of what the line is of
  bool is_camera = false;                // otherwise the pose
};

// Returns a key's ease for what a row is of.
shots::KeyEase ease_of(const shots::ViewSettings::PoseKey& key, const std::string& row) {
  const std::size_t kind = row.starts_with("pin ") ? 4 : row.starts_with("move ") ? 5 : 0;
  return shots::set_or(key.eases, row.substr(kind), key.ease);
}

// Draws all keys in a line, to be dragged to other frames; a click goes there. Hollow ones say nothing of the line's
// name, which is there as the clip has it. Gives the command for what the mouse did; empty: none.
std::string draw_diamonds(const KeyedLine& line, const ImVec2& at, float width, int first, int last,
                          const Controls& controls) {
  std::string command;
  const ImU32 colour = line.is_camera ? kCameraColour : kAccent;
  const FrameBar bar{at, {width, kRow - 2}, first, std::max(last, first + 1), kDiamond};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + width, at.y + kRow - 2}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.6f));
  for (const auto& [frame, ease] : line.keys) {
    if (frame < first || last < frame) continue;
    const float x = bar.x(frame), y = at.y + kRow / 2 - 1;
    ImGui::SetCursorScreenPos({x - kDiamond, at.y});
    ImGui::PushID(frame);
    ImGui::InvisibleButton(line.name.c_str(), {2 * kDiamond, kRow});
    const bool held = ImGui::IsItemActive();
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("frame %d: drag to move this key%s", frame,
                        line.is_camera ? "" : ", with Shift all poses of the range");
    if (ImGui::IsItemDeactivated()) {
      const int to = bar.frame(ImGui::GetIO().MousePos.x);
      const std::string moved =
          ImGui::GetIO().KeyShift && !line.is_camera
              ? "shift-keys " + std::to_string(to - frame)
              : (line.is_camera ? "move-camera-key " : "move-key ") + std::to_string(frame) + " " + std::to_string(to);
      command = to == frame ? "frame " + std::to_string(frame) : moved;
    }
    ImGui::PopID();
    // The shape shows the way to the next key: a diamond, a triangle if linear, a circle for a spline, a square where
    // nothing moves.
    const ImVec2 middle{held ? ImGui::GetIO().MousePos.x : x, y};
    if (!line.frames.contains(frame)) {
      list.AddCircle(middle, kDiamond - 1, colour, 4);
    } else if (ease == shots::KeyEase::step) {
      list.AddRectFilled({middle.x - 3.5f, y - 3.5f}, {middle.x + 3.5f, y + 3.5f}, colour);
    } else {
      list.AddCircleFilled(middle, kDiamond, colour,
                           ease == shots::KeyEase::linear   ? 3
                           : ease == shots::KeyEase::spline ? 12
                                                            : 4);
    }
  }
  const int shown = controls.playback.frame();
  if (shown < first || last < shown) return command;
  const float head = bar.x(shown);
  list.AddLine({head, at.y}, {head, at.y + kRow - 2}, ImGui::GetColorU32(ImGuiCol_Text, 0.5f));
  return command;
}

std::string draw_key_line(const KeyedLine& line, float name_width, float width, int first, int last,
                          const Controls& controls) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::PushClipRect(at, {at.x + name_width - 4, at.y + kRow}, true);
  ImGui::TextUnformatted(line.name.c_str());
  ImGui::PopClipRect();
  const std::string command = draw_diamonds(line, {at.x + name_width, at.y}, width - name_width, first, last, controls);
  ImGui::SetCursorScreenPos({at.x, at.y + kRow});
  return command;
}

// All keys, menu by menu, and what the mouse does.

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

// Counts lines of the cheat sheet; none where no command of the menu has a key.
int lines_of(const char* menu, Keymap keymap) {
  const auto keys = std::ranges::count_if(commands(), [&](const Command& command) {
    return *key_of(command, keymap) != 0 && std::string(menu) == command.menu;
  });
  return keys > 0 ? 2 + static_cast<int>(keys) : 0;
}

void draw_menu(const char* menu, Keymap keymap, float width) {
  if (lines_of(menu, keymap) == 0) return;
  draw_title(menu);
  for (const Command& command : commands()) {
    const char* const key = key_of(command, keymap);
    if (*key != 0 && std::string(menu) == command.menu) draw_line(key, command.help, kKey, width);
  }
}

void draw_mouse(float width) {
  draw_title("Mouse");
  for (const auto& [key, help] : kMouse) draw_line(key, help, kMouseKey, width);
}

}  // namespace

void draw_key_lines(Controls& controls, float name_width, float width, int first, int last) {
  const std::map<int, shots::ViewSettings::PoseKey>& poses = controls.settings.pose.keys;
  if (poses.empty() && controls.settings.shot_camera.keys.empty()) {
    ImGui::TextDisabled("no keys: pose a frame, then Set key below (Alt+K)");
    return;
  }
  KeyedLine camera{.name = "camera", .is_camera = true}, all{.name = "all"};
  for (const auto& [frame, key] : controls.settings.shot_camera.keys) {
    camera.keys[frame] = key.ease;
    camera.frames.insert(frame);
  }
  std::map<std::string, std::set<int>> rows;
  for (const auto& [frame, key] : poses) {
    all.keys[frame] = key.ease;
    all.frames.insert(frame);
    for (const std::string& name : names_of(key)) rows[name].insert(frame);
  }
  std::vector<KeyedLine> lines;
  if (!camera.keys.empty()) lines.push_back(camera);
  if (!all.keys.empty()) lines.push_back(all);
  for (const auto& [name, frames] : rows) {
    KeyedLine& line = lines.emplace_back(KeyedLine{.name = name, .frames = frames});
    for (const auto& [frame, key] : poses) line.keys[frame] = ease_of(key, name);
  }
  // Keys are as they were until all lines are drawn.
  std::string command;
  for (const KeyedLine& line : lines) {
    const std::string of_line = draw_key_line(line, name_width, width, first, last, controls);
    if (!of_line.empty()) command = of_line;
  }
  if (!command.empty()) attempt(controls, command);
}

void draw_keys(const Snapshot&, Controls& controls) {
  const Playback& playback = controls.playback;
  const float width = ImGui::GetContentRegionAvail().x;
  draw_key_lines(controls, kNames * width, width, playback.in(), playback.out());
  const std::map<int, shots::ViewSettings::PoseKey>& keys = controls.settings.pose.keys;
  if (keys.empty()) return;
  ImGui::BeginDisabled(!keys.contains(playback.frame()));
  command_choice(controls, "ease", "To the next");
  if (!controls.joint.empty()) command_choice(controls, "ease-joints", "Of selected");
  ImGui::EndDisabled();
  command_tick(controls, "curves");
}

void draw_cheat_sheet(Controls& controls, const PanelLayout& layout) {
  const int columns = std::clamp(static_cast<int>((layout.width - 40) / kNarrowestColumn), 1, 3);
  const float width = std::min(400.0f, (layout.width - 40) / static_cast<float>(columns));
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.5f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {layout.width, layout.height});
  ImGui::Begin("Keys", nullptr, kOverWindow | ImGuiWindowFlags_AlwaysAutoResize);
  const int mouse_lines = 2 + static_cast<int>(std::size(kMouse));
  int total = mouse_lines;
  for (const char* menu : kMenus) total += lines_of(menu, controls.keymap);
  int lines = 0, column = 0;
  ImGui::BeginGroup();
  // Begins a part of so many lines, in this column or the next.
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
    begin_part(lines_of(menu, controls.keymap));
    draw_menu(menu, controls.keymap, width);
  }
  begin_part(mouse_lines);
  draw_mouse(width);
  ImGui::EndGroup();
  const bool clicked = ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsWindowAppearing();
  if (clicked || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) controls.cheat_sheet = false;
  ImGui::End();
}

}  // namespace bodyopt::viewport
