#include "assets/gltf/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "assets/fbx/fbx_parse.h"
#include "assets/gltf/gltf_guard.h"
#include "base/wording.h"
#include "runtime/core/transformed.h"

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

bool is_unsigned_integer(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

// Per node: is it in the scene? The reader of the nodes refuses children that do not exist.
std::vector<bool> nodes_of_scene(const tinygltf::Model& model, std::size_t scene) {
  std::vector<bool> shown(model.nodes.size(), false);
  std::vector<int> next = model.scenes[scene].nodes;
  while (!next.empty()) {
    const int node = next.back();
    next.pop_back();
    if (node < 0 || node >= std::ssize(shown) || shown[static_cast<std::size_t>(node)]) continue;
    shown[static_cast<std::size_t>(node)] = true;
    const std::vector<int>& children = model.nodes[static_cast<std::size_t>(node)].children;
    next.insert(next.end(), children.begin(), children.end());
  }
  return shown;
}

}  // namespace

// Numbers that lie one after the other in a buffer view.
struct GltfFile::Elements {
  int buffer_view;
  std::size_t offset, count, components;
  int component_type;
  bool normalized;
};

GltfFile::GltfFile(const std::filesystem::path& path) : GltfFile(path, read_gltf_bytes(path)) {}

GltfFile::GltfFile(const std::filesystem::path& path, std::string_view bytes) : path_(path), is_of_fbx_(is_fbx(bytes)) {
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
  look_ = std::move(guarded.look);
  if (!loaded) fail("not a valid glTF file: ", error);
  bytes_left_ = std::size_t{64} << 20;
  for (std::vector<unsigned char>& buffer : guarded.buffers) {
    bytes_left_ += 16 * buffer.size();
    model_.buffers.emplace_back().data = std::move(buffer);
  }
  keep_what_is_shown();
}

const tinygltf::Accessor& GltfFile::accessor(int index, int type, const std::string& what) const {
  if (index < 0 || index >= std::ssize(model_.accessors)) fail(what, ": no accessor ", index);
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.type != type) fail(what, ": the accessor has another type than it should (VEC3, VEC4, ...)");
  if (accessor.count == 0) fail(what, ": is empty");
  return accessor;
}

std::span<const unsigned char> GltfFile::bytes(int buffer_view, const std::string& what) const {
  if (buffer_view < 0 || buffer_view >= std::ssize(model_.bufferViews)) fail(what, ": no buffer view ", buffer_view);
  const tinygltf::BufferView& part = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (part.buffer < 0 || part.buffer >= std::ssize(model_.buffers)) fail(what, ": its buffer does not exist");
  const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(part.buffer)].data;
  if (part.byteOffset > buffer.size() || part.byteLength > buffer.size() - part.byteOffset) {
    fail(what, ": its buffer view reaches beyond the buffer");
  }
  return std::span(buffer).subspan(part.byteOffset, part.byteLength);
}

std::vector<double> GltfFile::decode(const Elements& elements, const std::string& what) const {
  const auto component = std::ranges::find(kComponentTypes, elements.component_type, &ComponentType::type);
  if (component == std::end(kComponentTypes)) fail(what, ": unknown component type ", elements.component_type);
  const std::size_t cost = elements.count * sizeof(double);
  if (elements.count > bytes_left_ / sizeof(double) || cost * elements.components > bytes_left_) {
    fail(what, ": ", elements.count, " elements are far more than the file can hold; it is damaged or hostile");
  }
  bytes_left_ -= cost * elements.components;
  std::vector<double> values(elements.count * elements.components, 0.0);
  if (elements.buffer_view == -1) return values;  // as the specification says

  const std::span<const unsigned char> view = bytes(elements.buffer_view, what);
  const std::size_t own_stride = model_.bufferViews[static_cast<std::size_t>(elements.buffer_view)].byteStride;
  const std::size_t element = elements.components * component->bytes;
  const std::size_t stride = own_stride == 0 ? element : own_stride;
  if (stride < element) fail(what, ": its stride is smaller than an element");
  if (elements.offset > view.size() || view.size() - elements.offset < element ||
      (view.size() - elements.offset - element) / stride < elements.count - 1) {
    fail(what, ": ", elements.count, " elements reach beyond the buffer view; the file is damaged");
  }
  const unsigned char* data = view.data() + elements.offset;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t row = i / elements.components, column = i % elements.components;
    values[i] = component->number_at(data + row * stride + column * component->bytes, elements.normalized);
  }
  return values;
}

std::vector<double> GltfFile::decode(const tinygltf::Accessor& accessor, const std::string& what) const {
  const auto components =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  std::vector<double> values = decode({accessor.bufferView, accessor.byteOffset, accessor.count, components,
                                       accessor.componentType, accessor.normalized},
                                      what);
  if (!accessor.sparse.isSparse) return values;
  const auto& [count, is_sparse, at, by] = accessor.sparse;
  if (count < 1 || at.byteOffset < 0 || by.byteOffset < 0 || at.bufferView < 0 || by.bufferView < 0) {
    fail(what, ": what is sparse in it has a count, an offset or a buffer view that cannot be");
  }
  if (!is_unsigned_integer(at.componentType)) fail(what, ": its sparse indices are no unsigned integers");
  const auto size = static_cast<std::size_t>(count);
  const std::vector<double> places =
      decode({at.bufferView, static_cast<std::size_t>(at.byteOffset), size, 1, at.componentType, false}, what);
  const std::vector<double> others = decode({by.bufferView, static_cast<std::size_t>(by.byteOffset), size, components,
                                             accessor.componentType, accessor.normalized},
                                            what);
  for (std::size_t k = 0; k < size; ++k) {
    const auto place = static_cast<std::size_t>(places[k]);
    if (place >= accessor.count) fail(what, ": sparse index ", place, " of ", accessor.count, " elements");
    std::copy_n(others.begin() + static_cast<std::ptrdiff_t>(k * components), components,
                values.begin() + static_cast<std::ptrdiff_t>(place * components));
  }
  return values;
}

std::vector<double> GltfFile::numbers(int index, int type, const std::string& what) const {
  const tinygltf::Accessor& source = accessor(index, type, what);
  if (source.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    fail(what, ": unsigned integers where reals belong");
  }
  std::vector<double> values = decode(source, what);
  const auto wrong = std::ranges::find_if_not(values, [](double value) { return std::isfinite(value); });
  if (wrong != values.end()) {
    const auto components = std::ssize(values) / static_cast<std::ptrdiff_t>(source.count);
    fail(what, ": element ", (wrong - values.begin()) / components, " is not a finite number");
  }
  return values;
}

std::vector<std::uint32_t> GltfFile::indices(int index, int type, const std::string& what) const {
  const tinygltf::Accessor& source = accessor(index, type, what);
  if (!is_unsigned_integer(source.componentType)) fail(what, ": expected unsigned integers");
  tinygltf::Accessor plain = source;
  plain.normalized = false;
  return transformed(decode(plain, what), [](const double value) { return static_cast<std::uint32_t>(value); });
}

// A coarser body beside the scene, another scene: what is not shown draws nothing from here on. Where the file's own
// scene shows no character, the first that does is taken, and where none does, everything.
void GltfFile::keep_what_is_shown() {
  const auto is_skinned = [](const tinygltf::Node& node) { return node.mesh >= 0 && node.skin >= 0; };
  const bool any_skinned = std::ranges::any_of(model_.nodes, is_skinned);
  const auto draws = [&](const tinygltf::Node& node) { return any_skinned ? is_skinned(node) : node.mesh >= 0; };
  const int count = static_cast<int>(model_.scenes.size()), own = std::max(0, model_.defaultScene);
  if (count == 0) return;
  if (own >= count) fail("its scene is ", own, ", and it has ", count, " of them, counted from 0");
  for (int k = 0; k < count; ++k) {
    const int scene = k == 0 ? own : k - (k <= own ? 1 : 0);
    const std::vector<bool> shown = nodes_of_scene(model_, static_cast<std::size_t>(scene));
    std::vector<std::string> hidden;
    bool is_drawn = false;
    for (std::size_t n = 0; n < shown.size(); ++n) is_drawn = is_drawn || (shown[n] && draws(model_.nodes[n]));
    if (!is_drawn) continue;
    for (std::size_t n = 0; n < shown.size(); ++n) {
      tinygltf::Node& node = model_.nodes[n];
      if (shown[n] || node.mesh < 0) continue;
      hidden.push_back(node.name.empty() ? "node " + std::to_string(n) : node.name);
      node.mesh = node.skin = -1;
    }
    if (k > 0) {
      notes_.push_back("The file's own scene " + std::to_string(own) + " shows no character: scene " +
                       std::to_string(scene) + " is read.");
    }
    note_names("Meshes that the scene does not show are left out: ", hidden, notes_);
    return;
  }
  if (any_skinned) notes_.push_back("No scene of the file shows its character: all of its nodes are read.");
}

}  // namespace bodyopt
