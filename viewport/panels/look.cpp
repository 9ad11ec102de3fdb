// How the character looks, and what is shown of its inside.
#include <algorithm>

#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

struct Tick {
  const char* command;
  bool available;
};

// Views along the axes, and cameras that were kept.

// Each view is above the one from the other side.
void draw_axis_views(Controls& controls) {
  constexpr int kInLine = 3;
  const float width = share_of_line(kInLine);
  int count = 0;
  for (const char* view : {"front", "right", "top", "back", "left", "bottom"}) {
    if (count++ % kInLine > 0) ImGui::SameLine();
    command_button(controls, view, nullptr, width);
  }
}

void draw_kept(Controls& controls) {
  std::string forgotten;
  int index = 0;
  for (const auto& [name, view] : controls.settings.cameras) {
    ImGui::PushID(index++);
    const float button = ImGui::GetFrameHeight();
    if (ImGui::Selectable("##go", false, 0, {ImGui::GetContentRegionAvail().x - button - 8, button})) {
      attempt(controls, "camera " + name);
    }
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + 4);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name.c_str());
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - button);
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - button);
    if (ImGui::Button("\xc3\x97", {button, button})) forgotten = name;
    explain("forget-camera");
    ImGui::PopID();
  }
  if (!forgotten.empty()) attempt(controls, "forget-camera " + forgotten);
}

// Draws the shot camera's keys, and whether it is looked through.
void draw_shot_camera(Controls& controls) {
  const float width = share_of_line(2);
  command_button(controls, "camera-key", nullptr, width);
  ImGui::SameLine();
  ImGui::BeginDisabled(!controls.settings.shot_camera.keys.contains(controls.playback.frame()));
  command_button(controls, "camera-unkey", "Remove", width);
  command_choice(controls, "camera-ease", "To the next");
  ImGui::EndDisabled();
  command_tick(controls, "look-through");
  for (const ClipCamera& camera : controls.file_cameras) {
    const bool is_chosen = camera.name == controls.settings.shot_camera.of_file;
    if (ImGui::Selectable(camera.name.c_str(), is_chosen)) attempt(controls, "camera " + camera.name);
    explain("camera");
  }
}

// The first "camera 1", "camera 2", ... that is free.
std::string free_name(const Controls& controls) {
  for (int k = 1;; ++k) {
    const std::string name = "camera " + std::to_string(k);
    if (!controls.settings.cameras.contains(name)) return name;
  }
}

// Files that are written, and read.

// A file's name, and buttons of commands that take it.
void draw_file(Controls& controls, std::string& name, const char* hint,
               std::initializer_list<std::pair<const char*, const char*>> commands) {
  constexpr float kButton = 80;
  ImGui::PushID(hint);
  const float space = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - static_cast<float>(commands.size()) * (kButton + space));
  ImGui::InputTextWithHint("##name", hint, &name);
  for (const auto& [command, text] : commands) {
    ImGui::SameLine();
    ImGui::BeginDisabled(name.empty());
    if (ImGui::Button(text, {kButton, 0})) attempt(controls, std::string(command) + " " + name);
    explain(command);
    ImGui::EndDisabled();
  }
  ImGui::PopID();
}

}  // namespace

void draw_look(const Snapshot& snapshot, Controls& controls) {
  const bool has_tets = !snapshot.cast.empty() && snapshot.cast.front().tets > 0;
  const bool wears = std::ranges::any_of(snapshot.cast, &CharacterRow::wears);
  command_choice(controls, "style", "Style");
  const float half = ImGui::GetCursorPosX() + 0.5f * ImGui::GetContentRegionAvail().x;
  bool left = true;
  for (const Tick& tick : {Tick{"wire", true}, Tick{"skeleton", true}, Tick{"fibres", !snapshot.fibres.empty()},
                           Tick{"tets", has_tets}, Tick{"anatomy", snapshot.has_character}, Tick{"grid", true},
                           Tick{"axes", true}, Tick{"shadow", true}, Tick{"follow", true}, Tick{"worn", wears}}) {
    if (!left) ImGui::SameLine(half);
    left = !left;
    ImGui::BeginDisabled(!tick.available);
    command_tick(controls, tick.command);
    ImGui::EndDisabled();
  }
  if (has_tets && controls.settings.look.tets) {
    slide("Cut", controls.settings.look.tet_cut, 0, 1, "%.2f", find_command("tet-cut")->help);
  }
  if (snapshot.has_character && controls.settings.look.anatomy) {
    command_choice(controls, "anatomy-axis", "Across");
    slide("At", controls.settings.look.anatomy_at, 0, 1, "%.3f", find_command("anatomy-at")->help);
  }
}

void draw_cameras(const Snapshot&, Controls& controls) {
  draw_axis_views(controls);
  command_button(controls, "frame-selection", "Frame", share_of_line(3));
  ImGui::SameLine();
  command_tick(controls, "orthographic");
  command_tick(controls, "cut-away");
  draw_shot_camera(controls);
  draw_kept(controls);
  const std::string name = free_name(controls);
  const float button = 56;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x);
  std::string& typed = controls.typed.camera;
  const bool entered = ImGui::InputTextWithHint("##name", name.c_str(), &typed, ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::SameLine();
  const bool keeps = ImGui::Button("Keep", {button, 0});
  explain("save-camera");
  if (!entered && !keeps) return;
  attempt(controls, "save-camera " + (typed.empty() ? name : typed));
  typed.clear();
}

void draw_output(const Snapshot&, Controls& controls) {
  PanelState& typed = controls.typed;
  draw_file(controls, typed.screenshot, "picture.png", {{"screenshot", "Picture"}});
  draw_file(controls, typed.sequence, "frames.####.png", {{"sequence", "Sequence"}});
  draw_file(controls, typed.turntable, "turntable.####.png", {{"turntable", "Turntable"}});
  draw_file(controls, typed.session, "session.json", {{"save", "Save"}, {"open", "Open"}});
  draw_file(controls, typed.state, "view.json", {{"save-state", "Save look"}, {"load-state", "Load look"}});
  draw_file(controls, typed.clip, "motion.glb, .bvh or .usda", {{"export-clip", "Motion"}});
  draw_file(controls, typed.skin, "skin.glb, .pc2, .mdd or .usda", {{"export-skin", "Skin"}});
  draw_file(controls, typed.open, "a basis, clip or cache", {{"open", "Open"}});
}

}  // namespace bodyopt::viewport
