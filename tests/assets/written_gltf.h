// What a .glb of ours holds, for tests of its writers.
#pragma once

#include <cstring>
#include <vector>

#include "assets/gltf/gltf_file.h"

namespace bodyopt::testing {

// The numbers of an accessor of floats, SCALAR or VEC3.
inline std::vector<float> numbers(const tinygltf::Model& model, int accessor) {
  const tinygltf::Accessor& a = model.accessors.at(static_cast<std::size_t>(accessor));
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
  std::vector<float> values(a.count * (a.type == TINYGLTF_TYPE_VEC3 ? 3 : 1));
  std::memcpy(values.data(), model.buffers.at(0).data.data() + view.byteOffset, values.size() * sizeof(float));
  return values;
}

}  // namespace bodyopt::testing
