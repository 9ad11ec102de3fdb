#include "viewport/brushing.h"

#include <algorithm>
#include <cmath>

#include "draw/camera.h"
#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 2s;     // nobody wants to look at a window that does not answer
constexpr double kSpacing = 0.25;  // from touch to touch, of the radius
constexpr double kClosest = 1;     // pixels

}  // namespace

// Takes up the frame that is shown; refuses while strokes on another are not kept.
void Brushing::take_up_frame() {
  curation_.require_open();
  if (controls_.curating.raw) {
    throw Error(ErrorKind::usage, "what is shown is before any modifier, as is no stroke: 'raw off'");
  }
  const BrushInHand& brush = controls_.brush;
  const std::size_t frame = curation_.number_of(controls_.playback.frame());
  const bool is_there = sculpting_ && &sculpting_->stack() == curation_.stack().get() && sculpting_->frame() == frame;
  if (is_there && modifier_ == brush.modifier && spread_ == brush.spread) return;
  if (has_change()) {
    throw Error(ErrorKind::usage,
                "what was brushed before is not kept yet: 'keep-strokes' writes it, 'undo-edit' forgets it");
  }
  sculpting_.emplace(curation_.stack(), frame, brush.modifier, brush.spread);
  shown_frame_ = controls_.playback.frame();
  modifier_ = brush.modifier;
  spread_ = brush.spread;
  weights_ = sculpting_->is_sculpted() ? sculpting_->weights() : std::vector<double>();
  skin_.assign(sculpting_->skin().data(), sculpting_->skin().data() + sculpting_->skin().size());
}

Brush Brushing::brush() const {
  return {*controls_.brush.kind, 1e-3 * controls_.brush.radius_mm, controls_.brush.strength};
}

std::optional<Brushing::Hit> Brushing::hit(const draw::Rectangle& area, const std::array<double, 2>& pixel) const {
  const Ray ray = ray_through(scene_, controls_, area, pixel);
  const Triangles& triangles = sculpting_->stack().database().character.triangles;
  const auto found = first_hit(ray, skin_, {triangles.data(), static_cast<std::size_t>(triangles.size())});
  if (!found) return std::nullopt;
  const auto t = static_cast<Eigen::Index>(found->triangle);
  Hit hit;
  hit.point.triangle = t;
  hit.point.weights = {found->weights[0], found->weights[1], found->weights[2]};
  hit.point.position = {found->at[0], found->at[1], found->at[2]};
  for (int k = 0; k < 3; ++k) hit.point.vertices[static_cast<std::size_t>(k)] = triangles(t, k);
  hit.normal = found->normal;
  return hit;
}

// Returns the distance between dabs, pixels: a part of the radius where it touches.
double Brushing::spacing(const draw::Rectangle& area, const std::array<double, 2>& pixel) const {
  const draw::Camera camera = controls_.camera.camera();
  const Vec3 right = draw::view_axes(camera).right;
  const auto x = static_cast<float>(pixel[0]);
  const auto middle = pixel_of(scene_, controls_, area, x, held_),
             side = pixel_of(scene_, controls_, area, x, held_ + brush_.radius * right);
  if (!middle || !side) return kClosest;
  return std::max(kClosest, kSpacing * std::hypot((*side)[0] - (*middle)[0], (*side)[1] - (*middle)[1]));
}

bool Brushing::press(const draw::Rectangle& area, const std::array<double, 2>& pixel) {
  take_up_frame();
  if (!hit(area, pixel)) return false;
  brush_ = brush();
  sculpting_->begin(brush_, controls_.brush.symmetric);
  touch(area, pixel);
  spacing_ = spacing(area, pixel);
  touched_ = pixel;
  is_pressed_ = true;
  return true;
}

bool Brushing::touch(const draw::Rectangle& area, const std::array<double, 2>& pixel) {
  const std::optional<Hit> at = hit(area, pixel);
  if (!at) return false;
  held_ = {at->point.position.x(), at->point.position.y(), at->point.position.z()};
  ring_ = BrushRing{held_, at->normal, brush_.radius, static_cast<float>(pixel[0])};
  sculpting_->touch(at->point);
  show();
  return true;
}

// Touches lie as close to each other however fast the mouse was; beside the skin there are none.
void Brushing::drag(const draw::Rectangle& area, const std::array<double, 2>& pixel) {
  if (!is_pressed_) return;
  if (brush_.kind == BrushKind::grab) return pull(area, pixel);
  for (;;) {
    const double x = pixel[0] - touched_[0], y = pixel[1] - touched_[1], way = std::hypot(x, y);
    if (way < spacing_) return;
    touched_[0] += x * spacing_ / way;
    touched_[1] += y * spacing_ / way;
    touch(area, touched_);
  }
}

// The point that is held stays under the mouse, as far away as it was.
void Brushing::pull(const draw::Rectangle& area, const std::array<double, 2>& pixel) {
  const auto to = moved_under_pixel(scene_, controls_, area, static_cast<float>(pixel[0]), pixel, held_);
  if (!to) return;
  const Vec3 way = *to - held_;
  sculpting_->pull({way[0], way[1], way[2]});
  ring_->centre = held_ + brush_.strength * way;
  show();
}

void Brushing::show() {
  const trainer::ShapeStack& stack = sculpting_->stack();
  skin_.assign(sculpting_->skin().data(), sculpting_->skin().data() + sculpting_->skin().size());
  scene_.lead().show_sculpted(shown_frame_, output_from_welded(stack.database().character, sculpting_->skin()));
  weights_ = sculpting_->weights();
}

void Brushing::stroke(const draw::Rectangle& area, const PicturePath& path) {
  const auto pixel = [&](const std::array<double, 2>& shares) {
    return std::array{area.x + shares[0] * area.width, area.y + shares[1] * area.height};
  };
  if (!press(area, pixel(path.front()))) {
    throw Error(ErrorKind::usage, "the stroke begins beside the skin: nothing was brushed");
  }
  for (std::size_t k = 1; k < path.size(); ++k) drag(area, pixel(path[k]));
  release();
}

void Brushing::hover(const draw::Rectangle& area, const std::array<double, 2>& pixel) {
  ring_.reset();
  try {
    take_up_frame();
  } catch (const Error&) {
    return;
  }
  const std::optional<Hit> at = hit(area, pixel);
  if (!at) return;
  const Eigen::Vector3d& p = at->point.position;
  ring_ = BrushRing{{p.x(), p.y(), p.z()}, at->normal, brush().radius, static_cast<float>(pixel[0])};
}

std::vector<std::string> Brushing::keep() {
  if (!has_change()) return {};
  std::vector<std::string> notes = sculpting_->keep(kPatience);
  sculpting_.reset();
  return notes;
}

void Brushing::forget() {
  sculpting_.reset();
  is_pressed_ = false;
}

}  // namespace bodyopt::viewport
