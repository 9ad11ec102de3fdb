#include "runtime/library/following_outputs.h"

#include <algorithm>
#include <string>

#include "runtime/host/carry_skin.h"
#include "runtime/library/guard.h"
#include "runtime/library/strides.h"

namespace bodyopt {
namespace {

PlacedVertices without_gaps(std::vector<float>& values, std::size_t vertices, std::size_t frames) {
  constexpr std::size_t kVertex = 3 * sizeof(float);
  values.resize(3 * vertices * frames);
  return {reinterpret_cast<std::byte*>(values.data()), kVertex, kVertex * vertices};
}

std::vector<bodyopt_floats> outputs_of(const bodyopt_skin& skin, const Attachments& attached, std::size_t frames) {
  std::vector<bodyopt_floats> outputs = attached_outputs(skin.attached, skin.attached_count, attached, "skin.attached");
  for (std::size_t m = 0; m < outputs.size(); ++m) {
    check_output(outputs[m], frames, attached.meshes[m].vertex_count(), 3, concat("skin.attached[", m, "]").c_str());
  }
  if (std::ranges::all_of(outputs, [](const bodyopt_floats& output) { return output.data == nullptr; })) return {};
  return outputs;
}

}  // namespace

FollowingOutputs::FollowingOutputs(const bodyopt_skin& skin, const FollowingMeshes& meshes, std::size_t frames)
    : meshes_(meshes),
      vertices_(meshes.model->basis.mesh.output_count()),
      positions_(skin.positions),
      normals_(skin.normals),
      attached_(outputs_of(skin, meshes.attached, frames)),
      full_(skin.full_positions) {
  if (wants_full_skin() && meshes.full_skin.empty()) {
    throw Error(ErrorKind::usage, "'skin.full_positions' is wanted of a model that carries no full skin");
  }
  check_output(full_, frames, meshes.full_skin.size(), 3, "skin.full_positions");
}

SkinPlace FollowingOutputs::gather(std::size_t frames, const SkinPlace& place) {
  SkinPlace gathered = place;
  gathered.positions = without_gaps(gathered_, vertices_, frames);
  if (wants_full_skin()) gathered.normals = without_gaps(gathered_normals_, vertices_, frames);
  return gathered;
}

void FollowingOutputs::write(std::span<const Pose> poses, std::size_t begin, Executor& threads) const {
  const CharacterModel& model = *meshes_.model;
  scatter(gathered_, positions_, begin, vertices_, 3);
  if (wants_full_skin()) {
    scatter(gathered_normals_, normals_, begin, vertices_, 3);
    scatter(carry_skin(model.basis.mesh, meshes_.full_skin, gathered_, gathered_normals_, threads), full_, begin,
            meshes_.full_skin.size(), 3);
  }
  if (attached_.empty()) return;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const std::span<const float> skin = std::span(gathered_).subspan(3 * vertices_ * f, 3 * vertices_);
    const std::vector<std::vector<float>> carried = meshes_.carrier.carry(skin, poses[f].joints);
    for (std::size_t m = 0; m < carried.size(); ++m) {
      scatter(carried[m], attached_[m], begin + f, carried[m].size() / 3, 3);
    }
  }
}

}  // namespace bodyopt
