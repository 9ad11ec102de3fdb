// The viewport's camera: a turntable around a point, upright always.
#pragma once

#include <span>

#include "assets/clips/clip.h"
#include "draw/camera.h"
#include "shots/session/view_settings.h"

namespace bodyopt::viewport {

// Seen from +z (the character's front), -z, +x (its left), -x, +y, -y.
enum class AxisView { front, back, right, left, top, bottom };

class OrbitCamera {
 public:
  static constexpr double kSteepest = 1.52;  // radians: nearer to the pole the turntable has no side

  OrbitCamera() = default;
  // Numbers beyond the limits are brought within; beyond kSteepest it is the view from the top or the bottom. Throws
  // Error(usage) for numbers that are not finite.
  explicit OrbitCamera(const shots::OrbitView& view);

  const shots::OrbitView& view() const { return view_; }
  draw::Camera camera() const;

  // Radians: the eye moves to the right and up around the target. Only view_axis() reaches the pole.
  void orbit(double right, double up);
  // Points as deep as the target follow the cursor, which moved so many pixels to the right and down. `height`: of the
  // picture, pixels (0: a window without a picture, nothing moves).
  void pan(double right, double down, double height);
  // Notches of a wheel: each goes a tenth of the way to the target; negative ones go back as far.
  void dolly(double notches);
  // Moves along the direction of view and across it until all points (V x 3, world, metres, at least one) are seen.
  // They are as large as `share` of the picture's height and width lets them be. `aspect`: width over height. Throws
  // Error(usage) as frame_points().
  void frame(std::span<const float> points, float aspect, double share = 1);
  // Takes a checked camera as it is, also by the pole and with a roll, from which the turntable keeps away.
  void look(const shots::OrbitView& view) { view_ = view; }
  // Eye and target, metres, world.
  void move(const Vec3& by) { view_.target = view_.target + by; }
  void view_axis(AxisView axis);  // as frame(): upright, and with the usual lens
  void toggle_orthographic() { view_.orthographic = !view_.orthographic; }

 private:
  void stand_upright();

  shots::OrbitView view_;
};

// Returns the view of a file's camera at one of its places; in perspective its target is as deep as the world's origin.
shots::OrbitView view_of(const ClipCamera& camera, std::size_t place);

}  // namespace bodyopt::viewport
