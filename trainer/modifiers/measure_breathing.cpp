#include "trainer/modifiers/measure_breathing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/closed_skin.h"
#include "geometry/table_rows.h"
#include "runtime/cpu/kernels.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"

namespace bodyopt {
namespace {

using FlatPoint = std::array<double, 2>;

// Length of the convex outline of points in a plane (the monotone chain of Andrew 1979).
double outline(std::vector<FlatPoint> points) {
  std::sort(points.begin(), points.end());
  std::vector<FlatPoint> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const FlatPoint& p : points) {
      const auto bends_in = [&] {
        const FlatPoint &a = hull[hull.size() - 2], &b = hull.back();
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0;
      };
      while (hull.size() >= first + 2 && bends_in()) hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  double length = 0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const FlatPoint &a = hull[k], &b = hull[(k + 1) % hull.size()];
    length += std::hypot(a[0] - b[0], a[1] - b[1]);
  }
  return length;
}

// As a tape lies around the trunk at a height of it.
double girth(const Positions& skin, const Triangles& triangles, const Torso& torso, double height) {
  std::vector<FlatPoint> points;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const Eigen::Index a = triangles(t, e), b = triangles(t, (e + 1) % 3);
      const Eigen::Vector3d pa = skin.row(a).transpose(), pb = skin.row(b).transpose();
      const double ha = torso.height(pa) - height, hb = torso.height(pb) - height;
      if (!(ha * hb < 0) || torso.share[a] < 0.5) continue;
      const Eigen::Vector3d p = pa + ha / (ha - hb) * (pb - pa) - torso.hips;
      points.push_back({p.dot(torso.left), p.dot(torso.front)});
    }
  }
  return outline(std::move(points));
}

// V x 3, by the components of the modifier at these weights.
Positions breathed_in(const Basis& basis, const SkinModifier& modifier, double chest, double belly) {
  std::vector<float> weights(basis.modifiers.component_count(), 0.0f);
  weights.at(modifier.first_component) = static_cast<float>(chest);
  weights.at(modifier.first_component + 1) = static_cast<float>(belly);
  std::vector<float> offsets(3 * std::size_t{basis.mesh.vertex_count()});
  cpu::modify_blend(basis.modifiers, weights, 1, offsets);
  return rows_of(offsets);
}

// The weights of chest and belly at the top of the deepest breath of a minute.
std::array<double, 2> deepest_breath(const Basis& basis, const SkinModifier& modifier, float exertion) {
  Basis alone = basis;
  alone.modifiers.stack = {modifier};
  alone.modifiers.stack[0].constants["exertion"] = exertion;
  alone.modifiers.stack[0].constants["irregularity"] = 0;
  alone.modifiers.stack[0].first_component = 0;
  std::vector<Pose> poses(60 * 24, bind_pose(basis.skeleton));
  drive_modifiers(alone, {}, 24, poses);
  const auto top = std::ranges::max_element(poses, {}, [](const Pose& pose) { return pose.modifiers.at(0); });
  return {static_cast<double>(top->modifiers.at(0)), static_cast<double>(top->modifiers.at(1))};
}

}  // namespace

std::vector<BreathMeasure> measure_breathing(const Basis& basis, const SkinModifier& modifier) {
  const Torso torso = find_torso(basis, "the modifier '" + modifier.name + "'");
  const Positions rest = rows_of(basis.mesh.rest);
  const Triangles triangles = rows_of(basis.mesh.triangles);
  std::vector<BreathMeasure> measures;
  for (const auto& [name, exertion] : {std::pair("quiet", 0.0f), std::pair("deep", 1.0f)}) {
    const auto [chest, belly] = deepest_breath(basis, modifier, exertion);
    const Positions skin = rest + breathed_in(basis, modifier, chest, belly);
    BreathMeasure measure;
    measure.name = name;
    measure.litres = 1e3 * (enclosed_volume(skin, triangles) - enclosed_volume(rest, triangles));
    for (double height = 0.40; height < 0.85; height += 0.05) {
      const double before = girth(rest, triangles, torso, height);
      if (!(before > 0)) continue;
      measure.girth_share = std::max(measure.girth_share, girth(skin, triangles, torso, height) / before - 1);
    }
    measure.belly_mm = 1e3 * breathed_in(basis, modifier, 0, belly).rowwise().norm().maxCoeff();
    measures.push_back(measure);
  }
  return measures;
}

}  // namespace bodyopt
