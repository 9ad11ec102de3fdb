#include "runtime/library/following_outputs.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "runtime/library/guard.h"
#include "runtime/library/strides.h"

namespace bodyopt {
namespace {

PlacedVertices without_gaps(std::vector<float>& values, std::size_t vertices, std::size_t frames) {
  constexpr std::size_t kVertex = 3 * sizeof(float);
  values.resize(3 * vertices * frames);
  return {reinterpret_cast<std::byte*>(values.data()), kVertex, kVertex * vertices};
}

void find_outputs(const bodyopt_skin& skin, const Attachments& attached, std::size_t frames,
                  std::vector<bodyopt_floats>& outputs) {
  const auto given = attached_outputs(skin.attached, skin.attached_count, attached, "skin.attached");
  outputs.assign(given.begin(), given.end());
  for (std::size_t m = 0; m < outputs.size(); ++m) {
    char name[48];  // a string of this length would be allocated
    std::snprintf(name, sizeof(name), "skin.attached[%zu]", m);
    check_output(outputs[m], frames, attached.meshes[m].vertex_count(), 3, name);
  }
  if (std::ranges::all_of(outputs, [](const bodyopt_floats& output) { return output.data == nullptr; })) {
    outputs.clear();
  }
}

}  // namespace

FollowingOutputs::FollowingOutputs(const bodyopt_skin& skin, const FollowingMeshes& meshes, std::size_t frames,
                                   FollowingMemory& memory)
    : meshes_(meshes),
      vertices_(meshes.basis().mesh.output_count()),
      positions_(skin.positions),
      normals_(skin.normals),
      full_(skin.full_positions),
      memory_(memory) {
  find_outputs(skin, meshes.attached(), frames, memory.attached);
  if (wants_full_skin() && meshes.full_skin().empty()) {
    throw Error(ErrorKind::usage, "'skin.full_positions' is wanted of a model that carries no full skin");
  }
  check_output(full_, frames, meshes.full_skin().size(), 3, "skin.full_positions");
}

SkinPlace FollowingOutputs::gather(std::size_t frames, const SkinPlace& place) {
  SkinPlace gathered = place;
  gathered.positions = without_gaps(memory_.skin, vertices_, frames);
  if (wants_full_skin()) gathered.normals = without_gaps(memory_.normals, vertices_, frames);
  return gathered;
}

void FollowingOutputs::write(std::span<const Pose> poses, std::size_t begin, Executor& threads) const {
  scatter(memory_.skin, positions_, begin, vertices_, 3);
  if (wants_full_skin()) {
    scatter(memory_.normals, normals_, begin, vertices_, 3);
    scatter(meshes_.carry_full_skin(memory_.skin, memory_.normals, memory_.meshes, threads), full_, begin,
            meshes_.full_skin().size(), 3);
  }
  if (memory_.attached.empty()) return;
  meshes_.carry_each(memory_.skin, poses, memory_.meshes,
                     [&](std::size_t f, std::size_t m, const std::vector<float>& points) {
                       scatter(points, memory_.attached[m], begin + f, points.size() / 3, 3);
                     });
}

}  // namespace bodyopt
