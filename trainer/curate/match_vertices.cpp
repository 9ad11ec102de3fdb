#include "trainer/curate/match_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "assets/clips/axis_turns.h"
#include "assets/clips/joint_roles.h"
#include "base/wording.h"
#include "geometry/spatial_search.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
// The corner that a triangle has beside a directed edge; -1 where two triangles claim it.
using Opposite = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

Opposite opposite_corners(const Triangles& triangles) {
  Opposite corners;
  for (Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::pair edge(triangles(t, k), triangles(t, (k + 1) % 3));
      const auto [there, added] = corners.emplace(edge, static_cast<int>(triangles(t, (k + 2) % 3)));
      if (!added) there->second = -1;
    }
  }
  return corners;
}

constexpr int kDisputed = -2;

// Points that have an owner each, to be found by places.
class OwnedPoints {
 public:
  OwnedPoints(Positions points, std::vector<int> owners, double tolerance)
      : points_(std::move(points)),
        owners_(std::move(owners)),
        tolerance_(tolerance),
        grid_(points_, all(), tolerance) {}
  // The one owner of points within the tolerance, -1 where there is none or are several.
  int only_owner_at(const Eigen::RowVector3d& place) const {
    int found = -1;
    bool several = false;
    const Eigen::RowVector3d reach = Eigen::RowVector3d::Constant(tolerance_);
    grid_.visit(place - reach, place + reach, [&](int n) {
      if ((points_.row(n) - place).norm() > tolerance_) return;
      const int owner = owners_[static_cast<std::size_t>(n)];
      several = several || (found >= 0 && found != owner);
      found = owner;
    });
    return several ? -1 : found;
  }

 private:
  std::vector<int> all() const {
    std::vector<int> all(owners_.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  Positions points_;
  std::vector<int> owners_;
  double tolerance_;
  PointGrid grid_;
};

// Takes over what was found of those that are not matched yet: of a known vertex that one alone claims.
void claim(const std::vector<int>& found, std::vector<int>& match, std::vector<char>& taken) {
  std::vector<int> claims(taken.size(), 0);
  const auto is_open = [&](std::size_t v) {
    return match[v] < 0 && found[v] >= 0 && !taken[static_cast<std::size_t>(found[v])];
  };
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (is_open(v)) ++claims[static_cast<std::size_t>(found[v])];
  }
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (is_open(v) && claims[static_cast<std::size_t>(found[v])] == 1) match[v] = found[v];
  }
  for (const int known : match) {
    if (known >= 0) taken[static_cast<std::size_t>(known)] = true;
  }
}

std::vector<int> by_place(const Positions& known, const Positions& given, double tolerance) {
  std::vector<int> owners(static_cast<std::size_t>(known.rows()));
  std::iota(owners.begin(), owners.end(), 0);
  const OwnedPoints points(known, std::move(owners), tolerance);
  std::vector<int> found;
  for (Index v = 0; v < given.rows(); ++v) found.push_back(points.only_owner_at(given.row(v)));
  return found;
}

std::vector<int> by_texture(const TexturedSurface& known, const TexturedSurface& given) {
  constexpr double kSame = 2e-6;  // files round to six digits
  Positions places(static_cast<Index>(known.texture.size()), 3);
  std::vector<int> owners;
  for (const TexturedVertex& at : known.texture) {
    places.row(static_cast<Index>(owners.size())) << at.u, at.v, 0;
    owners.push_back(static_cast<int>(at.vertex));
  }
  std::vector<int> found(static_cast<std::size_t>(given.vertices.rows()), -1);
  if (owners.empty()) return found;
  const OwnedPoints points(std::move(places), std::move(owners), kSame);
  for (const TexturedVertex& at : given.texture) {
    const int owner = points.only_owner_at(Eigen::RowVector3d(at.u, at.v, 0));
    int& known_vertex = found[at.vertex];
    if (owner < 0 || known_vertex == owner) continue;
    known_vertex = known_vertex == -1 ? owner : kDisputed;
  }
  return found;
}

// The third corner of triangles of which two are known. Whether any was found.
bool grow(const Opposite& opposite, const Triangles& given, std::vector<int>& match, std::vector<char>& taken) {
  bool grown = false;
  for (Index t = 0; t < given.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      int& third = match[given(t, (k + 2) % 3)];
      const int a = match[given(t, k)], b = match[given(t, (k + 1) % 3)];
      if (third >= 0 || a < 0 || b < 0) continue;
      const auto found = opposite.find({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
      if (found == opposite.end() || found->second < 0 || taken[static_cast<std::size_t>(found->second)]) continue;
      third = found->second;
      taken[static_cast<std::size_t>(third)] = true;
      grown = true;
    }
  }
  return grown;
}

constexpr double kOtherExtent = 0.1;  // of the size: how far a sculpt hardly moves the skin's extent
constexpr double kTurnedBack = 0.25;  // of that as it is: what turning leaves of it where the mesh is turned

// 3 x 3, of ones and zeros.
Eigen::Matrix3d matrix_of(const Quat& turn) {
  Eigen::Matrix3d matrix;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit{};
    unit[static_cast<std::size_t>(axis)] = 1;
    const Vec3 turned = rotate(turn, unit);
    matrix.col(axis) = Eigen::Vector3d(turned[0], turned[1], turned[2]).array().round();
  }
  return matrix;
}

// How far the sides of the boxes around two sets of points are apart at most, as a part of the first's diagonal.
double extents_apart(const Positions& known, const Positions& given) {
  const Eigen::RowVector3d low = known.colwise().minCoeff(), high = known.colwise().maxCoeff();
  const double apart = std::max((given.colwise().minCoeff() - low).cwiseAbs().maxCoeff(),
                                (given.colwise().maxCoeff() - high).cwiseAbs().maxCoeff());
  return apart / std::max((high - low).norm(), std::numeric_limits<double>::min());
}

double extents_apart(std::span<const WrittenSkin> written, const Positions& given) {
  double least = std::numeric_limits<double>::infinity();
  for (const WrittenSkin& one : written) least = std::min(least, extents_apart(one.skin, given));
  return least;
}

bool lies_on_one(std::span<const WrittenSkin> written, const Positions& given) {
  return std::ranges::any_of(written, [&](const WrittenSkin& one) {
    return 2 * vertices_in_place(one.skin, given, unmoved_distance(one.skin)) >= static_cast<std::size_t>(given.rows());
  });
}

// Of the character's size: what the symmetry modifier bears, and what one side may tell of the other unasked.
constexpr double kJointTolerance = 0.02, kSkinTolerance = 0.05;
constexpr double kAlikeJoint = 0.01, kAlikeSkin = 0.001;

Quat mirrored(const Quat& q) { return {q[0], -q[1], -q[2], q[3]}; }  // across a plane of constant x

// The place of every name's counterpart on the other side, or its own.
std::vector<std::size_t> name_counterparts(const std::vector<std::string>& names) {
  std::vector<std::size_t> counterparts;
  for (const int other : mirrored_places(names)) {
    counterparts.push_back(other < 0 ? counterparts.size() : static_cast<std::size_t>(other));
  }
  return counterparts;
}

// The plane that halves the rest skin, and the length of the diagonal around that, metres.
struct MirrorPlane {
  explicit MirrorPlane(const Positions& rest) {
    const Eigen::RowVector3d low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
    middle = 0.5 * (low.x() + high.x());
    size = (high - low).norm();
  }
  Eigen::Vector3d image(const Eigen::RowVector3d& point) const {
    return {2 * middle - point.x(), point.y(), point.z()};
  }
  double middle = 0, size = 0;
};

// How far the image of a joint is from another.
double joints_apart(const Skeleton& skeleton, const MirrorPlane& plane, std::size_t joint, std::size_t other) {
  const Vec3 own = bind_place(skeleton, joint), image{2 * plane.middle - own[0], own[1], own[2]};
  return length(bind_place(skeleton, other) - image);
}

// The joint of the other side's name, or itself; both must lie where the mirror has them.
std::vector<std::size_t> joint_counterparts(const Skeleton& skeleton, const MirrorPlane& plane) {
  std::vector<std::size_t> counterparts = name_counterparts(names_of(skeleton.joints));
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::size_t other = counterparts[j];
    const double apart = joints_apart(skeleton, plane, j, other);
    if (apart > kJointTolerance * plane.size) {
      throw Error(ErrorKind::mismatch, "symmetry: the mirror image of joint '", skeleton.joints[j].name, "' is ",
                  std::lround(1e3 * apart), " mm from joint '", skeleton.joints[other].name, "', expected less than ",
                  std::lround(1e3 * kJointTolerance * plane.size),
                  ": the character is not symmetric, or its joints are not named left and right");
    }
  }
  return counterparts;
}

}  // namespace

std::size_t vertices_in_place(const Positions& known, const Positions& given, double tolerance) {
  const std::vector<int> found = by_place(known, given, tolerance);
  return static_cast<std::size_t>(std::ranges::count_if(found, [](int vertex) { return vertex >= 0; }));
}

std::vector<int> match_vertices(const TexturedSurface& known, const TexturedSurface& given, double tolerance) {
  std::vector<char> taken(static_cast<std::size_t>(known.vertices.rows()), false);
  std::vector<int> match(static_cast<std::size_t>(given.vertices.rows()), -1);
  claim(by_place(known.vertices, given.vertices, tolerance), match, taken);
  claim(by_texture(known, given), match, taken);
  const Opposite opposite = opposite_corners(known.triangles);
  while (grow(opposite, given.triangles, match, taken)) {
  }
  return match;
}

Eigen::Matrix3d turn_back(std::span<const WrittenSkin> written, const Positions& given,
                          const std::filesystem::path& path) {
  Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  if (given.rows() == 0) return none;
  const double as_it_is = extents_apart(written, given);
  if (as_it_is < kOtherExtent) return none;
  bool may_be_turned = false;
  for (const Quat& turn : axis_turns()) {
    Eigen::Matrix3d matrix = matrix_of(turn);
    const Positions turned = given * matrix.transpose();
    if (extents_apart(written, turned) > kTurnedBack * as_it_is) continue;
    if (lies_on_one(written, turned)) return matrix;
    may_be_turned = true;
  }
  if (!may_be_turned) return none;
  throw Error(ErrorKind::mismatch, path,
              ": the mesh is as high as the frame is deep or wide: it was written with another axis up, or "
              "turned, and too little of it lies where it was to tell how (write it with Y up, as it was exported; "
              "Blender's export has 'Up')");
}

bool is_own_mirror_image(const Character& character) {
  const MirrorPlane plane(character.vertices);
  const std::vector<std::size_t> counterparts = name_counterparts(names_of(character.skeleton.joints));
  for (std::size_t j = 0; j < counterparts.size(); ++j) {
    if (joints_apart(character.skeleton, plane, j, counterparts[j]) > kAlikeJoint * plane.size) return false;
  }
  const NearestSkin nearest(character.vertices, character.triangles);
  return std::ranges::all_of(character.vertices.rowwise(), [&](const Eigen::RowVector3d& vertex) {
    const Eigen::Vector3d image = plane.image(vertex);
    return (nearest(image).position - image).norm() <= kAlikeSkin * plane.size;
  });
}

MirrorImage::MirrorImage(const Character& character, const std::vector<std::string>& controls)
    : skeleton_(character.skeleton), control_counterpart_(name_counterparts(controls)) {
  const Positions& rest = character.vertices;
  const MirrorPlane plane(rest);
  middle_ = plane.middle;
  counterpart_ = joint_counterparts(skeleton_, plane);
  const NearestSkin nearest(rest, character.triangles);
  for (Index v = 0; v < rest.rows(); ++v) {
    const Eigen::Vector3d image = plane.image(rest.row(v));
    image_.push_back(nearest(image));
    if ((image_.back().position - image).norm() > kSkinTolerance * plane.size) {
      throw Error(ErrorKind::mismatch, "symmetry: the mirror image of vertex ", v, " is ",
                  std::lround(1e3 * (image_.back().position - image).norm()),
                  " mm from the skin: the character is not symmetric");
    }
  }
}

// How far a pose moves a joint against its parent, in the axes of the world at bind; of a root nothing.
Vec3 MirrorImage::moved_from_bind(const Pose& pose, std::size_t j, const std::vector<Quat>& bind) const {
  const Joint& joint = skeleton_.joints[j];
  if (joint.parent < 0) return {0, 0, 0};
  return rotate(bind[static_cast<std::size_t>(joint.parent)], pose.joints[j].translation - joint.bind.translation);
}

Pose MirrorImage::pose(const Pose& pose) const {
  const std::vector<Affine> posed = posed_joints(skeleton_, pose.joints);
  const std::vector<Quat> bind = bind_rotations(skeleton_);
  std::vector<Quat> turns;  // away from bind, world
  for (std::size_t j = 0; j < posed.size(); ++j) {
    turns.push_back(decompose(posed[j]).rotation * conjugate(bind[j]));
  }
  Pose result = pose;
  std::vector<Quat> world(posed.size());
  for (std::size_t j = 0; j < posed.size(); ++j) {
    const Joint& joint = skeleton_.joints[j];
    world[j] = mirrored(turns[counterpart_[j]]) * bind[j];
    JointTransform& own = result.joints[j];
    own = joint.bind;
    if (joint.parent >= 0) {
      const Quat to_parent = conjugate(bind[static_cast<std::size_t>(joint.parent)]);
      const Vec3 moved = moved_from_bind(pose, counterpart_[j], bind);
      own.rotation = normalized(conjugate(world[static_cast<std::size_t>(joint.parent)]) * world[j]);
      own.translation = joint.bind.translation + rotate(to_parent, {-moved[0], moved[1], moved[2]});
    } else {
      const Affine& other = posed[counterpart_[j]];
      own.rotation = normalized(world[j]);
      own.translation = {2 * middle_ - other.m[0][3], other.m[1][3], other.m[2][3]};
    }
  }
  for (std::size_t c = 0; c < control_counterpart_.size(); ++c) {
    result.controls[c] = pose.controls[control_counterpart_[c]];
  }
  return result;
}

Positions MirrorImage::shape(const Positions& shape) const {
  Positions result(shape.rows(), 3);
  for (Index v = 0; v < shape.rows(); ++v) {
    result.row(v) = at_point(shape, image_[static_cast<std::size_t>(v)]);
    result(v, 0) = 2 * middle_ - result(v, 0);
  }
  return result;
}

}  // namespace bodyopt::trainer
