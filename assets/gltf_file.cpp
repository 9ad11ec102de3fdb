#include "assets/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "assets/gltf_guard.h"

namespace bodyopt {
namespace {

template <class T>
double number_at(const unsigned char* data, bool normalized) {
  T value;
  std::memcpy(&value, data, sizeof value);
  if constexpr (std::is_integral_v<T>) {
    if (normalized) return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
  }
  return static_cast<double>(value);
}

struct ComponentType {
  int type;
  std::size_t bytes;
  double (*number_at)(const unsigned char* data, bool normalized);
};

constexpr ComponentType kComponentTypes[] = {{TINYGLTF_COMPONENT_TYPE_BYTE, 1, number_at<std::int8_t>},
                                             {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, 1, number_at<std::uint8_t>},
                                             {TINYGLTF_COMPONENT_TYPE_SHORT, 2, number_at<std::int16_t>},
                                             {TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 2, number_at<std::uint16_t>},
                                             {TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 4, number_at<std::uint32_t>},
                                             {TINYGLTF_COMPONENT_TYPE_FLOAT, 4, number_at<float>}};

}  // namespace

struct GltfFile::View {
  const unsigned char* data;
  std::size_t count, components, stride, component_size;
  int component_type;
  bool normalized;
  double (*number_at)(const unsigned char* data, bool normalized);

  const unsigned char* at(std::size_t element, std::size_t k) const {
    return data + element * stride + k * component_size;
  }
};

GltfFile::GltfFile(const std::filesystem::path& path) : GltfFile(path, read_gltf_bytes(path)) {}

GltfFile::GltfFile(const std::filesystem::path& path, std::string_view bytes) : path_(path) {
  GuardedGltf guarded = guard_gltf(path, bytes);
  std::string error, warning;
  bool loaded = false;
  try {
    tinygltf::TinyGLTF loader;
    loaded = loader.LoadASCIIFromString(&model_, &error, &warning, guarded.json.data(),
                                        static_cast<unsigned int>(guarded.json.size()), "");
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (!loaded) fail("not a valid glTF file: ", error);
  bytes_left_ = std::size_t{64} << 20;
  for (std::vector<unsigned char>& buffer : guarded.buffers) {
    bytes_left_ += 16 * buffer.size();
    model_.buffers.emplace_back().data = std::move(buffer);
  }
}

GltfFile::View GltfFile::view(int index, int type, const std::string& what) const {
  if (index < 0 || index >= std::ssize(model_.accessors)) fail(what, ": no accessor ", index);
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.sparse.isSparse) fail(what, ": sparse accessors are not supported; export without them");
  if (accessor.type != type) fail(what, ": the accessor has another type than it should (VEC3, VEC4, ...)");
  const auto component = std::ranges::find(kComponentTypes, accessor.componentType, &ComponentType::type);
  if (component == std::end(kComponentTypes)) fail(what, ": unknown component type ", accessor.componentType);
  const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  View view{nullptr,          accessor.count,  components,          0,
            component->bytes, component->type, accessor.normalized, component->number_at};
  if (accessor.bufferView < 0 || accessor.bufferView >= std::ssize(model_.bufferViews)) {
    fail(what, ": the accessor has no data (bufferView missing or out of range; is the mesh compressed?)");
  }
  const tinygltf::BufferView& part = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (part.buffer < 0 || part.buffer >= std::ssize(model_.buffers)) fail(what, ": its buffer does not exist");
  const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(part.buffer)].data;
  if (part.byteOffset > buffer.size() || part.byteLength > buffer.size() - part.byteOffset) {
    fail(what, ": its buffer view reaches beyond the buffer");
  }
  const std::size_t element = view.components * view.component_size;
  view.stride = part.byteStride == 0 ? element : part.byteStride;
  if (view.stride < element) fail(what, ": its stride is smaller than an element");
  if (view.count == 0) fail(what, ": is empty");
  if (accessor.byteOffset > part.byteLength || part.byteLength - accessor.byteOffset < element ||
      (part.byteLength - accessor.byteOffset - element) / view.stride < view.count - 1) {
    fail(what, ": ", view.count, " elements reach beyond the buffer view; the file is damaged");
  }
  const std::size_t cost = view.count * view.components * sizeof(double);
  if (cost > bytes_left_) fail(what, ": the same bytes are used over and over; the file is damaged or hostile");
  bytes_left_ -= cost;
  view.data = buffer.data() + part.byteOffset + accessor.byteOffset;
  return view;
}

std::vector<double> GltfFile::numbers(int accessor, int type, const std::string& what) const {
  const View v = view(accessor, type, what);
  if (v.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) fail(what, ": unsigned integers where reals belong");
  std::vector<double> values;
  values.reserve(v.count * v.components);
  for (std::size_t i = 0; i < v.count; ++i) {
    for (std::size_t k = 0; k < v.components; ++k) {
      values.push_back(v.number_at(v.at(i, k), v.normalized));
      if (!std::isfinite(values.back())) fail(what, ": element ", i, " is not a finite number");
    }
  }
  return values;
}

std::vector<std::uint32_t> GltfFile::indices(int accessor, int type, const std::string& what) const {
  const View v = view(accessor, type, what);
  if (v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(what, ": expected unsigned integers");
  }
  std::vector<std::uint32_t> values;
  values.reserve(v.count * v.components);
  for (std::size_t i = 0; i < v.count; ++i) {
    for (std::size_t k = 0; k < v.components; ++k) {
      values.push_back(static_cast<std::uint32_t>(v.number_at(v.at(i, k), false)));
    }
  }
  return values;
}

}  // namespace bodyopt
