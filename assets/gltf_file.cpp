#include "assets/gltf_file.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "assets/gltf_guard.h"
#include "runtime/core/error.h"

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

double number_at(const unsigned char* data, int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return number_at<std::int8_t>(data, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return number_at<std::uint8_t>(data, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return number_at<std::int16_t>(data, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return number_at<std::uint16_t>(data, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return number_at<std::uint32_t>(data, normalized);
    default:
      return number_at<float>(data, normalized);
  }
}

std::size_t component_bytes(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

}  // namespace

struct GltfFile::View {
  const unsigned char* data;
  std::size_t count, components, stride, component_size;
  int component_type;
  bool normalized;
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
  if (!loaded) fail("not a valid glTF file: " + error);
  bytes_left_ = std::size_t{64} << 20;
  for (std::vector<unsigned char>& buffer : guarded.buffers) {
    bytes_left_ += 16 * buffer.size();
    model_.buffers.emplace_back().data = std::move(buffer);
  }
}

void GltfFile::fail(const std::string& problem) const { throw Error(ErrorKind::file, path_.string() + ": " + problem); }

GltfFile::View GltfFile::view(int index, int type, const std::string& what) const {
  if (index < 0 || index >= std::ssize(model_.accessors)) fail(what + ": no accessor " + std::to_string(index));
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.sparse.isSparse) fail(what + ": sparse accessors are not supported; export without them");
  if (accessor.type != type) fail(what + ": the accessor has another type than it should (VEC3, VEC4, ...)");
  View view{nullptr,
            accessor.count,
            component_count(type),
            0,
            component_bytes(accessor.componentType),
            accessor.componentType,
            accessor.normalized};
  if (view.component_size == 0) {
    fail(what + ": unknown component type " + std::to_string(accessor.componentType));
  }
  if (accessor.bufferView < 0 || accessor.bufferView >= std::ssize(model_.bufferViews)) {
    fail(what + ": the accessor has no data (bufferView missing or out of range; is the mesh compressed?)");
  }
  const tinygltf::BufferView& part = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (part.buffer < 0 || part.buffer >= std::ssize(model_.buffers)) fail(what + ": its buffer does not exist");
  const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(part.buffer)].data;
  if (part.byteOffset > buffer.size() || part.byteLength > buffer.size() - part.byteOffset) {
    fail(what + ": its buffer view reaches beyond the buffer");
  }
  const std::size_t element = view.components * view.component_size;
  view.stride = part.byteStride == 0 ? element : part.byteStride;
  if (view.stride < element) fail(what + ": its stride is smaller than an element");
  if (view.count == 0) fail(what + ": is empty");
  if (accessor.byteOffset > part.byteLength || part.byteLength - accessor.byteOffset < element ||
      (part.byteLength - accessor.byteOffset - element) / view.stride < view.count - 1) {
    fail(what + ": " + std::to_string(view.count) + " elements reach beyond the buffer view; the file is damaged");
  }
  const std::size_t cost = view.count * view.components * sizeof(double);
  if (cost > bytes_left_) fail(what + ": the same bytes are used over and over; the file is damaged or hostile");
  bytes_left_ -= cost;
  view.data = buffer.data() + part.byteOffset + accessor.byteOffset;
  return view;
}

std::vector<double> GltfFile::numbers(int accessor, int type, const std::string& what) const {
  const View v = view(accessor, type, what);
  if (v.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) fail(what + ": unsigned integers where reals belong");
  std::vector<double> values;
  values.reserve(v.count * v.components);
  for (std::size_t i = 0; i < v.count; ++i) {
    for (std::size_t k = 0; k < v.components; ++k) {
      const unsigned char* data = v.data + i * v.stride + k * v.component_size;
      values.push_back(number_at(data, v.component_type, v.normalized));
      if (!std::isfinite(values.back())) fail(what + ": element " + std::to_string(i) + " is not a finite number");
    }
  }
  return values;
}

std::vector<std::uint32_t> GltfFile::indices(int accessor, int type, const std::string& what) const {
  const View v = view(accessor, type, what);
  if (v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(what + ": expected unsigned integers");
  }
  std::vector<std::uint32_t> values;
  values.reserve(v.count * v.components);
  for (std::size_t i = 0; i < v.count; ++i) {
    for (std::size_t k = 0; k < v.components; ++k) {
      const unsigned char* data = v.data + i * v.stride + k * v.component_size;
      values.push_back(static_cast<std::uint32_t>(number_at(data, v.component_type, false)));
    }
  }
  return values;
}

}  // namespace bodyopt
