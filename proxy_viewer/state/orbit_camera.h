// The viewport's camera: a turntable around a point, upright always.
#pragma once

#include <span>

#include "draw/camera.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Where an OrbitCamera stands.
struct OrbitView {
  Vec3 target{0, 0, 0};       // metres, world
  double distance = 3;        // metres, from the eye to the target
  double azimuth = 0;         // radians: 0 from the front (+z), pi / 2 from the character's left (+x)
  double elevation = 0;       // radians above the horizon
  bool orthographic = false;  // at the target things look as large as in perspective
  bool cut_away = false;      // what stands before the target is cut away

  bool operator==(const OrbitView&) const = default;
};

// Seen from +z (the character's front), -z, +x (its left), -x, +y, -y.
enum class AxisView { front, back, right, left, top, bottom };

class OrbitCamera {
 public:
  static constexpr double kSteepest = 1.52;                  // radians: nearer to the pole the turntable has no side
  static constexpr double kNearest = 0.01, kFarthest = 1e5;  // metres

  OrbitCamera() = default;
  // Numbers beyond the limits are brought within; beyond kSteepest it is the view from the top or the bottom. Throws
  // Error(usage) for numbers that are not finite.
  explicit OrbitCamera(const OrbitView& view);

  const OrbitView& view() const { return view_; }
  Camera camera() const;

  // Radians: the eye moves to the right and up around the target. Only view_axis() reaches the pole.
  void orbit(double right, double up);
  // Pixels that the cursor moved to the right and down, of a picture of `height` pixels (0: a window without a
  // picture, nothing moves): what is as deep as the target follows the cursor.
  void pan(double right, double down, double height);
  // Notches of a wheel: each goes a tenth of the way to the target; negative ones go back as far.
  void dolly(double notches);
  // Moves along the direction of view and across it until all points (V x 3, world, metres, at least one) are seen, as
  // large as they can be in `share` of the picture's height and width. `aspect`: width over height. Throws Error(usage)
  // as frame_points().
  void frame(std::span<const float> points, float aspect, double share = 1);
  // Eye and target, metres, world.
  void move(const Vec3& by) { view_.target = view_.target + by; }
  void view_axis(AxisView axis);
  void toggle_orthographic() { view_.orthographic = !view_.orthographic; }
  void toggle_cut_away() { view_.cut_away = !view_.cut_away; }

 private:
  OrbitView view_;
};

}  // namespace bodyopt
