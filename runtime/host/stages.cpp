#include "runtime/host/stages.h"

namespace bodyopt {
namespace {

bool applies(Stage stage, const Basis& basis, const Batch& batch) {
  switch (stage) {
    case Stage::rig:
      return false;
    case Stage::modify:
      return !basis.modifiers.empty();
    case Stage::diffuse:
    case Stage::jiggle:
      return !batch.jiggle.empty();
    case Stage::strain:
    case Stage::residual:
    case Stage::pose:
    case Stage::output:
      break;
  }
  return true;
}

}  // namespace

std::vector<Stage> stages_of(const Basis& basis, const Batch& batch) {
  std::vector<Stage> stages;
  for (const StageDescription& description : kStages) {
    if (applies(description.stage, basis, batch)) stages.push_back(description.stage);
  }
  return stages;
}

}  // namespace bodyopt
