#include "trainer/anatomy/posed_section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/nearest_skin.h"
#include "trainer/anatomy/pixels_inside.h"

namespace bodyopt {
namespace {

Eigen::Affine3d affine(const Affine& transform) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = transform.m[i][k];
    }
  }
  return result;
}

class BackToRest {
 public:
  explicit BackToRest(const PosedBody& body) : body_(body), nearest_(body.skin, body.character.triangles) {
    for (const Affine& joint : body.skinning) skinning_.push_back(affine(joint));
  }

  // Nothing where the joints blend to no space at all.
  std::optional<RestPoint> operator()(const Eigen::Vector3d& point) const {
    constexpr double kFade = 8;  // times what the skin is off by: so slowly that nothing folds over
    const SkinPoint skin = nearest_(point);
    Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
    Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = skin.weights[static_cast<Eigen::Index>(k)];
      at_rest += share * body_.character.vertices.row(skin.vertices[k]).transpose();
      for (const JointWeight& of : body_.character.weights[skin.vertices[k]]) {
        blend += share * of.weight * skinning_[of.joint].matrix();
      }
    }
    const Eigen::Affine3d back(Eigen::Affine3d(blend).inverse());
    if (!back.matrix().allFinite()) return std::nullopt;
    const Eigen::Vector3d off = at_rest - back * skin.position;
    const double depth = (point - skin.position).norm(), reach = kFade * off.norm();
    const double share = depth < reach ? 1 - depth / reach : 0;
    return RestPoint{back * point + share * off};
  }

 private:
  const PosedBody& body_;
  NearestSkin nearest_;
  std::vector<Eigen::Affine3d> skinning_;
};

}  // namespace

SectionPlane moved_plane(const SectionPlane& plane, const Affine& joint) {
  const Eigen::Affine3d move = affine(joint);
  SectionPlane moved = plane;
  moved.corner = move * plane.corner;
  moved.right = (move.linear() * plane.right).normalized();
  const Eigen::Vector3d down = move.linear() * plane.down;
  moved.down = (down - down.dot(moved.right) * moved.right).normalized();
  return moved;
}

RestPoints rest_points(const SectionPlane& plane, const PosedBody& body) {
  RestPoints points(static_cast<std::size_t>(plane.size()));
  const std::vector<bool> inside = pixels_inside(plane, body.skin, body.character.triangles);
  const BackToRest back(body);
  parallel_for(static_cast<std::size_t>(plane.height), [&](std::size_t y) {
    const auto width = static_cast<std::size_t>(plane.width);
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel) {
      if (inside[pixel]) points[pixel] = back(plane.middle(static_cast<int>(pixel)));
    }
  });
  return points;
}

}  // namespace bodyopt
