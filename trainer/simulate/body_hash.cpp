#include "trainer/simulate/body_hash.h"

#include "base/content_hash.h"

namespace bodyopt::trainer {
namespace {

// Raised whenever the same inputs give other shapes or another side-car, so that no unfinished cache mixes two solvers.
constexpr std::uint64_t kSolverVersion = 17;

}  // namespace

std::uint64_t body_hash(const Character& character, const std::vector<Muscle>& muscles, const Materials& materials,
                        const TetMesh& mesh, std::uint64_t anatomy) {
  ContentHash hash;
  hash.add(kSolverVersion);
  hash.add(anatomy);
  for (const double constant :
       {materials.fat.mu, materials.fat.lambda, materials.muscle.mu, materials.muscle.lambda, materials.cavity.mu,
        materials.cavity.lambda, materials.muscle_bulk, materials.active_fibre, materials.active_slack,
        materials.passive_fibre, materials.bone_springs, materials.skin_bending, materials.contact}) {
    hash.add(constant);
  }
  hash.append(mesh.nodes.data(), static_cast<std::size_t>(mesh.nodes.size()) * sizeof(double));
  hash.append(mesh.tets.data(), static_cast<std::size_t>(mesh.tets.size()) * sizeof(int));
  hash.add(static_cast<std::uint64_t>(mesh.is_second_order));
  hash.append(character.vertices.data(), static_cast<std::size_t>(character.vertices.size()) * sizeof(double));
  hash.append(character.triangles.data(), static_cast<std::size_t>(character.triangles.size()) * sizeof(std::uint32_t));
  for (const Joint& joint : character.skeleton.joints) {
    hash.add(static_cast<std::uint64_t>(joint.parent));
    hash.add(joint.bind);
    for (const auto& row : joint.inverse_bind.m) {
      for (const double x : row) hash.add(x);
    }
  }
  for (const std::uint32_t v : character.output_vertex) hash.add(static_cast<std::uint64_t>(v));
  for (const auto& vertex : character.weights) {
    hash.add(static_cast<std::uint64_t>(vertex.size()));
    for (const JointWeight& w : vertex) {
      hash.add(static_cast<std::uint64_t>(w.joint));
      hash.add(w.weight);
    }
  }
  for (const Muscle& muscle : muscles) {
    hash.add(static_cast<std::uint64_t>(muscle.path.size()));
    hash.add(muscle.radius);
    hash.add(muscle.max_activation);
    for (const MusclePoint& point : muscle.path) {
      hash.add(static_cast<std::uint64_t>(point.joint));
      for (const double x : point.position) hash.add(x);
    }
  }
  return hash.value();
}

std::uint64_t pose_hash(std::uint64_t body, const Pose& pose, const std::vector<double>& flex) {
  ContentHash hash;
  hash.add(body);
  for (const JointTransform& joint : pose.joints) hash.add(joint);
  for (const double f : flex) hash.add(f);
  return hash.value();
}

}  // namespace bodyopt::trainer
