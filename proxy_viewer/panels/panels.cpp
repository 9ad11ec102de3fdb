#include "proxy_viewer/panels.h"

#include <imgui.h>

#include <algorithm>

namespace bodyopt {

Rectangle draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height) {
  Layout layout{static_cast<float>(width), static_cast<float>(height), 0, 0, 0};
  if (controls.panels) {
    draw_menu_bar(snapshot, controls);
    layout.menu = ImGui::GetFrameHeight();
    layout.timeline = 74;
    draw_timeline(snapshot, controls, layout);
  }
  if (controls.settings.hud.on) draw_hud(snapshot, controls, layout);
  draw_messages(controls, layout);
  const auto pixels = [](float value) { return static_cast<std::uint32_t>(std::max(1.0f, value)); };
  return {0, static_cast<std::int32_t>(layout.menu), pixels(layout.width - layout.side),
          pixels(layout.height - layout.menu - layout.timeline)};
}

}  // namespace bodyopt
