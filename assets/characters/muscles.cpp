#include "assets/characters/muscles.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "base/json_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

constexpr const char* kMusclesSchema = "bodyopt-muscles-1";

MusclePoint read_point(const JsonObject& json, const Skeleton& skeleton) {
  json.allow({"joint", "position"});
  const std::string name = json.text("joint");
  const int joint = skeleton.find(name);
  if (joint < 0) {
    throw Error(ErrorKind::mismatch, json.path(), ": a muscle is bound to the joint '", name,
                "', which the character does not have: muscles of another character?");
  }
  const Json& position = json.array("position");
  MusclePoint point{static_cast<std::uint32_t>(joint), {}};
  if (position.size() != 3) json.refuse("'position' is not three numbers");
  for (std::size_t i = 0; i < 3; ++i) {
    point.position[i] = position[i].is_number() ? position[i].get<double>() : std::nan("");
    if (!(std::abs(point.position[i]) < 1e4)) json.refuse("'position' is not three finite numbers in metres");
  }
  return point;
}

Muscle read_muscle(const JsonObject& json, const Skeleton& skeleton) {
  json.allow({"name", "radius", "fibre_count", "max_activation", "path"});
  Muscle muscle;
  muscle.name = json.name("name");
  muscle.radius = json.number("radius", 1e-5, 1);
  muscle.fibre_count = json.integer("fibre_count", 0, 64);
  muscle.max_activation = json.number("max_activation", 0, 1);
  const Json& points = json.array("path");
  for (std::size_t k = 0; k < points.size(); ++k) {
    const JsonObject point(points[k], json.path(), json.place() + ".path[" + std::to_string(k) + "]");
    muscle.path.push_back(read_point(point, skeleton));
  }
  double total = 0;
  for (std::size_t k = 1; k < muscle.path.size(); ++k) {
    total += length(muscle.path[k].position - muscle.path[k - 1].position);
  }
  if (muscle.path.size() < 2 || !(total > 1e-4))
    json.refuse("has a path without length: two different points at least");
  return muscle;
}

std::vector<Muscle> muscles_of(const Json& json, const std::filesystem::path& path, const Skeleton& skeleton) {
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "muscles"});
  std::vector<Muscle> muscles;
  std::set<std::string> names;
  for (const JsonObject& entry : top.objects("muscles")) {
    muscles.push_back(read_muscle(entry, skeleton));
    if (!names.insert(muscles.back().name).second) entry.refuse("has the name of an earlier muscle");
  }
  return muscles;
}

}  // namespace

std::vector<Muscle> read_muscles(const std::filesystem::path& path, const Skeleton& skeleton) {
  return muscles_of(read_json(path, kMusclesSchema), path, skeleton);
}

std::vector<Muscle> parse_muscles(std::string_view text, const std::filesystem::path& path, const Skeleton& skeleton) {
  return muscles_of(parse_json(text, path, kMusclesSchema), path, skeleton);
}

void write_muscles(const std::vector<Muscle>& muscles, const Skeleton& skeleton, const std::filesystem::path& path) {
  Json list = Json::array();
  for (const Muscle& muscle : muscles) {
    const Json points = transformed(muscle.path, [&](const MusclePoint& point) {
      return Json{{"joint", skeleton.joints.at(point.joint).name}, {"position", point.position}};
    });
    list.push_back({{"name", muscle.name},
                    {"radius", muscle.radius},
                    {"fibre_count", muscle.fibre_count},
                    {"max_activation", muscle.max_activation},
                    {"path", points}});
  }
  write_json({{"schema", kMusclesSchema}, {"muscles", list}}, path);
}

void require_fit(const std::vector<Muscle>& muscles, const Skeleton& skeleton) {
  if (skeleton.size() == 0) throw Error(ErrorKind::mismatch, "the character has no joints to drive it");
  for (const Muscle& muscle : muscles) {
    if (muscle.path.size() < 2 || !(muscle.radius > 0)) {
      throw Error(ErrorKind::mismatch, "muscle '", muscle.name, "' needs two points or more and a radius above 0");
    }
    for (const MusclePoint& point : muscle.path) {
      if (point.joint < skeleton.size()) continue;
      throw Error(ErrorKind::mismatch, "muscle '", muscle.name, "' is bound to a joint the skeleton lacks");
    }
  }
}

}  // namespace bodyopt
