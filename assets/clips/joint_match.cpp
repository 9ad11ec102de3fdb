#include "assets/clips/joint_match.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/json_file.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

using Roles = std::vector<std::optional<JointRole>>;
using JointPair = std::pair<std::size_t, std::size_t>;  // of the source, of the skeleton

// The joints of a part from the lowest up.
std::vector<std::size_t> chain_of(const Roles& roles, BodyPart part) {
  std::map<std::size_t, std::size_t> chain;
  for (std::size_t j = 0; j < roles.size(); ++j) {
    if (roles[j] && roles[j]->part == part) chain[roles[j]->nested] = j;
  }
  std::vector<std::size_t> joints;
  for (const auto& [nested, joint] : chain) joints.push_back(joint);
  return joints;
}

class Matcher {
 public:
  Matcher(std::span<const NamedJoint> source, const Skeleton& skeleton)
      : source_(source.begin(), source.end()),
        target_(named_joints(skeleton)),
        source_roles_(source_.size()),
        target_roles_(target_.size()),
        match_(target_.size(), -1),
        taken_(source_.size(), false) {
    if (has_all_names()) return;
    source_roles_ = joint_roles(source_);
    target_roles_ = joint_roles(target_);
    pair_roles();
  }

  void match_by_map(const std::string& path, const std::string& whose) {
    for (const MappedJoint& joint : read_joint_map(path)) {
      const std::size_t from = find(source_, joint.from, path, whose);
      pair(from, find(target_, joint.to, path, "the character"));
    }
  }

  template <class Key>
  std::vector<std::string> match_by_name(Key key) {
    std::map<std::string, std::size_t> joints;
    std::vector<std::string> found;
    for (std::size_t s = 0; s < source_.size(); ++s) {
      if (!taken_[s]) joints.try_emplace(key(source_[s].name), s);
    }
    for (std::size_t t = 0; t < target_.size(); ++t) {
      const auto entry = match_[t] < 0 ? joints.find(key(target_[t].name)) : joints.end();
      if (entry == joints.end() || taken_[entry->second] || contradicts(entry->second, t)) continue;
      pair(entry->second, t);
      found.push_back(target_[t].name);
    }
    return found;
  }

  // Says "LeftHip' moves 'LeftUpLeg" of each: a list of names puts quotes around it.
  std::vector<std::string> match_by_role() {
    std::vector<std::string> found;
    for (const auto& [s, t] : role_pairs_) {
      if (match_[t] >= 0 || taken_[s]) continue;
      pair(s, t);
      found.push_back(source_[s].name + "' moves '" + target_[t].name);
    }
    return found;
  }

  const std::vector<int>& match() const { return match_; }

 private:
  // A clip of the character's own skeleton, whatever else is in its file.
  bool has_all_names() const {
    const std::vector<std::string> names = names_of(source_);
    const std::set<std::string> known(names.begin(), names.end());
    return std::ranges::all_of(target_, [&](const auto& joint) { return known.contains(joint.name); });
  }

  void pair(std::size_t s, std::size_t t) {
    match_[t] = static_cast<int>(s);
    taken_[s] = true;
  }

  static std::size_t find(const std::vector<NamedJoint>& joints, const std::string& name, const std::string& path,
                          const std::string& whose) {
    const auto found = std::ranges::find_if(joints, [&](const auto& joint) { return joint.name == name; });
    if (found != joints.end()) return static_cast<std::size_t>(found - joints.begin());
    throw Error(ErrorKind::mismatch, path, ": maps the joint '", name, "', which ", whose,
                " does not have: ", list_names(nearest_names(names_of(joints), name)),
                " are nearest. A map of another clip or character?");
  }

  // Equal names that stand for different parts of the body.
  bool contradicts(std::size_t s, std::size_t t) const {
    const auto has_other = [&](const JointPair& pair) { return (pair.first == s) != (pair.second == t); };
    if (std::ranges::any_of(role_pairs_, has_other)) return true;
    const auto &own = source_roles_[s], &other = target_roles_[t];
    return own && other && (own->part != other->part || own->side != other->side);
  }

  void pair_roles() {
    for (const BodyPart part : {BodyPart::spine, BodyPart::neck}) pair_chains(part);
    for (std::size_t t = 0; t < target_.size(); ++t) {
      const std::optional<JointRole>& role = target_roles_[t];
      if (!role || role->part == BodyPart::spine || role->part == BodyPart::neck) continue;
      const auto found = std::ranges::find(source_roles_, role);
      if (found != source_roles_.end()) {
        role_pairs_.emplace_back(static_cast<std::size_t>(found - source_roles_.begin()), t);
      }
    }
  }

  void pair_chains(BodyPart part) {
    const std::vector<std::size_t> s = chain_of(source_roles_, part), t = chain_of(target_roles_, part);
    if (s.empty() || t.empty()) return;
    const std::size_t fewer = std::min(s.size(), t.size()), more = std::max(s.size(), t.size());
    if (fewer < more && names_of_fewer_are_among_more(s, t)) return;  // matched by name
    for (std::size_t k = 0; k < fewer; ++k) {
      // A single joint takes the turn of all the others: the topmost of the source, the lowest of the character.
      const double place = fewer > 1 ? static_cast<double>(k * (more - 1)) / static_cast<double>(fewer - 1) : 0;
      std::size_t along = static_cast<std::size_t>(std::lround(place));
      if (fewer == 1 && t.size() == 1) along = more - 1;
      role_pairs_.emplace_back(s.size() == fewer ? s[k] : s[along], t.size() == fewer ? t[k] : t[along]);
    }
  }

  bool names_of_fewer_are_among_more(const std::vector<std::size_t>& s, const std::vector<std::size_t>& t) const {
    std::set<std::string> of_source, of_target;
    for (const std::size_t j : s) of_source.insert(lower_case(source_[j].name));
    for (const std::size_t j : t) of_target.insert(lower_case(target_[j].name));
    const auto &fewer = s.size() < t.size() ? of_source : of_target,
               &more = s.size() < t.size() ? of_target : of_source;
    return std::includes(more.begin(), more.end(), fewer.begin(), fewer.end());
  }

  std::vector<NamedJoint> source_, target_;
  Roles source_roles_, target_roles_;
  std::vector<JointPair> role_pairs_;
  std::vector<int> match_;
  std::vector<bool> taken_;
};

}  // namespace

std::vector<int> match_joints(std::span<const NamedJoint> source, const Skeleton& skeleton,
                              const std::string& joint_map, const std::string& whose, std::vector<std::string>& notes) {
  Matcher matcher(source, skeleton);
  if (!joint_map.empty()) matcher.match_by_map(joint_map, whose);
  matcher.match_by_name([](const std::string& name) { return name; });
  note_names("Matched without regard to case: ", matcher.match_by_name(lower_case), notes);
  const std::vector<std::string> by_role = matcher.match_by_role();
  if (!by_role.empty()) notes.push_back("Matched by naming convention: " + list_names(by_role, 40) + ".");
  return matcher.match();
}

void note_parted(const Skeleton& skeleton, const std::vector<int>& match, std::vector<std::string>& notes) {
  const auto roles = joint_roles(named_joints(skeleton));
  std::vector<bool> is_carried;
  std::vector<std::string> parted;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const auto above = static_cast<std::size_t>(std::max(parent, 0));
    is_carried.push_back(parent >= 0 && (match[above] >= 0 || is_carried[above]));
    if (parent >= 0 && match[j] >= 0 && !is_carried[j] && roles[j]) parted.push_back(skeleton.joints[j].name);
  }
  if (parted.size() < 2) return;
  notes.push_back(list_names(parted) +
                  " hang on joints that the clip does not move, and come apart: say what moves those (--joint-map).");
}

std::vector<MappedJoint> read_joint_map(const std::filesystem::path& path) {
  const JsonFile top(path, "bodyopt-joint-map-1", "the file", {"schema", "joints"});
  const std::vector<JsonObject> list = top.objects("joints");
  if (list.empty()) top.refuse("maps no joint in 'joints'");
  std::vector<MappedJoint> joints;
  std::set<std::string> from, to;
  for (const JsonObject& object : list) {
    object.allow({"from", "to"});
    const MappedJoint joint{object.name("from"), object.name("to")};
    if (!from.insert(joint.from).second) object.refuse("maps '", joint.from, "' of the clip for the second time");
    if (!to.insert(joint.to).second) object.refuse("maps to '", joint.to, "' for the second time");
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace bodyopt
