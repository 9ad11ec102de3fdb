#include "trainer/simulate/body_hash.h"

#include <xxhash.h>

#include <cstring>
#include <string>

namespace bodyopt {
namespace {

// Raised whenever the same inputs give other shapes or another side-car, so that no unfinished cache mixes two solvers.
constexpr std::uint64_t kSolverVersion = 7, kCageVersion = 1;

// Bytes to hash. Only numbers and strings go in, never structs: padding has no meaning.
class Bytes {
 public:
  void add(double value) { append(&value, sizeof(value)); }
  void add(std::uint64_t value) { append(&value, sizeof(value)); }
  void add(const std::string& text) {
    add(static_cast<std::uint64_t>(text.size()));
    text_ += text;
  }
  void add(const JointTransform& transform) {
    for (const double x : transform.translation) add(x);
    for (const double x : transform.rotation) add(x);
    for (const double x : transform.scale) add(x);
  }
  void append(const void* data, std::size_t size) { text_.append(static_cast<const char*>(data), size); }
  std::uint64_t hash() const { return XXH3_64bits(text_.data(), text_.size()); }

 private:
  std::string text_;
};

}  // namespace

std::uint64_t body_hash(const Character& character, const std::vector<Muscle>& muscles, const Materials& materials,
                        const TetMesh& mesh, bool is_cage) {
  Bytes bytes;
  bytes.add(kSolverVersion);
  for (const double constant :
       {materials.fat.mu, materials.fat.lambda, materials.muscle.mu, materials.muscle.lambda, materials.muscle_bulk,
        materials.active_fibre, materials.active_slack, materials.passive_fibre, materials.bone_springs,
        materials.skin_bending, materials.contact}) {
    bytes.add(constant);
  }
  bytes.append(mesh.nodes.data(), static_cast<std::size_t>(mesh.nodes.size()) * sizeof(double));
  bytes.append(mesh.tets.data(), static_cast<std::size_t>(mesh.tets.size()) * sizeof(int));
  if (is_cage) {
    bytes.add(kCageVersion);
    bytes.append(character.vertices.data(), static_cast<std::size_t>(character.vertices.size()) * sizeof(double));
    bytes.append(character.triangles.data(),
                 static_cast<std::size_t>(character.triangles.size()) * sizeof(std::uint32_t));
  }
  for (const Joint& joint : character.skeleton.joints) {
    bytes.add(static_cast<std::uint64_t>(joint.parent));
    bytes.add(joint.bind);
    for (const auto& row : joint.inverse_bind.m) {
      for (const double x : row) bytes.add(x);
    }
  }
  for (const std::uint32_t v : character.output_vertex) bytes.add(static_cast<std::uint64_t>(v));
  for (const auto& vertex : character.weights) {
    bytes.add(static_cast<std::uint64_t>(vertex.size()));
    for (const JointWeight& w : vertex) {
      bytes.add(static_cast<std::uint64_t>(w.joint));
      bytes.add(w.weight);
    }
  }
  for (const Muscle& muscle : muscles) {
    bytes.add(static_cast<std::uint64_t>(muscle.path.size()));
    bytes.add(muscle.radius);
    bytes.add(muscle.max_activation);
    for (const MusclePoint& point : muscle.path) {
      bytes.add(static_cast<std::uint64_t>(point.joint));
      for (const double x : point.position) bytes.add(x);
    }
  }
  return bytes.hash();
}

std::uint64_t pose_hash(std::uint64_t body, const Pose& pose, const std::vector<double>& flex) {
  Bytes bytes;
  bytes.add(body);
  for (const JointTransform& joint : pose.joints) bytes.add(joint);
  for (const double f : flex) bytes.add(f);
  return bytes.hash();
}

}  // namespace bodyopt
