// The objects of an FBX file and what is connected to what.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// The tree of nodes that an FBX file is, from binary or text, of bytes that nobody vouches for.

// Raw data (pictures) are strings.
using FbxValue = std::variant<std::int64_t, double, std::string, std::vector<std::int64_t>, std::vector<double>>;

struct FbxNode {
  std::string name;
  std::vector<FbxValue> values;
  std::vector<FbxNode> children;

  // The first child of that name, or nullptr.
  const FbxNode* find(std::string_view child) const;
  // All numbers among the values, those of arrays one by one.
  std::vector<double> numbers() const;
  // All whole numbers among the values, those of arrays one by one.
  std::vector<std::int64_t> integers() const;
  // The value there as it is asked for, or `otherwise` where there is none of the kind.
  double number(std::size_t place, double otherwise) const;
  std::int64_t integer(std::size_t place, std::int64_t otherwise) const;
  std::string text(std::size_t place) const;
};

bool is_fbx(std::string_view bytes);

// The nodes at the top are the children of what is returned, whose values are the version (7400, say) and 1 for text
// or 0. Messages call the file `path`. Throws Error(file), also for versions below 7000.
FbxNode parse_fbx(const std::filesystem::path& path, std::string_view bytes);

struct FbxObject {
  std::int64_t id = 0;
  std::string kind, name, type;  // "Model", "mixamorig:Hips", "LimbNode"
  const FbxNode* node = nullptr;
  const FbxNode* defaults = nullptr;  // properties that objects of its kind share, or nullptr
};

class FbxScene {
 public:
  // Throws Error(file).
  FbxScene(const std::filesystem::path& path, std::string_view bytes);
  FbxScene(const FbxScene&) = delete;

  const std::vector<FbxObject>& objects() const { return objects_; }
  bool is_text() const { return root_.integer(1, 0) == 1; }
  // The file's ticks in a second.
  double ticks() const;
  // Metres per unit.
  double unit() const;
  // Turns the file's axes to X right, Y up, Z to the front. Throws Error(file) where they are no right-handed axes.
  Quat axes() const;

  // Objects that are connected into an object (0: the scene), or into one of its properties, in order.
  std::vector<const FbxObject*> into(std::int64_t id, std::string_view kind, std::string_view property = "") const;
  // An object into which another is connected, and the property or "".
  struct Target {
    const FbxObject* object;
    std::string property;
  };
  std::vector<Target> targets(std::int64_t id) const;

  // Reads an object's Properties70, or else its defaults. Throws Error(file) for numbers that are not finite.
  double number(const FbxObject& object, std::string_view property, double otherwise) const;
  Vec3 vector(const FbxObject& object, std::string_view property, const Vec3& otherwise) const;

  // Throws Error(file), the message starting with the path.
  [[noreturn]] void fail(const auto&... problem) const { throw Error(ErrorKind::file, path_, ": ", problem...); }

 private:
  struct Link {
    std::int64_t from, to;
    std::string property;
  };
  const FbxNode* property_of(const FbxObject& object, std::string_view name) const;
  double setting(std::string_view name, double otherwise) const;

  std::filesystem::path path_;
  FbxNode root_;
  FbxObject settings_;
  std::vector<FbxObject> objects_;
  std::map<std::int64_t, std::size_t> place_;    // of an id among the objects
  std::multimap<std::int64_t, Link> from_, to_;  // links by either end
};

}  // namespace bodyopt
