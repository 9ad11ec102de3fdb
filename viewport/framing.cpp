#include "viewport/framing.h"

#include <algorithm>
#include <utility>

namespace bodyopt::viewport {

void Framing::frame_selection(std::uint32_t width, std::uint32_t height, Covered covered) {
  controls_.requests.frame_selection = false;
  frame_points(scene_.points_to_frame(controls_), width, height, covered);
}

void Framing::keep_framed(std::uint32_t width, std::uint32_t height, Covered covered) {
  const std::size_t views = scene_.view_areas(controls_.settings, {0, 0, width, height}).size();
  const bool turns = std::exchange(controls_.requests.keep_framed, false);
  if (!framed_ || (!turns && views == framed_->views && covered == framed_->covered)) return;
  const shots::OrbitView now = controls_.kept_camera(), &then = framed_->camera;
  // Turned, it still looks at the middle of what was framed.
  const bool stayed = length(now.target - then.target) < 1e-6 * then.distance && now.distance == then.distance;
  if (!stayed) return framed_.reset();
  look_at(framed_->points, width, height, covered);
  controls_.go_to_camera(controls_.camera.view());
  framed_->camera = controls_.kept_camera();
  framed_->views = views;
  framed_->covered = covered;
}

void Framing::frame_range(std::uint32_t width, std::uint32_t height) {
  constexpr int kLooks = 12;
  controls_.requests.frame_selection = false;
  Playback& playback = controls_.playback;
  const int shown = playback.frame(), first = playback.in(), last = playback.out();
  const Vec3 here = scene_.whereabouts(shown);
  const std::string joint = std::exchange(controls_.joint, "");  // all are to be seen, not it alone
  std::vector<float> points;
  for (int look = 0; look <= kLooks; ++look) {
    playback.scrub(first + look * (last - first) / kLooks);
    const Vec3 gone = controls_.settings.look.follow ? scene_.whereabouts(playback.frame()) - here : Vec3{0, 0, 0};
    const std::vector<float> some = scene_.points_to_frame(controls_);
    for (std::size_t k = 0; k < some.size(); ++k) points.push_back(some[k] - static_cast<float>(gone[k % 3]));
  }
  playback.scrub(shown);
  controls_.joint = joint;
  frame_points(std::move(points), width, height, {});
}

void Framing::follow() {
  const Vec3 at = scene_.whereabouts(controls_.playback.frame());
  if (followed_ && controls_.settings.look.follow) controls_.camera.move(at - *followed_);
  followed_ = at;
  controls_.travelled = at - scene_.whereabouts(scene_.lead().clip().first_frame);
  controls_.follow_shot_camera();
}

void Framing::frame_points(std::vector<float> points, std::uint32_t width, std::uint32_t height, Covered covered) {
  if (points.empty()) return;
  look_at(points, width, height, covered);
  const Vec3 travelled = controls_.settings.look.follow ? controls_.travelled : Vec3{0, 0, 0};
  for (std::size_t k = 0; k < points.size(); ++k) points[k] -= static_cast<float>(travelled[k % 3]);
  const std::size_t views = scene_.view_areas(controls_.settings, {0, 0, width, height}).size();
  framed_ = Framed{controls_.kept_camera(), views, covered, std::move(points)};
}

// A covered side leaves as much free on the other, so that the middle stays the middle.
void Framing::look_at(const std::vector<float>& points, std::uint32_t width, std::uint32_t height, Covered covered) {
  const auto without = [](std::uint32_t size, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t taken = 2 * std::max(a, b);
    return size > taken ? size - taken : size;
  };
  const std::uint32_t free = without(height, covered.top, covered.bottom);
  const draw::Rectangle view =
      scene_.view_areas(controls_.settings, {0, 0, width, free}).front();  // the first of the picture
  const auto across = static_cast<float>(std::max(1u, without(view.width, covered.left, covered.right)));
  controls_.camera.frame(points, across / static_cast<float>(std::max(1u, free)),
                         static_cast<double>(free) / std::max(1u, height));
}

}  // namespace bodyopt::viewport
