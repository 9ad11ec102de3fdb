#include "viewport/mouse.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "draw/camera.h"
#include "shots/session/pinned_joints.h"
#include "viewport/commands/commands.h"
#include "viewport/picking.h"
#include "viewport/scene/turn_rings.h"

namespace bodyopt::viewport {
namespace {

constexpr double kGripped = 6;  // pixels

double apart(const std::optional<std::array<double, 2>>& pixel, float x, float y) {
  return pixel ? std::hypot((*pixel)[0] - static_cast<double>(x), (*pixel)[1] - static_cast<double>(y)) : 1e9;
}

// Returns a pixel's angle around the middle, counter-clockwise as seen.
double angle_around(const std::array<double, 2>& middle, const std::array<float, 2>& pixel) {
  return std::atan2(middle[1] - static_cast<double>(pixel[1]), static_cast<double>(pixel[0]) - middle[0]);
}

void turn_ring(const Scene& scene, const draw::Rectangle& picture, const TurnRing& ring,
               const std::array<float, 2>& from, const std::array<float, 2>& to, Controls& controls) {
  const auto middle = pixel_of(scene, controls, picture, from[0], ring.centre);
  if (!middle) return;
  const double by = std::remainder(angle_around(*middle, to) - angle_around(*middle, from), 2 * std::numbers::pi);
  const draw::Camera camera = controls.camera.camera();
  const bool is_towards = dot(ring.along, draw::to_double(camera.eye) - ring.centre) > 0;
  const double turned = std::clamp(ring.angle + (is_towards ? 1 : -1) * by * 180 / std::numbers::pi, ring.low,
                                   std::max(ring.low, ring.high));
  std::map<std::string, Vec3>& joints = controls.settings.pose.joints;
  for (const std::string& joint : controls.also) joints[joint][ring.axis] += turned - ring.angle;
  joints[controls.joint][ring.axis] = turned;
}

void move_pin(const Scene& scene, const draw::Rectangle& picture, const std::array<float, 2>& to, Controls& controls) {
  Vec3& pin = controls.settings.pose.pins.at(controls.joint);
  pin = moved_under_pixel(scene, controls, picture, to[0], {to[0], to[1]}, pin).value_or(pin);
}

// Moves the joint along the axis, as far as the mouse went along it in the picture.
void move_along(const Scene& scene, const draw::Rectangle& picture, const MoveArrow& arrow,
                const std::array<float, 2>& from, const std::array<float, 2>& to, Controls& controls) {
  const auto tail = pixel_of(scene, controls, picture, from[0], arrow.from),
             head = pixel_of(scene, controls, picture, from[0], arrow.to);
  if (!tail || !head) return;
  const double right = (*head)[0] - (*tail)[0], down = (*head)[1] - (*tail)[1];
  const double pixels = right * right + down * down;
  if (pixels < 1) return;  // it is seen from its end
  const double share =
      (right * static_cast<double>(to[0] - from[0]) + down * static_cast<double>(to[1] - from[1])) / pixels;
  Vec3& moved = controls.settings.pose.moves[controls.joint];
  moved = moved + share * (arrow.to - arrow.from);
}

// Moves the joint with the mouse, at its own distance from the eye.
void move_under_mouse(const Scene& scene, const draw::Rectangle& picture, const Vec3& at,
                      const std::array<float, 2>& from, const std::array<float, 2>& to, Controls& controls) {
  const auto point = [&](const std::array<float, 2>& pixel) {
    return moved_under_pixel(scene, controls, picture, from[0], {pixel[0], pixel[1]}, at);
  };
  const auto before = point(from), after = point(to);
  if (!before || !after) return;
  Vec3& moved = controls.settings.pose.moves[controls.joint];
  moved = moved + (*after - *before);
}

// Returns the distance from a line, pixels.
double apart_from_line(const std::array<double, 2>& a, const std::array<double, 2>& b, float x, float y) {
  const double right = b[0] - a[0], down = b[1] - a[1], size = std::max(1e-9, right * right + down * down);
  const double share =
      std::clamp((right * (static_cast<double>(x) - a[0]) + down * (static_cast<double>(y) - a[1])) / size, 0.0, 1.0);
  return apart(std::array{a[0] + share * right, a[1] + share * down}, x, y);
}

// Returns the grip of a joint that may move: itself, or an arrow beyond the rings.
std::optional<Grip> move_grip_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                                 float y) {
  constexpr double kShaft = 0.75;  // of the arrow: from there on nothing else is near
  for (const MoveArrow& arrow : move_arrows(scene, controls)) {
    const auto tail = pixel_of(scene, controls, picture, x, arrow.from);
    if (apart(tail, x, y) < 1.5 * kGripped) return Grip{Grip::Kind::joint};
    const auto from = pixel_of(scene, controls, picture, x, arrow.from + kShaft * (arrow.to - arrow.from)),
               head = pixel_of(scene, controls, picture, x, arrow.to);
    if (from && head && apart_from_line(*from, *head, x, y) < kGripped) return Grip{Grip::Kind::arrow, arrow.axis};
  }
  return std::nullopt;
}

// Returns the grip under a pixel; none: nothing is there that can be dragged.
std::optional<Grip> grip_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                            float y) {
  if (!controls.settings.look.skeleton || controls.joint.empty()) return std::nullopt;
  const auto pin = controls.settings.pose.pins.find(controls.joint);
  if (pin != controls.settings.pose.pins.end() &&
      apart(pixel_of(scene, controls, picture, x, pin->second), x, y) < 2 * kGripped) {
    return Grip{};
  }
  if (const std::optional<Grip> moves = move_grip_at(scene, controls, picture, x, y)) return moves;
  std::optional<Grip> grip;
  double nearest = kGripped;
  for (const TurnRing& ring : turn_rings(scene, controls)) {
    if (ring.low >= ring.high) continue;
    for (int degrees = 0; degrees < 360; degrees += 5) {
      const double away = apart(pixel_of(scene, controls, picture, x, ring.point(degrees)), x, y);
      if (away >= nearest) continue;
      nearest = away;
      grip = Grip{Grip::Kind::ring, ring.axis};
    }
  }
  return grip;
}

// Drags from one pixel to another: a ring turns by the angle around its middle. What is moved stays under the cursor,
// along its arrow or as far away as it was.
void drag_grip(const Scene& scene, const draw::Rectangle& picture, const std::array<float, 2>& from,
               const std::array<float, 2>& to, Controls& controls) {
  const auto [kind, axis] = *controls.grip;
  if (kind == Grip::Kind::pin) {
    if (controls.settings.pose.pins.contains(controls.joint)) move_pin(scene, picture, to, controls);
  } else if (kind == Grip::Kind::ring) {
    const std::vector<TurnRing> rings = turn_rings(scene, controls);
    if (!rings.empty()) turn_ring(scene, picture, rings[axis], from, to, controls);
  } else if (const std::vector<MoveArrow> arrows = move_arrows(scene, controls); !arrows.empty()) {
    if (kind == Grip::Kind::arrow) return move_along(scene, picture, arrows[axis], from, to, controls);
    move_under_mouse(scene, picture, arrows.front().from, from, to, controls);
  }
}

constexpr float kClick = 4;  // pixels: less is no drag

float pixels_a_point() { return ImGui::GetIO().DisplayFramebufferScale.x; }

ImVec2 pixels_of(const ImVec2& points) { return {pixels_a_point() * points.x, pixels_a_point() * points.y}; }

// Returns the pixel of the picture.
ImVec2 mouse_at() { return pixels_of(ImGui::GetIO().MousePos); }

// Marks a vertex of the lead first, then the same of the other.
void mark(Scene& scene, const draw::Rectangle& area, Controls& controls) {
  const ImVec2 at = mouse_at();
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

// Without joints in the picture, a click picks by the skin; from then on joints are shown.
void pick(Scene& scene, const draw::Rectangle& area, Controls& controls) {
  if (controls.marking.on) return controls.attempt([&] { mark(scene, area, controls); });
  const ImVec2 at = mouse_at();
  bool& skeleton = controls.settings.look.skeleton;
  std::string joint = skeleton ? joint_at(scene, controls, area, at.x, at.y) : "";
  controls.attempt([&] {
    if (joint.empty()) joint = joint_under_skin_at(scene, controls, area, at.x, at.y);
    if (ImGui::GetIO().KeyCtrl && !joint.empty()) return run_command(controls, "select-also " + joint);
    controls.select(joint);
  });
  if (joint.empty()) return;
  skeleton = true;
  controls.settings.hud.panels["pose"] = true;  // which turns it
  controls.typed.revealed_section = "pose";
}

std::array<double, 2> mouse_pixel() {
  const ImVec2 at = mouse_at();
  return {static_cast<double>(at.x), static_cast<double>(at.y)};
}

}  // namespace

std::optional<std::array<double, 2>> mouse_over_picture() {
  if (ImGui::GetIO().WantCaptureMouse || !ImGui::IsMousePosValid()) return std::nullopt;
  return mouse_pixel();
}

bool brush_by_mouse(Brushing& brushing, const draw::Rectangle& area, Controls& controls) {
  const ImGuiIO& io = ImGui::GetIO();
  if (brushing.is_pressed()) {
    controls.attempt([&] { brushing.drag(area, mouse_pixel()); });
    if (io.MouseDown[0]) return true;
    brushing.release();
    controls.requests.keep_strokes = true;
    return true;
  }
  if (!controls.brush.kind || controls.headless || !brushing.is_ready()) return false;
  if (io.WantCaptureMouse) {
    brushing.leave();
    return false;
  }
  bool brushes = false;
  controls.attempt([&] {
    if (ImGui::IsMouseClicked(0) && !io.KeyShift) brushes = brushing.press(area, mouse_pixel());
    if (!brushes && !io.MouseDown[0]) brushing.hover(area, mouse_pixel());
  });
  if (brushes) controls.playback.pause();
  return brushes;
}

void draw_brush(const Brushing& brushing, const Scene& scene, const draw::Rectangle& area, const Controls& controls) {
  constexpr int kSteps = 64;
  constexpr ImU32 kRing = IM_COL32(255, 180, 47, 230);
  const std::optional<BrushRing>& ring = brushing.ring();
  if (!ring || !controls.brush.kind) return;
  const draw::ViewAxes axes = draw::view_axes(ring->normal);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (int k = 0; k < kSteps; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSteps;
    const Vec3 at = ring->centre + ring->radius * (std::cos(angle) * axes.right + std::sin(angle) * axes.up);
    const auto pixel = pixel_of(scene, controls, area, ring->x, at);
    if (!pixel) continue;
    list.PathLineTo(
        {static_cast<float>((*pixel)[0]) / pixels_a_point(), static_cast<float>((*pixel)[1]) / pixels_a_point()});
  }
  list.PathStroke(kRing, ImDrawFlags_Closed, 1.5f);
}

void steer_by_mouse(Scene& scene, const draw::Rectangle& area, std::uint32_t height, Controls& controls) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  const double per_pixel = 3.2 / std::max(1u, height);  // half a turn across the window's height
  const ImVec2 at = mouse_at(), by = pixels_of(io.MouseDelta);
  const double x = static_cast<double>(by.x), y = static_cast<double>(by.y);
  // A grip is not dragged by what moved before the button went down.
  if (ImGui::IsMouseClicked(0) && !io.KeyShift) {
    controls.grip = grip_at(scene, controls, area, at.x, at.y);
  }
  if (controls.grip && (io.MouseDown[0] || ImGui::IsMouseReleased(0))) {
    drag_grip(scene, area, {at.x - by.x, at.y - by.y}, {at.x, at.y}, controls);
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

}  // namespace bodyopt::viewport
