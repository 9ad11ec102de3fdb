// FBX files at random: units, axes, pivots, turns before and after, curves, skins that are bound in another pose. And
// how far what was read of one is from FBX's own formula.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "runtime/host/rig.h"
#include "tests/support/fbx_writer.h"

namespace bodyopt::testing {

class FbxMaker {
 public:
  explicit FbxMaker(unsigned seed) : random_(seed) {}

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  Vector vector(double most) { return {number(-most, most), number(-most, most), number(-most, most)}; }
  bool now_and_then() { return whole(0, 2) == 0; }

  // Metres in units of the file.
  double metres(const WrittenFbx& file, double length) { return length * 100 / file.unit; }

  WrittenFbx frame() {
    WrittenFbx file;
    const double units[] = {1, 100, 2.54, 0.1, 30.48};
    file.unit = units[whole(0, 4)];
    const int axes[][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}};
    const int kind = whole(0, 3);
    std::copy_n(axes[kind], 3, file.axes);
    const int signs[][3] = {{1, 1, 1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}};
    std::copy_n(signs[kind], 3, file.signs);
    return file;
  }

  WrittenModel model(const WrittenFbx& file, int parent, bool scaled) {
    const double length = metres(file, 0.3);
    WrittenModel m;
    m.name = "node" + std::to_string(file.models.size());
    m.parent = parent;
    m.translation = vector(length);
    m.degrees = vector(400);
    m.order = whole(0, 5);
    if (scaled) m.scale = Vector::Constant(number(0.5, 2));
    if (now_and_then()) m.before = vector(180);
    if (now_and_then()) m.after = vector(180);
    if (now_and_then()) m.rotation_offset = vector(length);
    if (now_and_then()) m.rotation_pivot = vector(length);
    if (now_and_then()) m.scale_offset = vector(length);
    if (now_and_then()) m.scale_pivot = vector(length);
    return m;
  }

  // A chain of joints that is bound where it does not rest, and motion.
  WrittenFbx limb(double seconds = 2) {
    WrittenFbx file = frame();
    for (int k = 0; k < 5; ++k) file.models.push_back(model(file, k - 1, true));
    file.models.push_back(model(file, now_and_then() ? 0 : -1, true));
    file.models.back().type = "Mesh";
    file.models.back().mesh_translation = vector(metres(file, 0.2));
    file.models.back().mesh_degrees = vector(180);
    file.models.back().mesh_scale = {number(0.5, 2), number(0.5, 2), number(0.5, 2)};
    WrittenMesh mesh;
    mesh.model = 5;
    for (int k = 0; k < 40; ++k) mesh.points.push_back(vector(metres(file, 0.5)));
    for (std::int64_t k = 0; k + 3 < 40; ++k) mesh.polygons.insert(mesh.polygons.end(), {k, k + 1, k + 3, ~(k + 2)});
    WrittenFbx bound = file;  // in another pose
    for (WrittenModel& m : bound.models) m.degrees = vector(180);
    for (int bone = 0; bone < 5; ++bone) {
      WrittenCluster cluster{bone, {}, {}, bound.world(5, 0), bound.world(bone, 0)};
      for (std::int64_t p = 0; p < 40; ++p) {
        cluster.points.push_back(p);
        cluster.weights.push_back(number(0.01, 1));
      }
      mesh.clusters.push_back(cluster);
    }
    file.meshes.push_back(mesh);
    file.begin = whole(0, 2) * 10;
    file.end = file.begin + seconds;
    for (int k = 0; k < 8; ++k) {
      WrittenCurve curve;
      curve.model = whole(0, 4);
      curve.axis = whole(0, 2);
      curve.property = now_and_then() ? "Lcl Translation" : "Lcl Rotation";
      const bool taken = std::ranges::any_of(file.curves, [&](const WrittenCurve& other) {
        return other.model == curve.model && other.property == curve.property;
      });
      if (taken) continue;
      for (int key = 0; key < 5; ++key) {
        curve.seconds.push_back(file.begin - 0.49 + key * 0.75);
        curve.values.push_back(curve.property == "Lcl Rotation" ? number(-500, 500)
                                                                : number(-1, 1) * metres(file, 0.2));
      }
      if (now_and_then()) curve.flags = 2;
      file.curves.push_back(curve);
    }
    return file;
  }

 private:
  std::mt19937 random_;
};

inline Vector vector_of(const Vec3& v) { return {v[0], v[1], v[2]}; }

// By the formula: the skin's points at a time, linearly blended.
inline std::vector<Vector> skin_of(const WrittenFbx& file, double seconds) {
  const WrittenMesh& mesh = file.meshes.front();
  const WrittenModel& m = file.models[static_cast<std::size_t>(mesh.model)];
  const Eigen::Affine3d in_node =
      Eigen::Translation3d(m.mesh_translation) * Eigen::AngleAxisd(m.mesh_degrees[2] * M_PI / 180, Vector::UnitZ()) *
      Eigen::AngleAxisd(m.mesh_degrees[1] * M_PI / 180, Vector::UnitY()) *
      Eigen::AngleAxisd(m.mesh_degrees[0] * M_PI / 180, Vector::UnitX()) * Eigen::Scaling(m.mesh_scale);
  std::vector<Vector> points(mesh.points.size(), Vector::Zero());
  std::vector<double> sums(mesh.points.size(), 0);
  for (const WrittenCluster& cluster : mesh.clusters) {
    const Eigen::Affine3d moved =
        file.to_ours() * file.world(cluster.bone, seconds) * cluster.bone_then.inverse() * cluster.mesh_then * in_node;
    for (std::size_t k = 0; k < cluster.points.size(); ++k) {
      const auto p = static_cast<std::size_t>(cluster.points[k]);
      points[p] += cluster.weights[k] * (moved * mesh.points[p]);
      sums[p] += cluster.weights[k];
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p) points[p] /= sums[p];
  return points;
}

// How far the skin that was read is from that at most, metres.
inline double off(const WrittenFbx& file, const Character& character, const Pose& pose, double seconds) {
  const std::vector<Affine> world = posed_joints(character.skeleton, pose.joints);
  const std::vector<Vector> expected = skin_of(file, seconds);
  double worst = character.output_count() == expected.size() ? 0 : HUGE_VAL;
  for (std::uint32_t o = 0; o < character.output_count(); ++o) {
    const std::uint32_t v = character.output_vertex[o];
    const Vec3 rest{character.vertices(v, 0), character.vertices(v, 1), character.vertices(v, 2)};
    Vector point = Vector::Zero();
    for (const JointWeight& w : character.weights[v]) {
      point += w.weight * vector_of(world[w.joint] * (character.skeleton.joints[w.joint].inverse_bind * rest));
    }
    worst = std::max(worst, (point - expected[o]).norm());
  }
  return worst;
}

}  // namespace bodyopt::testing
