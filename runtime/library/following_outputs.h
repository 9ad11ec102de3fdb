// Outputs of a call that are made of its skin: attached meshes, and the full skin of a level of detail.
#pragma once

#include <span>
#include <vector>

#include "runtime/core/executor.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"

namespace bodyopt {

// Copies of what a caller has for attached meshes; empty: for none. Throws Error(usage) unless there is one of each.
template <typename Output>
std::vector<Output> attached_outputs(const Output* given, std::uint32_t count, const Attachments& attached,
                                     const char* name) {
  if (count == 0) return {};
  if (count != attached.meshes.size()) {
    throw Error(ErrorKind::usage, "'", name, "' has ", count, " outputs, the model has ", attached.meshes.size(),
                " attached meshes");
  }
  const Output* const first = &required(given, name);
  return {first, first + count};
}

class FollowingOutputs {
 public:
  // `skin`: of this version, its other outputs checked. `meshes` must outlive it. Throws Error(usage) for outputs of
  // meshes that the model does not have, and as check_output().
  FollowingOutputs(const bodyopt_skin& skin, const FollowingMeshes& meshes, std::size_t frames);

  bool wanted() const { return !attached_.empty() || wants_full_skin(); }
  // The place that the skin of `frames` frames goes to first, instead of the caller's memory.
  SkinPlace gather(std::size_t frames, const SkinPlace& place);
  // Writes the outputs that follow the gathered skin, for the frames `begin` and after.
  void write(std::span<const Pose> poses, std::size_t begin, Executor& threads) const;

 private:
  bool wants_full_skin() const { return full_.data != nullptr; }

  const FollowingMeshes& meshes_;
  std::size_t vertices_;
  bodyopt_floats positions_, normals_;    // the caller's, of the skin
  std::vector<bodyopt_floats> attached_;  // of each mesh; empty: none is wanted
  bodyopt_floats full_;
  std::vector<float> gathered_, gathered_normals_;  // without gaps
};

}  // namespace bodyopt
