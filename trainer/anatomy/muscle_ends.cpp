#include "trainer/anatomy/muscle_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

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

// From a belly's end to the bone.
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
  // From the middle of the cell back to the bone's surface.
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

}  // namespace bodyopt
