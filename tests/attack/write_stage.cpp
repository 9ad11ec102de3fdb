// Writes what the attack (scripts/attack) runs the program on: a limb, its motion and muscles, things to attach, shapes
// from elsewhere. Small, so that every verb ends within a second or two.
//   attack_stage FOLDER
#include <iostream>

#include "assets/caches/pc2.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/assets/gltf_blob.h"
#include "tests/attack/limb_mapping.h"
#include "tests/muscle_models/small_models.h"
#include "tests/simulate/limb.h"
#include "tests/support/attached_limb.h"
#include "tests/support/small_dynamics.h"
#include "trainer/motion/joint_limits.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

using namespace trainer;

constexpr int kFrames = 48, kTogether = 8;  // as many as run at once in a race

Clip bending(const Character& limb) {
  Clip clip;
  clip.name = "bend";
  for (int f = 0; f < kFrames; ++f) {
    Pose pose = bent(limb, degrees(40 - 40 * std::cos(0.4 * f)));
    pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({1, 0, 0}, degrees(20 * std::sin(0.7 * f)));
    clip.poses.push_back(pose);
  }
  return clip;
}

void write_prop(const LooseMesh& mesh, const std::filesystem::path& path) {
  GltfBlob blob;
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  for (const Vec3& p : mesh.vertices) positions.insert(positions.end(), p.begin(), p.end());
  for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  const std::size_t position = blob.vectors(positions), indices = blob.add(corners, 5125, "SCALAR", 1);
  blob.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
  blob.root["nodes"] = {{{"name", mesh.name}, {"mesh", 0}}};
  blob.root["scenes"] = {{{"nodes", {0}}}};
  put_bytes(path, blob.glb());
}

// Frames 1 to 6 of the clip, skinned; every cache is a little rougher than the one before. (Moved ones are refused.)
void write_shapes(const Character& limb, const Clip& clip, double rough, const std::filesystem::path& path) {
  constexpr std::uint32_t kShapes = 6;
  Pc2Writer writer(path, limb.output_count(), kShapes);
  for (std::size_t f = 0; f < kShapes; ++f) {
    Positions shape = skin_linear(limb, clip.poses[f]);
    for (Eigen::Index v = 0; v < shape.rows(); ++v) shape(v, 1) += v % 2 == 0 ? rough : -rough;
    writer.append(output_from_welded(limb, shape));
  }
  writer.close();
}

// What fuzzers begin with that only the trainer makes, and what it belongs to (tests/fuzz/given_file.h).
void write_for_fuzzers(const std::filesystem::path& folder) {
  const testing::OneTet one;
  save_basis(one.basis, folder / "tet.safetensors");
  save_dynamics(one.dynamics, folder / "tet.dynamics.safetensors");
  Deformer deformer(one.basis, one.dynamics, {}, {.name = "cpu"});
  const std::vector<Pose> poses(3, bind_pose(one.basis.skeleton));
  deformer.jiggle(poses, std::vector{1, 2, 3});
  save_state(deformer.state(), one.dynamics, folder / "tet.state");
  save_basis(limb_basis(), folder / "capsule.safetensors");
  save_attachments(attached_to_limb({blade()}), folder / "capsule.attached.safetensors");
}

void write_stage(const std::filesystem::path& folder) {
  const Character limb = make_limb();
  const Clip clip = bending(limb);
  write_character(limb, folder / "limb.glb");
  write_clip(clip, limb.skeleton, folder / "bend.glb");
  write_muscles({make_flexor()}, limb.skeleton, folder / "muscles.json");
  JointLimits limits;
  limits.dofs = {{"flexion", 0, 0, 80, {{1, {0, 0, 1}, 1}}}, {"twist", 0, -20, 20, {{1, {1, 0, 0}, 1}}}};
  write_joint_limits(limits, limb.skeleton, folder / "limits.json");
  put_bytes(folder / "modifiers.json", R"({"schema": "bodyopt-modifiers-1", "modifiers": [
 {"name": "tense", "type": "flex", "muscles": "muscles.json"}]})");
  put_bytes(folder / "model.osim", testing::small_osim());
  put_bytes(folder / "mapping.json", attack::kLimbMapping);
  for (int k = 0; k < kTogether; ++k) {
    const std::string number = std::to_string(k);
    write_prop(sphere_at("prop" + number, {0.1 + 0.04 * k, 0.05, 0}, 0.006), folder / ("prop" + number + ".glb"));
    write_shapes(limb, clip, 1e-4 * k, folder / ("shapes" + number + ".pc2"));
  }
}

void write(const std::filesystem::path& folder) {
  write_stage(folder);
  std::filesystem::create_directories(folder / "fuzz");
  write_for_fuzzers(folder / "fuzz");
}

}  // namespace
}  // namespace bodyopt

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: attack_stage FOLDER\n";
    return 64;
  }
  try {
    bodyopt::write(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
