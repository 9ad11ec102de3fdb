// A brush that sculpts a skin.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/surface_distance.h"

namespace bodyopt {

enum class BrushKind { grab, smooth, inflate, flatten, erase };
inline constexpr std::array kBrushKindNames{"grab", "smooth", "inflate", "flatten", "erase"};

struct Brush {
  BrushKind kind = BrushKind::grab;
  double radius = 0.05;   // along the skin: there it does nothing any more
  double strength = 0.5;  // 0 to 1; a grab follows the hand at 1
};

// Brushes on a skin: what they do to its vertices, touch by touch. Metres.

// One stroke. It may have several hands (a mirror image); what two of them hold follows their mean.
class BrushStroke {
 public:
  // surface: V x 3. erased: what erase leads back to. `paths` (of the surface) and `triangles` must outlive it.
  BrushStroke(const SurfaceDistance& paths, const Triangles& triangles, Positions surface, Positions erased,
              const Brush& brush);

  // Takes hold of the skin around points of it. All brushes but grab move it there, times the strength and a share that
  // falls from 1 at the point to 0 at the radius.
  //   Smooth: towards the mean of a vertex' neighbours, along its normal.
  //   Inflate: along the normals, by 5 % of the radius.
  //   Flatten: to the plane through the mean point, perpendicular to the mean normal.
  //   Erase: to where it is erased.
  void touch(std::span<const SkinPoint> hands);
  // Grab moves what each hand holds so far from where it was when it was touched. Other brushes do nothing.
  void pull(std::span<const Eigen::Vector3d> ways);

  const Positions& surface() const { return surface_; }

 private:
  struct Held {
    std::uint32_t vertex;
    double share;  // of the hand, from 0 to 1
  };
  using Hand = std::vector<Held>;

  Hand hold(const SkinPoint& point) const;
  Positions moves_of(const Hand& hand) const;
  Eigen::RowVector3d towards_neighbours(std::uint32_t vertex) const;
  void move(const std::vector<Positions>& moves);

  const SurfaceDistance& paths_;
  const Triangles& triangles_;
  Positions surface_, erased_, held_surface_;  // held: when it was touched
  Brush brush_;
  std::vector<Hand> hands_;
};

}  // namespace bodyopt
