#include "trainer/proxy/taught_samples.h"

#include "base/progress.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "trainer/train/skinning/mesh_table.h"
#include "trainer/train/skinning/same_character.h"

namespace bodyopt {
namespace {

constexpr std::size_t kBlock = 10, kHeldoutEvery = 5;

}  // namespace

SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames) {
  require_same_character(make_mesh_table(in_order(character, morton_order(character.vertices))), character.skeleton,
                         teacher);
  SampleSet set;
  set.character = character;
  set.muscles = muscles;
  set.takes = {"clip"};
  set.controls = teacher.residual.controls;
  Deformer deformer(teacher, {.name = "cpu"});
  Progress progress("proxy: shapes of the basis", poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Evaluation frame = deformer.evaluate(poses.subspan(k, 1));
    const bool heldout = k / kBlock % kHeldoutEvery == kHeldoutEvery - 1;
    (heldout ? set.heldout : set.train)
        .push_back({0, frames[k], poses[k], SampleShape(welded_from_output(character, frame.positions.data()))});
    progress.advance();
  }
  return set;
}

}  // namespace bodyopt
