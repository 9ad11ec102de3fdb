#include "runtime/host/stages.h"

#include "runtime/basis/basis.h"
#include "runtime/host/backend.h"

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

double StageSeconds::sum() const {
  double sum = 0;
  for_each([&](const StageDescription&, double seconds) { sum += seconds; });
  return sum;
}

void StageSeconds::add(Stage stage, double seconds) { seconds_[index_of(stage)] = of(stage).value_or(0) + seconds; }

void StageSeconds::add(const StageSeconds& other) {
  other.for_each([&](const StageDescription& description, double seconds) { add(description.stage, seconds); });
}

std::vector<Stage> stages_of(const Basis& basis, const Batch& batch, std::vector<Stage> stages) {
  stages.clear();
  for (const StageDescription& description : kStages) {
    if (applies(description.stage, basis, batch)) stages.push_back(description.stage);
  }
  return stages;
}

}  // namespace bodyopt
