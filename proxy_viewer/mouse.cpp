#include "proxy_viewer/mouse.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "proxy_viewer/render/camera.h"

namespace bodyopt {
namespace {

constexpr float kClick = 4;         // pixels: less is no drag
constexpr double kPickRadius = 14;  // pixels

}  // namespace

void steer_by_mouse(const Scene& scene, const Rectangle& area, std::uint32_t height, Controls& controls) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  const double per_pixel = 3.2 / std::max(1u, height);  // half a turn across the window's height
  const double x = static_cast<double>(io.MouseDelta.x), y = static_cast<double>(io.MouseDelta.y);
  // Not with what moved before the button went down.
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
  if (ImGui::IsMouseReleased(0) && !dragged && controls.settings.look.skeleton) {
    controls.joint = joint_at(scene, controls, area, io.MousePos.x, io.MousePos.y);
  }
}

std::string joint_at(const Scene& scene, const Controls& controls, const Rectangle& picture, float x, float y) {
  const std::vector<Rectangle> views = scene.view_areas(controls.settings, picture);
  const Rectangle& area = x < static_cast<float>(views.back().x) ? views.front() : views.back();
  const Camera camera = controls.camera.camera();
  const auto rows = view_matrix(camera);
  const auto scale = projection(camera, {0, 1}, static_cast<double>(area.width) / std::max(1u, area.height));
  const std::vector<Vec3> centres = scene.joint_centres(controls);
  double nearest = kPickRadius;
  std::string joint;
  for (std::size_t j = 0; j < centres.size(); ++j) {
    double at[3];
    for (std::size_t r = 0; r < 3; ++r) {
      at[r] = static_cast<double>(rows[r][3]);
      for (std::size_t i = 0; i < 3; ++i) at[r] += static_cast<double>(rows[r][i]) * centres[j][i];
    }
    const double w = camera.orthographic_height > 0 ? 1 : -at[2];
    if (w <= 0) continue;
    const double px = area.x + 0.5 * area.width * (1 + static_cast<double>(scale[0]) * at[0] / w);
    const double py = area.y + 0.5 * area.height * (1 - static_cast<double>(scale[1]) * at[1] / w);
    const double distance = std::hypot(px - static_cast<double>(x), py - static_cast<double>(y));
    if (distance >= nearest) continue;
    nearest = distance;
    joint = scene.lead().basis().skeleton.joints[j].name;
  }
  return joint;
}

}  // namespace bodyopt
