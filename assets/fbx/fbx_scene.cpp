#include "assets/fbx/fbx_scene.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"

namespace bodyopt {
namespace {

// JSON holds no other text than UTF-8.
std::string as_utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

// "Hips" of "Model::Hips" as text has it, or of "Hips", a mark and "Model" as binary does.
std::string object_name(const std::string& text) {
  const std::size_t mark = text.find(std::string_view("\0\1", 2));
  if (mark != std::string::npos) return as_utf8(text.substr(0, mark));
  const std::size_t colons = text.find("::");
  return as_utf8(colons == std::string::npos ? text : text.substr(colons + 2));
}

const FbxNode* defaults_of(const FbxNode& root, const std::string& kind) {
  for (const FbxNode& type : root.child("Definitions").children) {
    if (type.name == "ObjectType" && type.text(0) == kind) return type.child("PropertyTemplate").find("Properties70");
  }
  return nullptr;
}

const FbxNode* property_among(const FbxNode* properties, std::string_view name) {
  if (properties == nullptr) return nullptr;
  for (const FbxNode& property : properties->children) {
    if (property.text(0) == name) return &property;
  }
  return nullptr;
}

}  // namespace

FbxScene::FbxScene(const std::filesystem::path& path, std::string_view bytes)
    : path_(path), root_(parse_fbx(path, bytes)) {
  const FbxNode* objects = root_.find("Objects");
  const FbxNode* links = root_.find("Connections");
  if (objects == nullptr || links == nullptr) fail("has no Objects or no Connections; the FBX file is damaged");
  std::map<std::string, const FbxNode*> defaults;
  for (const FbxNode& node : objects->children) {
    const auto [found, is_new] = defaults.try_emplace(node.name);
    if (is_new) found->second = defaults_of(root_, node.name);
    const std::int64_t id = node.integer(0, 0);
    if (id == 0 || !place_.emplace(id, objects_.size()).second) continue;
    objects_.push_back({id, node.name, object_name(node.text(1)), node.text(2), &node, found->second});
  }
  for (const FbxNode& node : links->children) {
    const Link link{node.integer(1, 0), node.integer(2, 0), node.text(3)};
    from_.emplace(link.from, link);
    to_.emplace(link.to, link);
  }
  settings_.node = root_.find("GlobalSettings");
}

double FbxScene::ticks() const {
  const FbxNode* clock = root_.child("FBXHeaderExtension").child("OtherFlags").find("TCDefinition");
  const bool is_old = clock == nullptr ? root_.integer(0, 0) < 8000 : clock->integer(0, 0) == 127;
  return is_old ? 46186158000.0 : 141120000.0;
}

double FbxScene::setting(std::string_view name, double otherwise) const {
  return settings_.node == nullptr ? otherwise : number(settings_, name, otherwise);
}

double FbxScene::unit() const {
  const double centimetres = setting("UnitScaleFactor", 1);
  if (!(centimetres > 0)) fail("a unit of ", centimetres, " centimetres (UnitScaleFactor), expected a positive number");
  return centimetres / 100;
}

Quat FbxScene::axes() const {
  Affine to_ours;
  const char* const names[] = {"Coord", "Up", "Front"};
  const double otherwise[] = {0, 1, 2};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name = names[k];
    const double axis = setting(name + "Axis", otherwise[k]), sign = setting(name + "AxisSign", 1);
    for (std::size_t i = 0; i < 3; ++i) to_ours.m[k][i] = axis == static_cast<double>(i) ? (sign < 0 ? -1 : 1) : 0;
  }
  const auto row = [&](std::size_t k) { return Vec3{to_ours.m[k][0], to_ours.m[k][1], to_ours.m[k][2]}; };
  if (dot(cross(row(0), row(1)), row(2)) != 1) {
    fail(
        "its axes are no right-handed ones (CoordAxis, UpAxis and FrontAxis of its GlobalSettings); export it with Y or "
        "Z up, or by Blender: File > Import > FBX, File > Export > glTF");
  }
  return decompose(to_ours).rotation;
}

std::vector<const FbxObject*> FbxScene::into(std::int64_t id, std::string_view kind, std::string_view property) const {
  std::vector<const FbxObject*> found;
  const auto [begin, end] = to_.equal_range(id);
  for (auto link = begin; link != end; ++link) {
    const auto place = place_.find(link->second.from);
    if (place == place_.end() || link->second.property != property) continue;
    if (objects_[place->second].kind == kind) found.push_back(&objects_[place->second]);
  }
  return found;
}

std::vector<FbxScene::Target> FbxScene::targets(std::int64_t id) const {
  std::vector<Target> found;
  const auto [begin, end] = from_.equal_range(id);
  for (auto link = begin; link != end; ++link) {
    const auto place = place_.find(link->second.to);
    if (place != place_.end()) found.push_back({&objects_[place->second], link->second.property});
  }
  return found;
}

const FbxNode* FbxScene::property_of(const FbxObject& object, std::string_view name) const {
  const FbxNode* own = property_among(object.node->find("Properties70"), name);
  return own != nullptr ? own : property_among(object.defaults, name);
}

double FbxScene::number(const FbxObject& object, std::string_view property, double otherwise) const {
  const FbxNode* found = property_of(object, property);
  const double value = found == nullptr ? otherwise : found->number(4, otherwise);
  if (!std::isfinite(value)) fail(property, " of '", object.name, "' is not a finite number");
  return value;
}

Vec3 FbxScene::vector(const FbxObject& object, std::string_view property, const Vec3& otherwise) const {
  const FbxNode* found = property_of(object, property);
  if (found == nullptr) return otherwise;
  Vec3 value{};
  for (std::size_t k = 0; k < 3; ++k) {
    value[k] = found->number(4 + k, otherwise[k]);
    if (!std::isfinite(value[k])) fail(property, " of '", object.name, "' is not a finite number");
  }
  return value;
}

}  // namespace bodyopt
