// The lead's distance from what it is compared with, for every frame of its clip. It is measured while there is time,
// and kept until something changes that it depends on. Also its worst frame, and the error in the hottest colour.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Vertex distances, mm; not a number: not measured, or nothing to measure. As everywhere the root's motion, which both
// sides share, is taken out by the subtraction.
struct FrameError {
  float rms = std::numeric_limits<float>::quiet_NaN(), max = rms, p99 = rms;
  std::uint32_t worst_vertex = 0;  // that is furthest off, output order
  Vec3 worst{};                    // where it is, metres, world
};

// Both V x 3, metres.
FrameError frame_error(std::span<const float> shown, std::span<const float> compared);

class ErrorCurve {
 public:
  // Chooses what is measured. Forgets what was measured of anything else, and returns whether it did.
  bool look_at(const Actor& character, const shots::ViewSettings& settings);
  void forget();  // files have changed

  // One more frame: `frame`, where it was not measured, or one far from those that were. False when all are. Throws
  // Error(file) of a truth that went away, and then measures no more.
  bool measure_next(Actor& character, int frame);

  // Per frame of the clip; none where nothing is compared.
  const std::vector<FrameError>& errors() const { return errors_; }
  bool is_measured(std::size_t index) const { return is_measured_[index]; }
  std::size_t measured_count() const { return measured_; }
  bool is_complete() const { return measured_ == errors_.size(); }
  std::optional<std::size_t> worst() const;  // of those that were measured: its index
  std::optional<float> largest_p99() const;  // of those, mm

 private:
  // Jiggle has a past that a single frame does not: measured is what it swings about.
  struct Subject {
    SkinMethod shown, compared;
    shots::ViewSettings::Posing posing;
    bool operator==(const Subject&) const = default;
  };

  void begin(std::size_t count);
  std::optional<std::size_t> next(std::optional<std::size_t> wanted);

  std::optional<Subject> subject_;
  std::vector<FrameError> errors_;
  std::vector<bool> is_measured_;
  std::size_t measured_ = 0;
  std::size_t stride_ = 0, cursor_ = 0;  // of the frames that come next
};

// The next 1, 2 or 5 times a power of ten, within what the scale can be set to.
double round_heat(double mm);

// Chooses the scale of errors, where the animator gives none.
class HeatScale {
 public:
  // `p99_mm`: what 99 of 100 vertices are below; none: it is not known. Gives millimetres. While frames follow each
  // other they only rise: colours shall mean the same, but a clip may begin at rest, where nothing is off.
  double choose(std::optional<double> p99_mm, bool playing);

 private:
  double mm_ = 10;
  bool is_chosen_ = false;
};

// When the errors are measured, and where they are worst.
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
  // Measures for as long as nobody notices; at least a frame, where there is one left. These throw as measure_next().
  void measure_some();
  void measure_shown_frame();
  void measure_all();

  const FrameError* shown_error() const;  // of the frame that is shown; null: not measured, or nothing to measure

  // Pauses there, and reports where frames are unmeasured. These throw Error(usage) where nothing is compared.
  void go_to_worst_frame();
  void go_to_worst_vertex();  // looked at along its normal

 private:
  bool is_possible() const;
  std::size_t shown_index() const;  // of the frame that is shown
  bool measure_next() { return curve_.measure_next(scene_.lead(), controls_.playback.frame()); }
  void require_comparison();

  Scene& scene_;
  Controls& controls_;
  bool while_playing_;
  ErrorCurve curve_;
};

// Returns the skin's normal at a vertex, output vertex order: unit, outwards; zero where its triangles have no area.
Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex);

}  // namespace bodyopt::viewport
