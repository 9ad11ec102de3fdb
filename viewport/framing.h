// The camera on what is open: what it frames, and how it goes along.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "viewport/commands/controls.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Pixels at the edges of a picture over which something stands.
struct Covered {
  std::uint32_t top = 0, right = 0, bottom = 0, left = 0;
  bool operator==(const Covered&) const = default;
};

class Framing {
 public:
  // Both must outlive it.
  Framing(Scene& scene, Controls& controls) : scene_(scene), controls_(controls) {}

  // Frames all, or the selected joint, in a picture of so many pixels.
  void frame_selection(std::uint32_t width, std::uint32_t height, Covered covered = {});
  // Frames the same again after a comparison, or what stands over it, changed the free part of the picture. A camera
  // that was moved nearer, further away or aside stays; one that was turned frames from where it is.
  void keep_framed(std::uint32_t width, std::uint32_t height, Covered covered = {});
  // Frames so that nothing leaves the picture in the frames that are played (thirteen are looked at).
  void frame_range(std::uint32_t width, std::uint32_t height);
  // Moves the camera along with the lead since the picture before, or with the shot.
  void follow();
  void forget_lead() { followed_.reset(); }  // another leads: the camera does not move along to it

 private:
  void frame_points(std::vector<float> points, std::uint32_t width, std::uint32_t height, Covered covered);
  void look_at(const std::vector<float>& points, std::uint32_t width, std::uint32_t height, Covered covered);

  Scene& scene_;
  Controls& controls_;
  std::optional<Vec3> followed_;  // where the lead was in the last picture
  struct Framed {
    shots::OrbitView camera;  // as it is kept
    std::size_t views;
    Covered covered;
    std::vector<float> points;  // V x 3, metres, as the camera is kept
  };
  std::optional<Framed> framed_;  // by the last framing
};

}  // namespace bodyopt::viewport
