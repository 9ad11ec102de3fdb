// When the errors of the lead are measured, and where they are worst.
#pragma once

#include <span>

#include "proxy_viewer/compare/error_curve.h"
#include "proxy_viewer/scene/scene.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

class ErrorMeasuring {
 public:
  // Both must outlive it. `while_playing`: where it costs no pictures.
  ErrorMeasuring(Scene& scene, Controls& controls, bool while_playing)
      : scene_(scene), controls_(controls), while_playing_(while_playing) {}

  const ErrorCurve& curve() const { return curve_; }
  void forget() { curve_.forget(); }  // files have changed

  // Notices what is compared now.
  void look();
  bool has_work() const;
  // For as long as nobody notices; at least a frame, where there is one left. These throw as measure_next().
  void measure_some();
  void measure_shown_frame();
  void measure_all();

  const FrameError* shown_error() const;  // of the frame that is shown; null: not measured, or nothing to measure

  // Pauses there, and says so where not all frames are measured. These throw Error(usage) where nothing is compared.
  void go_to_worst_frame();
  void go_to_worst_vertex();  // looked at along its normal

 private:
  bool is_possible() const;
  std::size_t shown_index() const;  // of the frame that is shown
  bool measure_next() { return curve_.measure_next(scene_.lead(), controls_.playback.frame()); }
  void require_comparison();
  Vec3 worst_normal(const FrameError& error);

  Scene& scene_;
  Controls& controls_;
  bool while_playing_;
  ErrorCurve curve_;
};

// Of the skin at a vertex, output vertex order: unit, outwards; zero where the triangles around it have no area.
Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex);

}  // namespace bodyopt
