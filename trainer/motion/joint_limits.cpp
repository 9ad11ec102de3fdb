#include "trainer/motion/joint_limits.h"

#include <cmath>
#include <map>
#include <set>

#include "runtime/basis/error.h"
#include "trainer/dataset/json_file.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-joint-limits-1";
constexpr double kLargestAngle = 360;  // degrees

using JointPairs = std::map<std::uint32_t, std::uint32_t>;

class LimitsReader {
 public:
  LimitsReader(const std::filesystem::path& path, const Skeleton& skeleton) : path_(path), skeleton_(skeleton) {}

  JointLimits read() {
    const Json json = read_json(path_, kSchema);
    const JsonObject top(json, path_, "the file");
    top.allow({"schema", "source", "mirrored_joints", "dofs"});
    if (top.has("source")) top.text("source");
    if (top.has("mirrored_joints")) read_pairs(top.array("mirrored_joints"));
    const Json& list = top.array("dofs");
    if (list.empty()) top.refuse("has no degree of freedom in 'dofs'");
    for (std::size_t k = 0; k < list.size(); ++k) read_dof(list[k], "dofs[" + std::to_string(k) + "]");
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

  void read_pairs(const Json& list) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      const JsonObject pair(list[k], path_, "mirrored_joints[" + std::to_string(k) + "]");
      pair.allow({"joint", "mirror"});
      if (!mirrored_.emplace(joint(pair.name("joint")), joint(pair.name("mirror"))).second) {
        pair.refuse("has the joint '" + pair.name("joint") + "' of an earlier pair");
      }
    }
  }

  void read_dof(const Json& json, const std::string& place) {
    const JsonObject object(json, path_, place);
    object.allow({"name", "mirror", "source", "rest", "min", "max", "turns"});
    if (object.has("source")) object.text("source");
    DegreeOfFreedom dof;
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
    if (object.has("mirror")) add(mirror_image(dof, object), object);
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

  // Across the plane x = 0. An axis is a pseudovector: its component along the plane's normal stays.
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

  const std::filesystem::path& path_;
  const Skeleton& skeleton_;
  JointPairs mirrored_;
  std::set<std::string> names_;
  JointLimits limits_;
};

}  // namespace

JointLimits read_joint_limits(const std::filesystem::path& path, const Skeleton& skeleton) {
  return LimitsReader(path, skeleton).read();
}

void write_joint_limits(const JointLimits& limits, const Skeleton& skeleton, const std::filesystem::path& path) {
  Json dofs = Json::array();
  for (const DegreeOfFreedom& dof : limits.dofs) {
    Json turns = Json::array();
    for (const JointTurn& turn : dof.turns) {
      turns.push_back({{"joint", skeleton.joints.at(turn.joint).name}, {"axis", turn.axis}, {"share", turn.share}});
    }
    dofs.push_back({{"name", dof.name}, {"rest", dof.rest}, {"min", dof.min}, {"max", dof.max}, {"turns", turns}});
  }
  write_json({{"schema", kSchema}, {"dofs", dofs}}, path);
}

}  // namespace bodyopt
