// Outputs of a call that are made of its skin: attached meshes, and the full skin of a level of detail.
#pragma once

#include <span>
#include <vector>

#include "runtime/core/executor.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"

namespace bodyopt {

// What a caller has for attached meshes; empty: for none. Throws Error(usage) unless there is one of each.
template <typename Output>
std::span<const Output> attached_outputs(const Output* given, std::uint32_t count, const Attachments& attached,
                                         const char* name) {
  if (count == 0) return {};
  if (count != attached.meshes.size()) {
    throw Error(ErrorKind::usage, "'", name, "' has ", count, " outputs, the model has ", attached.meshes.size(),
                " attached meshes");
  }
  return {&required(given, name), count};
}

class FollowingOutputs {
 public:
  // `skin`: of this version, its other outputs checked. `meshes` and `memory` must outlive it. Throws Error(usage) for
  // outputs of meshes that the model does not have, and as check_output().
  FollowingOutputs(const bodyopt_skin& skin, const FollowingMeshes& meshes, std::size_t frames,
                   FollowingMemory& memory);

  bool wanted() const { return !memory_.attached.empty() || wants_full_skin(); }
  // The place that the skin of `frames` frames goes to first, instead of the caller's memory.
  SkinPlace gather(std::size_t frames, const SkinPlace& place);
  // Writes the outputs that follow the gathered skin, for the frames `begin` and after.
  void write(std::span<const Pose> poses, std::size_t begin, Executor& threads) const;

 private:
  bool wants_full_skin() const { return full_.data != nullptr; }

  const FollowingMeshes& meshes_;
  std::size_t vertices_;
  bodyopt_floats positions_, normals_, full_;  // the caller's
  FollowingMemory& memory_;
};

}  // namespace bodyopt
