// Finds what of the lead is under a pixel of the window.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "draw/view.h"
#include "viewport/commands/controls.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Returns the pixel at which the view of the picture at `x` shows a point of the world; none: behind the eye.
std::optional<std::array<double, 2>> pixel_of(const Scene& scene, const Controls& controls,
                                              const draw::Rectangle& picture, float x, const Vec3& point);

// The area of the view of the picture that is at `x`.
draw::Rectangle view_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x);

// The joint whose centre is seen nearest to (x, y), in the view that is there; "": none is near.
std::string joint_at(const Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x, float y);

// The joint that is nearest to where the skin is seen at (x, y); "": no skin is there. Jiggle is left out. Throws as
// Actor::measure().
std::string joint_under_skin_at(Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                                float y);

// A vertex of one of the cast, as its file has it.
struct PickedVertex {
  std::size_t character;
  std::uint32_t vertex;
};
// Returns the vertex, of the lead or the second of the cast, nearest to the skin at (x, y); none: no skin is there.
std::optional<PickedVertex> vertex_at(Scene& scene, const Controls& controls, const draw::Rectangle& picture, float x,
                                      float y);

// A point is from + t along.
struct Ray {
  Vec3 from, along;
  double least = 0;  // of t
};

// Returns the ray through a pixel, in the view that is there.
Ray ray_through(const Scene& scene, const Controls& controls, const draw::Rectangle& picture,
                const std::array<double, 2>& pixel);

// Moves a point to where the view at `x` shows it at a pixel, as far from the eye as it was; none: nowhere.
std::optional<Vec3> moved_under_pixel(const Scene& scene, const Controls& controls, const draw::Rectangle& picture,
                                      float x, const std::array<double, 2>& pixel, const Vec3& point);

struct RayHit {
  Vec3 at, normal;  // the triangle's, unit, towards where the ray comes from
  std::size_t triangle;
  std::array<double, 3> weights;  // barycentric
};

// Returns the first hit of a triangle, from either side. V x 3; T x 3.
std::optional<RayHit> first_hit(const Ray& ray, std::span<const float> vertices,
                                std::span<const std::uint32_t> triangles);

}  // namespace bodyopt::viewport
