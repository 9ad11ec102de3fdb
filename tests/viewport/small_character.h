// Characters of the viewport's tests, as files.
#pragma once

#include <string>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/small_basis.h"
#include "tests/support/small_dynamics.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::testing {

constexpr int kClipFrames = 12;

// A bend of the second joint, shaken sideways.
inline Clip bending_clip(const Skeleton& skeleton) {
  Clip clip;
  clip.name = "bend";
  for (int k = 0; k < kClipFrames; ++k) {
    Pose pose = bind_pose(skeleton);
    pose.joints[0].translation[0] += 0.03 * std::sin(2.0 * k);
    pose.joints[1].rotation = normalized(pose.joints[1].rotation * axis_angle({1, 0, 0}, 0.1 * k));
    clip.poses.push_back(pose);
  }
  return clip;
}

// So many frames of that, over and over.
inline std::string write_long_clip(const TemporaryFolder& folder, const Skeleton& skeleton, std::size_t frames) {
  Clip clip = bending_clip(skeleton);
  while (clip.poses.size() < frames) clip.poses.push_back(clip.poses[clip.poses.size() % kClipFrames]);
  const std::string file = (folder / "long.glb").string();
  write_clip(clip, skeleton, file);
  return file;
}

// What the basis makes of every frame of the clip, moved by `away` metres upwards: `first_frame`, ... one a sample.
inline void write_truth(const Basis& basis, const Clip& clip, float away, const std::filesystem::path& path) {
  Deformer deformer(basis, DeviceChoice{.name = "cpu"});
  Pc2Writer writer(path, basis.mesh.output_count(), static_cast<std::uint32_t>(clip.poses.size()), 1, 1);
  for (const Pose& pose : clip.poses) {
    std::vector<float> positions = deformer.evaluate({&pose, 1}).positions;
    for (std::size_t k = 1; k < positions.size(); k += 3) positions[k] += away;
    writer.append(positions);
  }
  writer.close();
}

// A basis with fibres, a control and a residual; its clip; a truth 2 mm above.
struct SmallCharacter {
  explicit SmallCharacter(const TemporaryFolder& folder)
      : made(small_basis()),
        basis((folder / "small.safetensors").string()),
        clip((folder / "bend.glb").string()),
        truth((folder / "truth.pc2").string()) {
    save_basis(made, basis);
    write_clip(bending_clip(made.skeleton), made.skeleton, clip);
    write_truth(made, read_clip(clip, made.skeleton, {}), 0.002f, truth);
  }
  Basis made;
  std::string basis, clip, truth;
};

// A limb that learned from shapes, and so knows what it covers; at rest.
struct TrainedCharacter {
  explicit TrainedCharacter(const TemporaryFolder& folder)
      : made(trained_basis(limb_samples(160, 0), {.centres = 60})), basis((folder / "trained.safetensors").string()) {
    save_basis(made, basis);
  }
  Basis made;
  std::string basis;
};

// One that jiggles.
struct JigglingCharacter {
  explicit JigglingCharacter(const TemporaryFolder& folder)
      : basis((folder / "limb.safetensors").string()), clip((folder / "limb.glb").string()) {
    save_basis(made.basis, basis);
    save_dynamics(made.dynamics, folder / "limb.dynamics.safetensors");
    write_clip(bending_clip(made.basis.skeleton), made.basis.skeleton, clip);
  }
  const SmallDynamics& made = small_dynamics();
  std::string basis, clip;
};

}  // namespace bodyopt::testing
