// The brush over the dataset that is looked at: from pixels of the picture to strokes on the skin of its frame.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "draw/view.h"
#include "trainer/curate/frame_sculpting.h"
#include "viewport/commands/controls.h"
#include "viewport/curation.h"
#include "viewport/picking.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// The brush on the skin: a ring of its radius.
struct BrushRing {
  Vec3 centre, normal;  // metres, world; unit
  double radius;        // metres
  float x;              // pixel of the window: the view that it is seen in
};

class Brushing {
 public:
  // All must outlive it.
  Brushing(Scene& scene, const Controls& controls, const Curation& curation)
      : scene_(scene), controls_(controls), curation_(curation) {}

  // Whether there is anything to be brushed.
  bool is_ready() const { return curation_.is_open(); }
  // Pixels of the window; `area`: of the characters. Nothing is written before keep(). Takes hold of the skin; false:
  // there is none. Throws as FrameSculpting.
  bool press(const draw::Rectangle& area, const std::array<double, 2>& pixel);
  void drag(const draw::Rectangle& area, const std::array<double, 2>& pixel);  // what is pressed
  void release() { is_pressed_ = false; }
  bool is_pressed() const { return is_pressed_; }
  // Presses, drags and releases; throws Error(usage) where it begins beside the skin. Shares of the area.
  void stroke(const draw::Rectangle& area, const PicturePath& path);
  // The ring where the mouse is; none where a press would be refused.
  void hover(const draw::Rectangle& area, const std::array<double, 2>& pixel);
  void leave() { ring_.reset(); }

  // Writes what was brushed, where anything was. Returns what is to be said. Throws as FrameSculpting::keep(), and what
  // was brushed stays.
  std::vector<std::string> keep();
  // Forgets what was brushed: the frame is as it is in the dataset.
  void forget();
  bool has_change() const { return sculpting_ && sculpting_->has_change(); }

  // Returns how much every frame of the database takes of the last sculpted frame; empty: nothing was sculpted.
  const std::vector<double>& weights() const { return weights_; }
  const std::optional<BrushRing>& ring() const { return ring_; }

 private:
  struct Hit {
    SkinPoint point;
    Vec3 normal;
  };

  void take_up_frame();
  Brush brush() const;
  std::optional<Hit> hit(const draw::Rectangle& area, const std::array<double, 2>& pixel) const;
  bool touch(const draw::Rectangle& area, const std::array<double, 2>& pixel);
  double spacing(const draw::Rectangle& area, const std::array<double, 2>& pixel) const;
  void pull(const draw::Rectangle& area, const std::array<double, 2>& pixel);
  void show();

  Scene& scene_;
  const Controls& controls_;
  const Curation& curation_;
  std::optional<trainer::FrameSculpting> sculpting_;  // of the frame that was brushed last
  int shown_frame_ = 0;                               // as the clip counts it
  std::string modifier_;                              // that it is for
  std::optional<double> spread_;
  std::vector<float> skin_;  // V x 3: its skin
  std::vector<double> weights_;
  std::optional<BrushRing> ring_;
  Brush brush_;                      // of the stroke
  Vec3 held_{};                      // where it was touched, metres, world
  std::array<double, 2> touched_{};  // pixel
  double spacing_ = 1;               // pixels, from touch to touch
  bool is_pressed_ = false;
};

}  // namespace bodyopt::viewport
