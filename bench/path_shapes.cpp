// path_shapes DATASET: the built-in arm's acting, solved twice: every frame reached through the two before it (take
// "to"), and through the two after it (take "fro"). Elastic equilibria are not unique, so that the takes disagree: real
// data for `curate add consistency`. Every fourth frame is held out. The folder must exist.
#include <cstdio>
#include <filesystem>

#include "assets/pc2.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "dataset/dataset.h"
#include "runtime/core/error.h"
#include "trainer/builtin/arm.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::bench {
namespace {

constexpr int kFrames = 144, kStep = 3, kHeldout = 4;

// The frames that are solved, by rising number.
std::vector<int> solved_frames() {
  std::vector<int> frames;
  for (int frame = 1; frame <= kFrames; frame += kStep) frames.push_back(frame);
  return frames;
}

// The pose of a frame, and those that led to it; `way`: 1 to the end of the clip, -1 back from it.
std::vector<Pose> path_to(const Clip& clip, int frame, int way) {
  std::vector<Pose> path;
  for (int before = 2; before >= 0; --before) {
    const int at = frame - way * before * kStep;
    if (at >= 1 && at <= kFrames) path.push_back(clip.poses[static_cast<std::size_t>(at - 1)]);
  }
  return path;
}

void write_take(const BuiltinArm& arm, const QuasiStaticBody& body, const Clip& clip, int way, DatasetTake take,
                Dataset& dataset) {
  take.frames = solved_frames();
  std::vector<std::vector<float>> shapes(take.frames.size());
  std::vector<FrameStatus> status(take.frames.size());
  Progress progress(take.name, shapes.size());
  parallel_for(shapes.size(), [&](std::size_t k) {
    const SolvedPose solved = body.solve_along(path_to(clip, take.frames[k], way), {});
    shapes[k] = output_from_welded(arm.character, body.skin(solved.nodes));
    status[k] = solved.status;
    status[k].frame = take.frames[k];
    progress.advance();
  });
  Pc2Writer writer(dataset.folder / take.shapes, arm.character.output_count(),
                   static_cast<std::uint32_t>(shapes.size()), 1, kStep);
  for (const std::vector<float>& shape : shapes) writer.append(shape);
  writer.close();
  write_frame_status(status, dataset.folder / take.shapes_status);
  for (std::size_t k = kHeldout / 2; k < take.frames.size(); k += kHeldout) take.heldout.push_back(take.frames[k]);
  dataset.takes.push_back(std::move(take));
}

void write_dataset_of_paths(const std::filesystem::path& folder) {
  const BuiltinArm arm = build_arm();
  const Clip clip = arm_heldout(arm.character.skeleton, kFrames);
  const QuasiStaticBody body(arm.character, arm.muscles, 0.0);
  Dataset dataset;
  dataset.folder = folder;
  dataset.character = "character.glb";
  dataset.muscles = "muscles.json";
  write_character(arm.character, folder / dataset.character);
  write_muscles(arm.muscles, arm.character.skeleton, folder / dataset.muscles);
  write_clip(clip, arm.character.skeleton, folder / "acting.glb");
  for (const int way : {1, -1}) {
    const std::string name = way > 0 ? "to" : "fro";
    write_take(arm, body, clip, way,
               {.name = name, .clip = "acting.glb", .shapes = name + ".pc2", .shapes_status = name + ".status.json"},
               dataset);
  }
  write_dataset(dataset, folder / "dataset.json");
}

}  // namespace
}  // namespace bodyopt::bench

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "path_shapes DATASET\n");
    return 64;
  }
  try {
    bodyopt::bench::write_dataset_of_paths(arguments[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
