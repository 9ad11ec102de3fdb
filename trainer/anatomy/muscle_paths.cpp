#include "trainer/anatomy/muscle_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assets/clips/joint_roles.h"
#include "base/parallel.h"
#include "base/wording.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kNearCounterpart = 0.1;  // of a path's length: a muscle in the place of the mirror image
constexpr double kStraightBelly = 2;      // a belly's volume over r^2 l: two thirds of a cylinder's

std::vector<Positions> paths_in_half(const HalfBody& body, const std::vector<Muscle>& muscles) {
  std::vector<Positions> paths;
  for (const Muscle& muscle : muscles) {
    const Muscle carried = body.path_of(muscle);
    Positions path(static_cast<Index>(carried.path.size()), 3);
    for (Index k = 0; k < path.rows(); ++k) {
      path.row(k) = Vector3d(carried.path[static_cast<std::size_t>(k)].position.data()).transpose();
    }
    paths.push_back(resampled(path, kPathPoints));
  }
  return paths;
}

Positions turned_over(const Positions& path) {
  Positions image = path;
  image.col(0) *= -1;
  return image;
}

// The nearest muscle by the mean distance of their points, among those that have no counterpart yet.
int muscle_by_place(const std::vector<Positions>& paths, const std::vector<int>& counterparts, std::size_t muscle) {
  const Positions image = turned_over(paths[muscle]);
  double least = kNearCounterpart * path_length(image);
  int nearest = -1;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (k == muscle || counterparts[k] >= 0) continue;
    const double apart = (paths[k] - image).rowwise().norm().mean();
    if (apart >= least) continue;
    least = apart;
    nearest = static_cast<int>(k);
  }
  return nearest;
}

std::vector<int> pair_up(const std::vector<Muscle>& muscles, const std::vector<Positions>& paths) {
  std::vector<int> counterparts = mirrored_places(names_of(muscles));
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (counterparts[m] >= 0) continue;
    const int other = muscle_by_place(paths, counterparts, m);
    if (other < 0) continue;
    counterparts[m] = other;
    counterparts[static_cast<std::size_t>(other)] = static_cast<int>(m);
  }
  return counterparts;
}

// The joint that stands where the mirror image of another would.
int joint_across(const HalfBody& body, int joint) {
  const std::vector<std::string> names = names_of(body.joints);
  const auto at = static_cast<std::size_t>(joint);
  const auto found = std::ranges::find(names, mirrored_name(names[at], names));
  if (found != names.end()) return static_cast<int>(found - names.begin());
  Vector3d image = body.places[at];
  image.x() *= -1;
  const auto nearest = std::ranges::min_element(
      body.places, [&](const auto& a, const auto& b) { return (a - image).squaredNorm() < (b - image).squaredNorm(); });
  return static_cast<int>(nearest - body.places.begin());
}

int depth_of(const HalfBody& body, std::uint32_t joint) {
  int depth = 0;
  for (int j = static_cast<int>(joint); j >= 0; j = body.joints[static_cast<std::size_t>(j)].parent) ++depth;
  return depth;
}

HalfMuscle half_muscle(const HalfBody& body, const std::vector<Muscle>& muscles, int number, const Positions& path) {
  const Muscle& muscle = muscles[static_cast<std::size_t>(number)];
  HalfMuscle half;
  half.muscles = {number};
  half.name = matching_name(muscle.name);
  half.whole = find_whole_muscle(muscle.name);
  half.path = path;
  half.joint = {static_cast<int>(muscle.path.front().joint), static_cast<int>(muscle.path.back().joint)};
  if (half.whole) {
    half.belly_from = half.whole->belly_from;
    half.belly_to = half.whole->belly_to;
    // Some models begin at the end that is farther from the trunk.
    if (depth_of(body, muscle.path.front().joint) > depth_of(body, muscle.path.back().joint)) {
      half.belly_from = 1 - half.whole->belly_to;
      half.belly_to = 1 - half.whole->belly_from;
    }
  }
  half.volume_by_radius = kStraightBelly * muscle.radius * muscle.radius * path_length(path);
  return half;
}

// Slips of one muscle become one, with the mean of their paths.
void merge_slips(std::vector<HalfMuscle>& muscles) {
  std::vector<HalfMuscle> merged;
  std::vector<int> slips;
  for (const HalfMuscle& muscle : muscles) {
    const auto same = std::ranges::find_if(merged, [&](const HalfMuscle& other) {
      return muscle.whole && muscle.whole->slips_share_a_region && other.whole == muscle.whole;
    });
    if (same == merged.end()) {
      merged.push_back(muscle);
      slips.push_back(1);
      continue;
    }
    const double count = slips[static_cast<std::size_t>(same - merged.begin())]++;
    same->path = (count * same->path + muscle.path) / (count + 1);
    same->volume_by_radius += muscle.volume_by_radius;
    same->muscles.insert(same->muscles.end(), muscle.muscles.begin(), muscle.muscles.end());
  }
  muscles = std::move(merged);
}

constexpr double kFarthestBone = 0.045;  // metres, of a man of 1.75 m
constexpr double kDrawnAlong = 0.33;     // of the path

std::vector<bool> joints_near(const HalfBody& body, int joint) {
  std::vector<bool> near(body.joints.size(), false);
  for (int j = joint, up = 0; j >= 0 && up < 3; j = body.joints[static_cast<std::size_t>(j)].parent, ++up) {
    near[static_cast<std::size_t>(j)] = true;
  }
  for (std::size_t j = 0; j < near.size(); ++j) near[j] = near[j] || (joint >= 0 && body.joints[j].parent == joint);
  return near;
}

// Eight places between each two of a polyline.
std::vector<Vector3d> fine_line(const std::vector<Vector3d>& line) {
  std::vector<Vector3d> fine;
  for (std::size_t k = 1; k < line.size(); ++k) {
    for (int part = 0; part <= 8; ++part) fine.emplace_back(line[k - 1] + part / 8.0 * (line[k] - line[k - 1]));
  }
  return fine;
}

// The line from a belly's end to the bone.
std::vector<Vector3d> tendon_line(const HalfMuscle& muscle, bool is_origin, const Vector3d& foot) {
  std::vector<Vector3d> line{foot};
  for (Index k = 0; k < muscle.path.rows(); ++k) {
    const Index at = is_origin ? k : muscle.path.rows() - 1 - k;
    const double along = static_cast<double>(at) / static_cast<double>(muscle.path.rows() - 1);
    if (is_origin ? along > muscle.belly_from : along < muscle.belly_to) break;
    line.emplace_back(muscle.path.row(at));
  }
  return line;
}

}  // namespace

double path_length(const Positions& path) {
  return (path.bottomRows(path.rows() - 1) - path.topRows(path.rows() - 1)).rowwise().norm().sum();
}

Positions resampled(const Positions& path, int count) {
  std::vector<double> along{0};
  for (Index k = 1; k < path.rows(); ++k) along.push_back(along.back() + (path.row(k) - path.row(k - 1)).norm());
  Positions result(count, 3);
  Index after = 1;
  for (Index k = 0; k < count; ++k) {
    const double at = along.back() * static_cast<double>(k) / (count - 1);
    while (after + 1 < path.rows() && along[static_cast<std::size_t>(after)] < at) ++after;
    const double from = along[static_cast<std::size_t>(after - 1)], to = along[static_cast<std::size_t>(after)];
    const double share = to > from ? std::clamp((at - from) / (to - from), 0.0, 1.0) : 0;
    result.row(k) = (1 - share) * path.row(after - 1) + share * path.row(after);
  }
  return result;
}

Eigen::MatrixXd smoothed_along(const Eigen::MatrixXd& rows, double width) {
  const auto reach = static_cast<Index>(std::ceil(4 * width));
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows.rows(), rows.cols());
  double sum = 0;
  for (Index offset = -reach; offset <= reach; ++offset) {
    const double weight = std::exp(-0.5 * static_cast<double>(offset * offset) / (width * width));
    sum += weight;
    for (Index k = 0; k < rows.rows(); ++k) {
      result.row(k) += weight * rows.row(std::clamp<Index>(k + offset, 0, rows.rows() - 1));
    }
  }
  return result / sum;
}

std::vector<int> mirrored_muscles(const HalfBody& body, const std::vector<Muscle>& muscles) {
  return pair_up(muscles, paths_in_half(body, muscles));
}

std::vector<double> off_mirror_images(const HalfBody& body, const std::vector<Muscle>& muscles) {
  const std::vector<Positions> paths = paths_in_half(body, muscles);
  const std::vector<int> counterparts = pair_up(muscles, paths);
  std::vector<double> off(muscles.size(), 0);
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (counterparts[m] < 0) continue;
    const Positions image = turned_over(paths[static_cast<std::size_t>(counterparts[m])]);
    off[m] = (paths[m] - image).rowwise().norm().mean();
  }
  return off;
}

std::vector<HalfMuscle> muscles_of_half(const HalfBody& body, const std::vector<Muscle>& muscles) {
  const std::vector<Positions> paths = paths_in_half(body, muscles);
  const std::vector<int> counterparts = pair_up(muscles, paths);
  const auto outwards = [&](int m) { return paths[static_cast<std::size_t>(m)].col(0).mean(); };
  std::vector<HalfMuscle> halves;
  for (int m = 0; m < static_cast<int>(muscles.size()); ++m) {
    Positions path = paths[static_cast<std::size_t>(m)];
    const int other = body.is_own_mirror ? counterparts[static_cast<std::size_t>(m)] : -1;
    if (other >= 0) {
      if (outwards(m) < outwards(other) || (outwards(m) == outwards(other) && other < m)) continue;
      path = 0.5 * (path + turned_over(paths[static_cast<std::size_t>(other)]));
    }
    const bool is_across = body.has_plane && outwards(m) < 0;
    if (is_across && (other >= 0 || !body.is_own_mirror)) continue;
    halves.push_back(half_muscle(body, muscles, m, is_across ? turned_over(path) : path));
    if (!is_across) continue;
    for (int& joint : halves.back().joint) joint = joint_across(body, joint);
  }
  merge_slips(halves);
  return halves;
}

BoneSurface::BoneSurface(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue)
    : body_(body), grid_(grid), tissue_(tissue) {
  for (int s = 0; s < grid.size(); ++s) {
    const auto at = static_cast<std::size_t>(s);
    if (tissue.kind(s) == TissueKind::bone && tissue.bone_joint[at] >= 0) samples_.push_back(s);
  }
}

BoneFoot BoneSurface::foot(const Vector3d& point, int joint) const {
  const BoneFoot own = nearest(point, joints_near(body_, joint));
  return own.joint >= 0 ? own : nearest(point, std::vector<bool>(body_.joints.size(), true));
}

BoneFoot BoneSurface::nearest(const Vector3d& point, const std::vector<bool>& joints) const {
  double least = std::numeric_limits<double>::max();
  int sample = -1;
  for (const int s : samples_) {
    if (!joints[static_cast<std::size_t>(tissue_.bone_joint[static_cast<std::size_t>(s)])]) continue;
    const double squared = (grid_.points.row(s).transpose() - point).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    sample = s;
  }
  if (sample < 0) return {};
  // The middle of a cell lies inside: the foot goes back to the bone's surface.
  BoneFoot foot{tissue_.bone_joint[static_cast<std::size_t>(sample)], grid_.points.row(sample), std::sqrt(least)};
  const double deep = std::min({-tissue_.bone[sample], foot.distance, grid_.cell});
  if (foot.distance > 0) foot.place += deep / foot.distance * (point - foot.place);
  foot.distance -= deep;
  return foot;
}

void draw_to_bone(const BoneSurface& bones, double scale, std::vector<HalfMuscle>& muscles) {
  parallel_for(muscles.size(), [&](std::size_t m) {
    HalfMuscle& muscle = muscles[m];
    const Index last = muscle.path.rows() - 1;
    for (const int end : {0, 1}) {
      const Vector3d own = muscle.path.row(end == 0 ? 0 : last);
      const BoneFoot foot = bones.foot(own, muscle.joint[static_cast<std::size_t>(end)]);
      if (foot.joint < 0 || foot.distance > kFarthestBone * scale) continue;
      for (Index k = 0; k <= last; ++k) {
        const double way = static_cast<double>(end == 0 ? k : last - k) / static_cast<double>(last);
        const double share = std::max(1 - way / kDrawnAlong, 0.0);
        muscle.path.row(k) += share * share * (3 - 2 * share) * (foot.place - own).transpose();
      }
    }
  });
}

std::vector<int> tendon_samples(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                                const std::vector<std::array<BoneFoot, 2>>& feet) {
  const BodyGrid& grid = lean.grid;
  const double radius = 0.75 * grid.cell;
  std::vector<int> tendon(static_cast<std::size_t>(grid.size()), -1);
  const auto mark = [&](const Vector3d& point, int muscle) {
    for (int corner = 0; corner < 27; ++corner) {
      const Vector3d beside = point + grid.cell * Vector3d(corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1);
      const int s = grid.sample_at(beside);
      if (s < 0 || (grid.points.row(s).transpose() - point).norm() > radius) continue;
      const TissueKind kind = lean.tissue.kind(s);
      if (kind == TissueKind::other_lean) tendon[static_cast<std::size_t>(s)] = muscle;
    }
  };
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    for (const std::size_t end : {0U, 1U}) {
      if (feet[m][end].joint < 0) continue;
      for (const Vector3d& point : fine_line(tendon_line(muscles[m], end == 0, feet[m][end].place))) {
        mark(point, static_cast<int>(m));
      }
    }
  }
  return tendon;
}

}  // namespace bodyopt::trainer
