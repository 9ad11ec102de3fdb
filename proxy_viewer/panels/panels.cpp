#include "proxy_viewer/panels/panels.h"

#include <algorithm>
#include <array>

#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kSide = 272, kNarrowSide = 216;   // width of the side panel
constexpr float kNarrow = 900, kNarrowest = 560;  // windows: below, it is narrower, or there is no room for it
constexpr float kTimeline = 84, kLowest = 240;    // height; below that of windows there is no room for it

PanelLayout layout_of(const Controls& controls, float width, float height) {
  PanelLayout layout{width, height, 0, 0, 0};
  if (!controls.panels) return layout;
  layout.menu = ImGui::GetFrameHeight();
  if (height >= kLowest) layout.timeline = kTimeline;
  if (width >= kNarrowest && shows_side_panel(controls.settings)) layout.side = width < kNarrow ? kNarrowSide : kSide;
  return layout;
}

using Draw = void (*)(const Snapshot&, Controls&);

// As kSections.
constexpr std::array<Draw, kSections.size()> kDraw = {draw_look, draw_cameras,   draw_compare, draw_curate, draw_pose,
                                                      draw_keys, draw_modifiers, draw_muscles, draw_jiggle, draw_ghosts,
                                                      draw_cast, draw_transfer,  draw_output};

// The panel on the right, its sections one above the other.
void draw_side_panel(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout) {
  ImGui::SetNextWindowPos({layout.right(), layout.menu});
  ImGui::SetNextWindowSize({layout.side, std::max(1.0f, layout.bottom() - layout.menu - layout.messages)});
  ImGui::Begin("Side", nullptr, kFixedWindow);
  for (std::size_t k = 0; k < kSections.size(); ++k) {
    const Section& section = kSections[k];
    if (kDraw[k] == draw_curate && !snapshot.curation) continue;
    if (kDraw[k] == draw_transfer && snapshot.cast.size() < 2) continue;
    const bool was_open = is_open(controls.settings, section);
    ImGui::SetNextItemOpen(was_open, ImGuiCond_Always);
    const bool open = ImGui::CollapsingHeader(section.title);
    if (controls.typed.revealed_section == section.name) {
      ImGui::SetScrollHereY(0);
      controls.typed.revealed_section.clear();
    }
    if (open != was_open) controls.settings.hud.panels[section.name] = open;
    if (!open) continue;
    ImGui::PushID(section.name);
    kDraw[k](snapshot, controls);
    ImGui::PopID();
    ImGui::Spacing();
  }
  ImGui::End();
}

}  // namespace

Rectangle draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height) {
  PanelLayout layout = layout_of(controls, static_cast<float>(width), static_cast<float>(height));
  if (controls.panels) draw_menu_bar(snapshot, controls);
  draw_messages(controls, layout);
  if (layout.timeline > 0) draw_timeline(snapshot, controls, layout);
  if (layout.side > 0) draw_side_panel(snapshot, controls, layout);
  draw_comparison(snapshot, controls, layout);
  if (controls.settings.hud.legend) {
    draw_colour_bar(snapshot, controls, layout);
    draw_colour_keys(snapshot, controls, layout);
  }
  if (controls.settings.hud.on) draw_hud(snapshot, controls, layout);
  if (controls.prompt) draw_prompt(controls, layout);
  if (controls.dialog) draw_file_dialog(controls, layout);
  if (controls.cheat_sheet) draw_cheat_sheet(controls, layout);
  const auto pixels = [](float value) { return static_cast<std::uint32_t>(std::max(1.0f, value)); };
  return {0, static_cast<std::int32_t>(layout.menu), pixels(layout.right()), pixels(layout.bottom() - layout.menu)};
}

void draw_loading(const std::string& text) {
  const ImVec2 all = ImGui::GetIO().DisplaySize, size = ImGui::CalcTextSize(text.c_str());
  ImGui::GetBackgroundDrawList()->AddText({0.5f * (all.x - size.x), 0.5f * (all.y - size.y)},
                                          ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
}

void visit_texts(const Snapshot& snapshot, const Controls& controls,
                 const std::function<void(const std::string&)>& visit) {
  for (const CharacterRow& row : snapshot.cast) {
    for (const std::string* text : {&row.name, &row.basis, &row.clip, &row.truth}) visit(*text);
  }
  for (const JointRow& row : snapshot.joints) visit(row.name);
  for (const ControlRow& row : snapshot.controls) visit(row.name);
  for (const std::string& fibre : snapshot.fibres) visit(fibre);
  if (snapshot.curation) {
    for (const StackRow& row : snapshot.curation->modifiers) visit(row.name);
    for (const PoseDot& dot : snapshot.curation->dots) visit(dot.text);
    for (const std::string& pair : snapshot.curation->pairs) visit(pair);
    for (const std::string& region : controls.curating.regions) visit(region);
  }
  visit(snapshot.outside_feature);
  visit(snapshot.device);
  for (const auto& [name, view] : controls.settings.cameras) visit(name);
  const PanelState& typed = controls.typed;
  for (const std::string* text : {&typed.prompt, &typed.joint_filter, &typed.camera, &typed.open, &typed.screenshot,
                                  &typed.sequence, &typed.turntable, &typed.state}) {
    visit(*text);
  }
  visit(controls.brush.modifier);
  if (controls.dialog) {
    visit(controls.dialog->folder.string());
    visit(controls.dialog->name);
    for (const FolderEntry& entry : controls.dialog->entries) visit(entry.name);
  }
  for (const Message& message : controls.messages) visit(message.text);
}

}  // namespace bodyopt
