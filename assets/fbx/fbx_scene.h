// The objects of an FBX file and what is connected to what.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "assets/fbx/fbx_parse.h"
#include "runtime/core/transform.h"

namespace bodyopt {

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
