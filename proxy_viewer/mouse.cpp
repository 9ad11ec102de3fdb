#include "proxy_viewer/mouse.h"

#include <imgui.h>

#include <algorithm>
#include <utility>

#include "proxy_viewer/commands/commands.h"
#include "proxy_viewer/grips.h"
#include "proxy_viewer/picking.h"

namespace bodyopt {
namespace {

constexpr float kClick = 4;  // pixels: less is no drag

// First one of the lead, then the same of the other.
void mark(Scene& scene, const Rectangle& area, Controls& controls) {
  const ImVec2 at = ImGui::GetIO().MousePos;
  const std::optional<PickedVertex> picked = vertex_at(scene, controls, area, at.x, at.y);
  if (!picked) return;
  Marking& marking = controls.marking;
  if (picked->character == 0) {
    marking.of_lead = picked->vertex;
  } else if (marking.of_lead) {
    add_marker(controls, {*std::exchange(marking.of_lead, std::nullopt), picked->vertex});
  } else {
    controls.say("first a vertex of " + scene.lead().name() + ", then the same of the other");
  }
}

// Where joints are not shown, the skin is what can be picked; from then on they are.
void pick(Scene& scene, const Rectangle& area, Controls& controls) {
  if (controls.marking.on) return controls.attempt([&] { mark(scene, area, controls); });
  const ImVec2 at = ImGui::GetIO().MousePos;
  bool& skeleton = controls.settings.look.skeleton;
  controls.joint = skeleton ? joint_at(scene, controls, area, at.x, at.y) : "";
  controls.attempt([&] {
    if (controls.joint.empty()) controls.joint = joint_under_skin_at(scene, controls, area, at.x, at.y);
  });
  if (controls.joint.empty()) return;
  skeleton = true;
  controls.settings.hud.panels["pose"] = true;  // which turns it
}

}  // namespace

void steer_by_mouse(Scene& scene, const Rectangle& area, std::uint32_t height, Controls& controls) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  const double per_pixel = 3.2 / std::max(1u, height);  // half a turn across the window's height
  const double x = static_cast<double>(io.MouseDelta.x), y = static_cast<double>(io.MouseDelta.y);
  // Not with what moved before the button went down.
  if (ImGui::IsMouseClicked(0) && !io.KeyShift) {
    controls.grip = grip_at(scene, controls, area, io.MousePos.x, io.MousePos.y);
  }
  if (controls.grip && (io.MouseDown[0] || ImGui::IsMouseReleased(0))) {
    drag_grip(scene, area, {io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y},
              {io.MousePos.x, io.MousePos.y}, controls);
    if (ImGui::IsMouseReleased(0)) controls.grip.reset();
    return;
  }
  const auto drags = [&](int button) { return io.MouseDown[button] && io.MouseDownDuration[button] > 0; };
  if (drags(2) || (drags(0) && io.KeyShift)) {
    controls.camera.pan(x, y, static_cast<double>(area.height));
  } else if (drags(0)) {
    controls.camera.orbit(-x * per_pixel, y * per_pixel);
  } else if (drags(1)) {
    controls.camera.dolly(0.03 * (x - y));
  }
  if (io.MouseWheel != 0) controls.camera.dolly(static_cast<double>(io.MouseWheel));
  const bool dragged = io.MouseDragMaxDistanceSqr[0] >= kClick * kClick;  // and be it back again
  if (ImGui::IsMouseReleased(0) && !dragged) pick(scene, area, controls);
}

}  // namespace bodyopt
