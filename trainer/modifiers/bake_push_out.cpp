// Push-out: which skin may come to lie behind which, seen in poses that bend one joint after the other all around, and
// in those of a clip.
#include "assets/clip.h"
#include "runtime/basis/character_unit.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/fold_search.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostClipPoses = 200;

std::vector<Pose> clip_poses(const BakeInput& input) {
  const std::string source = (input.folder / input.parameters.name("clip")).string();
  ClipOptions options;
  options.unit = clip_unit(source, kept_unit(input.basis));
  const Clip clip = read_clip(source, input.basis.skeleton, options);
  std::vector<Pose> poses;
  const std::size_t step = (clip.poses.size() + kMostClipPoses - 1) / kMostClipPoses;
  for (std::size_t k = 0; k < clip.poses.size(); k += step) {
    poses.push_back(clip.poses[k]);
    poses.back().controls.clear();
  }
  return poses;
}

}  // namespace

// joints, numbers: see runtime/modifiers/drive_push_out.cpp.
BakedModifier bake_push_out(const BakeInput& input) {
  FoldSearch search(input.basis);
  search.bend_all();
  if (input.parameters.has("clip")) search.look(clip_poses(input));
  return search.baked();
}

}  // namespace bodyopt
