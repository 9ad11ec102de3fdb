#include "trainer/anatomy/half_body.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "assets/clips/axis_turns.h"
#include "base/quantile.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "geometry/spatial_search.h"
#include "geometry/surface_topology.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kMirrorTolerance = 1e-4;  // of the body's extent: a vertex and the mirror image of its counterpart
constexpr double kPlaceTolerance = 0.02;   // of the body's extent: joints that are each other's mirror image

Vector3d mirrored(const Vector3d& point, double middle) { return {2 * middle - point.x(), point.y(), point.z()}; }

std::vector<Vector3d> joint_places(const Skeleton& skeleton) {
  std::vector<Vector3d> places;
  for (std::size_t j = 0; j < skeleton.size(); ++j) places.emplace_back(bind_place(skeleton, j).data());
  return places;
}

// The vertices that triangles join, and the middles of open edges, which tell of a missing triangle. Triangles' own
// middles would tell of diagonals, which modellers do not mirror.
Positions outline_of(const Character& character) {
  std::vector<Index> rows(character.triangles.data(), character.triangles.data() + character.triangles.size());
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  const std::vector<VertexPair> open = find_bad_edges(character.triangles).open;
  const auto joined = static_cast<Index>(rows.size());
  Positions outline(joined + static_cast<Index>(open.size()), 3);
  outline.topRows(joined) = character.vertices(rows, Eigen::all);
  for (std::size_t k = 0; k < open.size(); ++k) {
    const auto& [a, b] = open[k];
    outline.row(joined + static_cast<Index>(k)) = 0.5 * (character.vertices.row(a) + character.vertices.row(b));
  }
  return outline;
}

double middle_of(const Positions& outline) {
  return outline.rows() > 0 ? 0.5 * (outline.col(0).minCoeff() + outline.col(0).maxCoeff()) : 0;
}

bool is_mirror_image(const Positions& outline, double middle) {
  const double tolerance = kMirrorTolerance * longest_extent(outline);
  std::vector<int> all(static_cast<std::size_t>(outline.rows()));
  std::iota(all.begin(), all.end(), 0);
  if (all.empty()) return false;
  const PointGrid grid(outline, all, tolerance);
  return std::ranges::all_of(all, [&](int v) {
    const Eigen::RowVector3d image = mirrored(outline.row(v), middle).transpose();
    bool found = false;
    const auto look = [&](int n) { found = found || (outline.row(n) - image).norm() <= tolerance; };
    grid.visit(image.array() - tolerance, image.array() + tolerance, look);
    return found;
  });
}

// The joint of the other side's name; -1: none has it.
std::vector<int> counterparts_by_name(const Skeleton& skeleton) { return mirrored_places(names_of(skeleton.joints)); }

// How far on average the vertices (V x 3, one at least) lie from their skin, mirrored across an axis at `middle`;
// metres.
double mirror_error(const Positions& vertices, const NearestSkin& skin, int axis, double middle) {
  constexpr Index kMost = 400;  // vertices that are looked at, evenly spread
  const Index step = std::max<Index>(1, vertices.rows() / kMost);
  double sum = 0, count = 0;
  for (Index v = 0; v < vertices.rows(); v += step, ++count) {
    Vector3d image = vertices.row(v);
    image[axis] = 2 * middle - image[axis];
    sum += (skin(image).position - image).norm();
  }
  return sum / count;
}

// The plane through the skin's middle, or that of the joints if it mirrors the skin more nearly onto itself. A lost arm
// moves the first, and a rig that stands beside its skin the second.
double median_plane(const Character& character, const std::vector<int>& counterparts) {
  const Positions outline = outline_of(character);
  const double middle = middle_of(outline);
  if (is_mirror_image(outline, middle)) return middle;
  const std::vector<Vector3d> places = joint_places(character.skeleton);
  std::vector<double> middles;
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (counterparts[j] < 0) continue;
    middles.push_back(0.5 * (places[j].x() + places[static_cast<std::size_t>(counterparts[j])].x()));
  }
  if (middles.empty() || character.triangles.rows() == 0) return middle;
  const NearestSkin skin(character.vertices, character.triangles);
  const double of_joints = median(middles);
  const auto error = [&](double at) { return mirror_error(outline, skin, 0, at); };
  return error(of_joints) < error(middle) ? of_joints : middle;
}

// The joint nearest to the mirror image, from this joint on and without a counterpart yet. Among joints in one place,
// it is the one whose parent is the counterpart of the joint's parent.
int counterpart_by_place(const std::vector<Vector3d>& places, const Skeleton& skeleton,
                         const std::vector<int>& counterparts, std::size_t joint, double middle, double tolerance) {
  const Vector3d image = mirrored(places[joint], middle);
  const int parent = skeleton.joints[joint].parent;
  const int parents_counterpart = parent < 0 ? -1 : counterparts[static_cast<std::size_t>(parent)];
  int nearest = -1;
  double least = tolerance;
  for (std::size_t k = joint; k < places.size(); ++k) {
    if (counterparts[k] >= 0) continue;
    const double beside = skeleton.joints[k].parent == parents_counterpart ? 0 : 0.5 * tolerance;
    const double apart = (places[k] - image).norm() + beside;
    if (apart >= least) continue;
    least = apart;
    nearest = static_cast<int>(k);
  }
  return nearest;
}

std::vector<int> mirrored_joints_about(const Character& character, std::vector<int> counterparts, double middle) {
  const std::vector<Vector3d> places = joint_places(character.skeleton);
  const double tolerance = kPlaceTolerance * longest_extent(character.vertices);
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (counterparts[j] >= 0) continue;
    const int other = counterpart_by_place(places, character.skeleton, counterparts, j, middle, tolerance);
    if (other < 0) continue;
    counterparts[j] = other;
    counterparts[static_cast<std::size_t>(other)] = static_cast<int>(j);
  }
  return counterparts;
}

// Has each joint that moves skin beside the plane a counterpart?
bool has_counterparts(const Character& character, const std::vector<int>& counterparts) {
  for (const auto& of_vertex : character.weights) {
    for (const JointWeight& weight : of_vertex) {
      if (counterparts[weight.joint] < 0) return false;
    }
  }
  return true;
}

BodySide other_side(BodySide side) {
  if (side == BodySide::middle) return side;
  return side == BodySide::left ? BodySide::right : BodySide::left;
}

void turn_over(HalfBody& half) {
  half.triangles.col(1).swap(half.triangles.col(2));
  for (std::optional<JointRole>& role : half.roles) {
    if (role) role->side = other_side(role->side);
  }
}

// Joints where those of both sides are on average, so that neither side's rounding decides.
void make_symmetric(std::vector<Vector3d>& places, const std::vector<int>& counterparts) {
  const std::vector<Vector3d> own = places;
  for (std::size_t j = 0; j < own.size(); ++j) {
    if (counterparts[j] < 0) continue;
    places[j] = 0.5 * (own[j] + mirrored(own[static_cast<std::size_t>(counterparts[j])], 0));
  }
}

// `character` was turned to stand in its frame.
HalfBody half_of(const Character& character, const Eigen::Matrix3d& frame, double middle, bool is_left) {
  HalfBody half;
  const double side = is_left ? 1 : -1;
  half.from_rest = Eigen::Scaling(side, 1.0, 1.0) * Eigen::Translation3d(-middle, 0, 0);
  half.vertices = character.vertices;
  half.vertices.col(0) = side * (character.vertices.col(0).array() - middle);
  half.triangles = character.triangles;
  half.weights = character.weights;
  for (const Vector3d& place : joint_places(character.skeleton)) half.places.push_back(half.from_rest * place);
  half.from_rest = half.from_rest * frame;
  half.joints = named_joints(character.skeleton);
  half.roles = joint_roles(half.joints);
  if (!is_left) turn_over(half);
  return half;
}

using Eigen::Matrix3d;

// The mean way from the joints that are named right to those that are named left; zero where none are.
Vector3d left_by_names(const Skeleton& skeleton) {
  Vector3d sum[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double count[2] = {0, 0};
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const BodySide side = side_of_name(skeleton.joints[j].name);
    if (side == BodySide::middle) continue;
    const int k = side == BodySide::left ? 0 : 1;
    sum[k] += Vector3d(bind_place(skeleton, j).data());
    ++count[k];
  }
  if (count[0] == 0 || count[1] == 0) return Vector3d::Zero();
  return sum[0] / count[0] - sum[1] / count[1];
}

// The turn about y that brings an axis of the ground, +x, -x, +z or -z, to +x.
Matrix3d turn_to_left(const Vector3d& axis) {
  const Vector3d up = Vector3d::UnitY();
  Matrix3d turn;
  turn << axis.transpose(), up.transpose(), axis.cross(up).transpose();
  return turn;
}

}  // namespace

int HalfBody::find(BodyPart part, BodySide side, std::size_t nested) const {
  const JointRole wanted{part, part <= BodyPart::head ? BodySide::middle : side, nested};
  const auto found = std::ranges::find(roles, std::optional(wanted));
  return found == roles.end() ? -1 : static_cast<int>(found - roles.begin());
}

Muscle HalfBody::path_of(const Muscle& muscle) const {
  Muscle result = muscle;
  for (MusclePoint& point : result.path) {
    const Vector3d place = from_rest * Vector3d(point.position.data());
    point.position = {place.x(), place.y(), place.z()};
  }
  return result;
}

HalfBody body_in_frame(const Character& rest) {
  const Eigen::Matrix3d frame = body_frame(rest);
  const Character character = turned(rest, frame);
  return half_of(character, frame, median_plane(character, counterparts_by_name(character.skeleton)), true);
}

std::vector<HalfBody> halves_of(const Character& rest, std::optional<BodyKind> kind) {
  const Eigen::Matrix3d frame = body_frame(rest);
  const Character character = turned(rest, frame);
  if (kind.value_or(recognise_kind(rest).kind) == BodyKind::limb) {
    HalfBody whole = half_of(character, frame, 0, true);
    whole.has_plane = whole.is_own_mirror = false;
    return {whole};
  }
  const std::vector<int> by_name = counterparts_by_name(character.skeleton);
  const double middle = median_plane(character, by_name);
  const std::vector<int> counterparts = mirrored_joints_about(character, by_name, middle);
  HalfBody left = half_of(character, frame, middle, true);
  left.is_own_mirror = is_mirror_image(outline_of(character), middle) && has_counterparts(character, counterparts);
  if (left.is_own_mirror) {
    make_symmetric(left.places, counterparts);
    return {left};
  }
  HalfBody right = half_of(character, frame, middle, false);
  right.is_own_mirror = false;
  return {left, right};
}

std::vector<int> mirrored_joints(const Character& rest) {
  const Character character = turned(rest, body_frame(rest));
  const std::vector<int> by_name = counterparts_by_name(character.skeleton);
  return mirrored_joints_about(character, by_name, median_plane(character, by_name));
}

Character turned(const Character& character, const Matrix3d& rotation) {
  Character result = character;
  result.vertices = character.vertices * rotation.transpose();
  Affine back;  // turned space to rest space
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&back.m[0][0]).leftCols<3>() = rotation.transpose();
  for (Joint& joint : result.skeleton.joints) joint.inverse_bind = joint.inverse_bind * back;
  return result;
}

Matrix3d body_frame(const Character& character) {
  const auto upright = rotation_matrix(turn_upright(character.skeleton));
  Matrix3d frame;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) frame(static_cast<Index>(r), static_cast<Index>(c)) = std::round(upright[r][c]);
  }
  const Vector3d left = frame * left_by_names(character.skeleton);
  Vector3d axis = Vector3d::UnitX();
  if (std::max(std::abs(left.x()), std::abs(left.z())) > 0.5 * left.norm()) {
    const int along = std::abs(left.x()) >= std::abs(left.z()) ? 0 : 2;
    axis = std::copysign(1.0, left[along]) * Vector3d::Unit(along);
  } else if (character.triangles.rows() > 0 && character.vertices.allFinite()) {
    const Character standing = turned(character, frame);
    const NearestSkin skin(standing.vertices, standing.triangles);
    // A body that looks along x has its left at -z.
    const auto error = [&](int across) {
      const auto along = standing.vertices.col(across);
      return mirror_error(standing.vertices, skin, across, 0.5 * (along.minCoeff() + along.maxCoeff()));
    };
    if (error(2) < 0.5 * error(0)) axis = -Vector3d::UnitZ();
  }
  return turn_to_left(axis) * frame;
}

}  // namespace bodyopt::trainer
