// The panel on the right, its sections one above the other.
#include <algorithm>
#include <array>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "proxy_viewer/state/sections.h"

namespace bodyopt {
namespace {

using Draw = void (*)(const Snapshot&, Controls&);

// As kSections.
constexpr std::array<Draw, kSections.size()> kDraw = {draw_look, draw_cameras,   draw_compare, draw_curate, draw_pose,
                                                      draw_keys, draw_modifiers, draw_muscles, draw_jiggle, draw_ghosts,
                                                      draw_cast, draw_transfer,  draw_output};

}  // namespace

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

}  // namespace bodyopt
