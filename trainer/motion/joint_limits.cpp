#include "trainer/motion/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/json_file.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr const char* kSchema = "bodyopt-joint-limits-1";
constexpr double kLargestAngle = 360;      // degrees
constexpr double kLargestDeviation = 180;  // degrees

using JointPairs = std::map<std::uint32_t, std::uint32_t>;

// The deviation of a joint, which may be none.
struct Deviation {
  double degrees = 0;
  std::string source;
};

class LimitsReader {
 public:
  LimitsReader(const std::filesystem::path& path, const Skeleton& skeleton) : path_(path), skeleton_(skeleton) {}

  JointLimits read(const Json& json) {
    const JsonObject top(json, path_, "the file");
    top.allow({"schema", "source", "mirrored_joints", "dofs", "deviations", "poses", "detached_joints"});
    if (top.has("source")) limits_.source = top.text("source");
    if (top.has("mirrored_joints")) read_pairs(top.objects("mirrored_joints"));
    const Json& list = top.array("dofs");
    if (list.empty()) top.refuse("has no degree of freedom in 'dofs'");
    for (std::size_t k = 0; k < list.size(); ++k) read_dof(list[k], "dofs[" + std::to_string(k) + "]");
    if (top.has("deviations")) read_deviations(top.objects("deviations"));
    add_usual_deviations();
    if (top.has("poses")) read_poses(top.objects("poses"));
    if (top.has("detached_joints")) read_detached(top.objects("detached_joints"));
    return limits_;
  }

 private:
  std::uint32_t joint(const std::string& name) const {
    const int joint = skeleton_.find(name);
    if (joint < 0) {
      throw Error(ErrorKind::mismatch, path_.string() + ": there are limits for the joint '" + name +
                                           "', which the character does not have: limits of another character?");
    }
    return static_cast<std::uint32_t>(joint);
  }

  void read_pairs(const std::vector<JsonObject>& list) {
    for (const JsonObject& pair : list) {
      pair.allow({"joint", "mirror"});
      if (!mirrored_.emplace(joint(pair.name("joint")), joint(pair.name("mirror"))).second) {
        pair.refuse("has the joint '" + pair.name("joint") + "' of an earlier pair");
      }
    }
  }

  void read_dof(const Json& json, const std::string& place) {
    const JsonObject object(json, path_, place);
    object.allow({"name", "mirror", "source", "rest", "min", "max", "turns"});
    DegreeOfFreedom dof;
    if (object.has("source")) dof.source = object.text("source");
    dof.name = object.name("name");
    dof.rest = object.number("rest", -kLargestAngle, kLargestAngle);
    dof.min = object.number("min", -kLargestAngle, kLargestAngle);
    dof.max = object.number("max", -kLargestAngle, kLargestAngle);
    const Json& turns = object.array("turns");
    if (turns.empty()) object.refuse("'" + dof.name + "' turns no joint");
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const JsonObject turn(turns[k], path_, place + " '" + dof.name + "' turns[" + std::to_string(k) + "]");
      dof.turns.push_back(read_turn(turn));
    }
    check_range(dof, object);
    add(dof, object);
    if (!object.has("mirror")) return;
    mirrored_dofs_[limits_.dofs.size() - 1] = limits_.dofs.size();
    mirrored_dofs_[limits_.dofs.size()] = limits_.dofs.size() - 1;
    add(mirror_image(dof, object), object);
  }

  JointTurn read_turn(const JsonObject& object) const {
    object.allow({"joint", "axis", "share"});
    const std::string name = object.name("joint");
    JointTurn turn{joint(name), {}};
    const Json& axis = object.array("axis");
    const std::string wrong = "of the joint '" + name + "': 'axis' is ";
    if (axis.size() != 3) object.refuse(wrong + "not three numbers");
    for (std::size_t i = 0; i < 3; ++i) {
      turn.axis[i] = axis[i].is_number() ? axis[i].get<double>() : std::nan("");
      if (!(std::abs(turn.axis[i]) <= 1e3)) object.refuse(wrong + "not three numbers of ordinary size");
    }
    const double size = length(turn.axis);
    if (!(size > 1e-3)) object.refuse(wrong + "zero: it names no direction");
    turn.axis = (1 / size) * turn.axis;
    if (object.has("share")) turn.share = object.number("share", -2, 2);
    return turn;
  }

  void check_range(const DegreeOfFreedom& dof, const JsonObject& object) const {
    const std::string who = "'" + dof.name + "' (joint '" + skeleton_.joints[dof.turns[0].joint].name + "') ";
    if (dof.min > dof.max) object.refuse(who + "has its 'min' above its 'max': the other way round?");
    if (dof.min == dof.max) object.refuse(who + "has equal 'min' and 'max': nothing can move");
    if (dof.rest < dof.min || dof.rest > dof.max) {
      throw Error(ErrorKind::mismatch, path_.string() + ": " + who + "excludes the character's rest pose: 'rest' " +
                                           Json(dof.rest).dump() + " is not within " + Json(dof.min).dump() + " to " +
                                           Json(dof.max).dump() + ": limits made for another bind pose?");
    }
  }

  // Mirrors across the plane x = 0. An axis is a pseudovector: its component along the plane's normal stays.
  DegreeOfFreedom mirror_image(DegreeOfFreedom dof, const JsonObject& object) const {
    bool moved = false;
    for (JointTurn& turn : dof.turns) {
      const auto other = mirrored_.find(turn.joint);
      moved = moved || other != mirrored_.end();
      if (other != mirrored_.end()) turn.joint = other->second;
      turn.axis = {turn.axis[0], -turn.axis[1], -turn.axis[2]};
    }
    if (!moved) object.refuse("'" + dof.name + "' has a mirror, but none of its joints is in 'mirrored_joints'");
    dof.name = object.name("mirror");
    return dof;
  }

  void add(const DegreeOfFreedom& dof, const JsonObject& object) {
    if (!names_.insert(dof.name).second) object.refuse("has the name of an earlier one, '" + dof.name + "'");
    limits_.dofs.push_back(dof);
  }

  // Reads those named, then adds their mirror images that are not named themselves.
  void read_deviations(const std::vector<JsonObject>& list) {
    for (const JsonObject& object : list) {
      object.allow({"joint", "degrees", "source"});
      const std::string name = object.name("joint");
      const Deviation deviation{object.number("degrees", 0, kLargestDeviation),
                                object.has("source") ? object.text("source") : ""};
      if (!deviations_.emplace(joint(name), deviation).second) {
        object.refuse("has the joint '" + name + "' of an earlier one");
      }
    }
    for (const auto& [one, other] : mirrored_) {
      if (deviations_.contains(one)) deviations_.emplace(other, deviations_.at(one));
      if (deviations_.contains(other)) deviations_.emplace(one, deviations_.at(other));
    }
  }

  void add_usual_deviations() {
    for (const DegreeOfFreedom& dof : limits_.dofs) {
      for (const JointTurn& turn : dof.turns) deviations_.emplace(turn.joint, Deviation{kUsualDeviation, ""});
    }
    for (const auto& [joint, deviation] : deviations_) {
      if (deviation.degrees > 0) limits_.deviations.push_back({joint, deviation.degrees, deviation.source});
    }
  }

  std::uint32_t mirror_image(std::uint32_t joint) const {
    for (const auto& [one, other] : mirrored_) {
      if (one == joint) return other;
      if (other == joint) return one;
    }
    return joint;
  }

  void read_detached(const std::vector<JsonObject>& list) {
    for (const JsonObject& object : list) {
      object.allow({"joint", "follows", "source"});
      const DetachedJoint read{joint(object.name("joint")), joint(object.name("follows")),
                               object.has("source") ? object.text("source") : ""};
      if (is_detached_.contains(read.joint))
        object.refuse("has the joint '" + object.name("joint") + "' of an earlier one");
      if (hangs_under(skeleton_, limits_.detached, read.follows, read.joint)) {
        object.refuse("lets '" + object.name("joint") + "' follow a joint that itself hangs under it");
      }
      is_detached_.insert(read.joint);
      limits_.detached.push_back(read);
    }
    const std::vector<DetachedJoint> named = limits_.detached;
    for (const DetachedJoint& of : named) {
      const DetachedJoint image{mirror_image(of.joint), mirror_image(of.follows), of.source};
      const bool closes_circle = hangs_under(skeleton_, limits_.detached, image.follows, image.joint);
      if (!closes_circle && is_detached_.insert(image.joint).second) limits_.detached.push_back(image);
    }
  }

  void read_poses(const std::vector<JsonObject>& list) {
    for (const JsonObject& object : list) {
      object.allow({"name", "source", "angles"});
      if (object.has("source")) object.text("source");
      const CommonPose pose{object.name("name"), read_angles(object.json(), object)};
      const CommonPose image{pose.name + ", mirrored", mirror_image(pose.angles)};
      limits_.poses.push_back(pose);
      if (!mirrored_.empty() && image.angles != pose.angles) limits_.poses.push_back(image);
    }
  }

  // An angle that is not named is at rest, or as its mirror image is.
  std::vector<double> read_angles(const Json& json, const JsonObject& pose) const {
    if (!json.contains("angles") || !json.at("angles").is_object()) pose.refuse("has no object 'angles'");
    const JsonObject angles(json.at("angles"), path_, "the pose '" + pose.name("name") + "'");
    for (const auto& [name, angle] : json.at("angles").items()) {
      if (!names_.contains(name)) angles.refuse("has an angle of '" + name + "', which is no degree of freedom");
    }
    std::vector<double> result;
    for (std::size_t k = 0; k < limits_.dofs.size(); ++k) {
      const DegreeOfFreedom& dof = limits_.dofs[k];
      const auto other = mirrored_dofs_.find(k);
      const std::string image = other == mirrored_dofs_.end() ? dof.name : limits_.dofs[other->second].name;
      const std::string& named = angles.has(dof.name.c_str()) ? dof.name : image;
      result.push_back(angles.has(named.c_str()) ? angles.number(named.c_str(), dof.min, dof.max) : dof.rest);
    }
    return result;
  }

  std::vector<double> mirror_image(const std::vector<double>& angles) const {
    std::vector<double> image = angles;
    for (std::size_t k = 0; k < angles.size(); ++k) {
      const DegreeOfFreedom& dof = limits_.dofs[k];
      const auto other = mirrored_dofs_.find(k);
      if (other != mirrored_dofs_.end()) {
        image[other->second] = angles[k];
      } else if (turns_sideways(dof)) {
        image[k] = std::clamp(2 * dof.rest - angles[k], dof.min, dof.max);
      }
    }
    return image;
  }

  // Across the plane x = 0 it goes the other way.
  static bool turns_sideways(const DegreeOfFreedom& dof) { return std::abs(dof.turns[0].axis[0]) < 0.5; }

  const std::filesystem::path& path_;
  const Skeleton& skeleton_;
  JointPairs mirrored_;
  std::map<std::size_t, std::size_t> mirrored_dofs_;  // either way
  std::map<std::uint32_t, Deviation> deviations_;
  std::set<std::string> names_;
  std::set<std::uint32_t> is_detached_;
  JointLimits limits_;
};

}  // namespace

bool hangs_under(const Skeleton& skeleton, const std::vector<DetachedJoint>& detached, std::uint32_t joint,
                 std::uint32_t above) {
  int at = static_cast<int>(joint);
  while (at >= 0 && at != static_cast<int>(above)) {
    const auto of = std::find_if(detached.begin(), detached.end(),
                                 [&](const DetachedJoint& d) { return static_cast<int>(d.joint) == at; });
    at = of != detached.end() ? static_cast<int>(of->follows) : skeleton.joints[static_cast<std::size_t>(at)].parent;
  }
  return at >= 0;
}

JointLimits read_joint_limits(const std::filesystem::path& path, const Skeleton& skeleton) {
  return LimitsReader(path, skeleton).read(read_json(path, kSchema));
}

JointLimits parse_joint_limits(std::string_view text, const std::filesystem::path& path, const Skeleton& skeleton) {
  return LimitsReader(path, skeleton).read(parse_json(text, path, kSchema));
}

Json to_json(const JointLimits& limits, const Skeleton& skeleton) {
  Json dofs = Json::array();
  for (const DegreeOfFreedom& dof : limits.dofs) {
    Json turns = Json::array();
    for (const JointTurn& turn : dof.turns) {
      turns.push_back({{"joint", skeleton.joints.at(turn.joint).name}, {"axis", turn.axis}, {"share", turn.share}});
    }
    dofs.push_back({{"name", dof.name}, {"rest", dof.rest}, {"min", dof.min}, {"max", dof.max}, {"turns", turns}});
    if (!dof.source.empty()) dofs.back()["source"] = dof.source;
  }
  Json deviations = Json::array(), poses = Json::array();
  std::map<std::uint32_t, Deviation> of_joints;
  for (const DegreeOfFreedom& dof : limits.dofs) {
    for (const JointTurn& turn : dof.turns) of_joints[turn.joint];  // none: the reader's default is another
  }
  for (const JointDeviation& deviation : limits.deviations) {
    of_joints[deviation.joint] = {deviation.degrees, deviation.source};
  }
  for (const auto& [joint, deviation] : of_joints) {
    deviations.push_back({{"joint", skeleton.joints.at(joint).name}, {"degrees", deviation.degrees}});
    if (!deviation.source.empty()) deviations.back()["source"] = deviation.source;
  }
  for (const CommonPose& pose : limits.poses) {
    Json angles = Json::object();
    for (std::size_t k = 0; k < limits.dofs.size(); ++k) angles[limits.dofs[k].name] = pose.angles[k];
    poses.push_back({{"name", pose.name}, {"angles", angles}});
  }
  Json detached = Json::array();
  for (const DetachedJoint& of : limits.detached) {
    detached.push_back(
        {{"joint", skeleton.joints.at(of.joint).name}, {"follows", skeleton.joints.at(of.follows).name}});
    if (!of.source.empty()) detached.back()["source"] = of.source;
  }
  Json json = {{"schema", kSchema}};
  if (!limits.source.empty()) json["source"] = limits.source;
  json.update({{"dofs", dofs}, {"deviations", deviations}, {"poses", poses}});
  if (!detached.empty()) json["detached_joints"] = detached;
  return json;
}

void write_joint_limits(const JointLimits& limits, const Skeleton& skeleton, const std::filesystem::path& path) {
  write_json(to_json(limits, skeleton), path);
}

}  // namespace bodyopt::trainer
