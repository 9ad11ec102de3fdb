// Writing .glb: accessors are appended to one binary chunk, the JSON is filled in by the caller.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "runtime/core/json.h"

namespace bodyopt {

enum class GlbTarget : int { none = 0, vertices = 34962, indices = 34963 };

class GlbWriter {
 public:
  GlbWriter();

  Json root;

  // Each returns the new accessor's index. `type`: SCALAR, VEC2, VEC3, VEC4 or MAT4.
  std::size_t add(std::span<const float> values, const std::string& type, GlbTarget target);
  std::size_t add(std::span<const std::uint16_t> values, const std::string& type, GlbTarget target);
  std::size_t add(std::span<const std::uint32_t> values, const std::string& type, GlbTarget target);

  // Returns the number of a new buffer view.
  std::size_t add_bytes(std::string_view bytes);
  // Adds JOINTS_n and WEIGHTS_n to the attributes of a mesh: the joints and weights of each vertex, four in a set, and
  // as many sets as a vertex of `most` needs.
  using VertexWeights = std::vector<std::pair<std::uint16_t, float>>;
  void add_weights(std::span<const VertexWeights> vertices, std::size_t most, Json& attributes);

  // Names an extension that the file uses, or also that it cannot be read without.
  void use(const char* extension, bool is_required = false);

  // Appends the joints as nodes, in their default pose, below one new node called "skeleton". Joint j is node j when
  // called first. Returns the new node's index.
  std::size_t add_skeleton(const Skeleton& skeleton);
  // All joints of add_skeleton(), which returned `top`, bound as the skeleton is: programs make one armature of them.
  void add_skin(const Skeleton& skeleton, std::size_t top);

  // The file's bytes; messages call it `path`. Throws Error(file), also for numbers that are not finite.
  std::string bytes(const std::filesystem::path& path);
  // Writes to a temporary name, then renames. Throws as above, and Error(usage) over what others wrote.
  void write(const std::filesystem::path& path);

 private:
  template <class T>
  std::size_t add_values(std::span<const T> values, int component_type, const std::string& type, GlbTarget target);
  std::size_t add_view(std::span<const std::byte> bytes, GlbTarget target);

  std::vector<unsigned char> binary_;
  bool finite_ = true;
};

// Is there no file, or one whose generator begins so? It stands at the beginning of what GlbWriter writes. What others
// wrote under the name of a result is perhaps a character.
bool may_be_replaced(const std::filesystem::path& path, const std::string& generator);

// Adds a channel of straight lines to an animation. `times`, `values`: accessors of its keys.
void add_channel(std::size_t times, std::size_t values, std::size_t node, const char* path, Json& animation);

}  // namespace bodyopt
