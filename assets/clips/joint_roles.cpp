#include "assets/clips/joint_roles.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

struct PartName {
  std::string_view word;  // a name in small letters, without side and number
  BodyPart part;
};

// clang-format off
constexpr PartName kMiddleNames[] = {
    {"hips", BodyPart::hips}, {"pelvis", BodyPart::hips}, {"hip", BodyPart::hips},
    {"lowerback", BodyPart::spine}, {"tospine", BodyPart::spine}, {"spine", BodyPart::spine}, {"abdomen", BodyPart::spine},
    {"chest", BodyPart::spine}, {"upperchest", BodyPart::spine},
    {"lowerneck", BodyPart::neck}, {"neck", BodyPart::neck},
    {"head", BodyPart::head},
};

constexpr PartName kSideNames[] = {
    {"hipjoint", BodyPart::hip_joint}, {"pelvis", BodyPart::hip_joint},
    {"upleg", BodyPart::thigh}, {"upperleg", BodyPart::thigh}, {"thigh", BodyPart::thigh}, {"hip", BodyPart::thigh},
    {"leg", BodyPart::shin}, {"lowerleg", BodyPart::shin}, {"shin", BodyPart::shin}, {"calf", BodyPart::shin},
    {"knee", BodyPart::shin},
    {"foot", BodyPart::foot}, {"ankle", BodyPart::foot},
    {"toe", BodyPart::toe}, {"toes", BodyPart::toe}, {"toebase", BodyPart::toe}, {"ball", BodyPart::toe},
    {"clavicle", BodyPart::clavicle}, {"collar", BodyPart::clavicle}, {"shoulder", BodyPart::clavicle},
    {"arm", BodyPart::upper_arm}, {"upperarm", BodyPart::upper_arm}, {"shldr", BodyPart::upper_arm},
    {"forearm", BodyPart::forearm}, {"lowerarm", BodyPart::forearm}, {"elbow", BodyPart::forearm},
    {"wrist", BodyPart::hand}, {"hand", BodyPart::hand},
    {"fingerbase", BodyPart::palm},
    {"thumb", BodyPart::thumb}, {"handthumb", BodyPart::thumb},
    {"index", BodyPart::index}, {"handindex", BodyPart::index},
    {"fingers", BodyPart::index}, {"handfinger", BodyPart::index},
    {"middle", BodyPart::middle}, {"handmiddle", BodyPart::middle}, {"mid", BodyPart::middle},
    {"ring", BodyPart::ring}, {"handring", BodyPart::ring},
    {"pinky", BodyPart::pinky}, {"handpinky", BodyPart::pinky},
};
// clang-format on

const PartName* find_part(std::span<const PartName> names, std::string_view word) {
  const auto found = std::ranges::find(names, word, &PartName::word);
  return found == names.end() ? nullptr : &*found;
}

// Drops prefixes of all joints' names: namespaces, "mixamorig", VRoid's "J_Bip_", HumanIK's "Character1_".
std::string_view without_prefix(std::string_view name) {
  name.remove_prefix(name.find_last_of(":|") + 1);  // npos + 1 is 0
  const auto strip = [&](std::string_view prefix, bool needs_separator) {
    if (!name.starts_with(prefix)) return;
    std::size_t end = prefix.size();
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end]))) ++end;
    const bool has_separator = end < name.size() && name[end] == '_';
    if (has_separator || !needs_separator) name.remove_prefix(end + (has_separator ? 1 : 0));
  };
  strip("mixamorig", false);
  strip("J_Bip", true);
  strip("Character", true);
  return name;
}

std::optional<BodySide> side_of(std::string_view word) {
  if (word == "l" || word == "left") return BodySide::left;
  if (word == "r" || word == "right") return BodySide::right;
  return std::nullopt;
}

struct ParsedName {
  std::string word;
  BodySide side = BodySide::middle;
};

// A side that is written without a gap: "lhand", "leftarm".
void split_side(ParsedName& name) {
  for (const std::string_view side : {"left", "right", "l", "r"}) {
    if (!name.word.starts_with(side) || !find_part(kSideNames, std::string_view(name.word).substr(side.size())))
      continue;
    name.side = *side_of(side);
    name.word.erase(0, side.size());
    return;
  }
}

// `ending`: the last word of most names, which says nothing.
ParsedName parse_name(const std::string& name, const std::string& ending) {
  std::vector<std::string> words = name_words(name);
  if (words.size() > 1 && words.back() == ending) words.pop_back();
  const auto numbers = std::erase_if(words, [](const std::string& word) { return std::isdigit(word[0]) != 0; });
  ParsedName parsed;
  if (words.empty() || numbers > 1) return parsed;  // two numbers: digits of a hand or foot, each rig in its own way
  if (const auto first = side_of(words.front())) {
    parsed.side = *first;
    words.erase(words.begin());
  } else if (const auto last = side_of(words.back())) {
    parsed.side = *last;
    words.pop_back();
  }
  if (words.size() > 1 && words.front() == "c") words.erase(words.begin());  // centre, as VRoid has it
  for (const std::string& word : words) parsed.word += word;
  if (parsed.side == BodySide::middle && !find_part(kMiddleNames, parsed.word)) split_side(parsed);
  return parsed;
}

bool ends_word(std::string_view name, std::size_t at) {
  const auto before = static_cast<unsigned char>(name[at - 1]);
  if (std::isalnum(before) == 0) return true;
  return std::isupper(before) == 0 && at < name.size() && std::isupper(static_cast<unsigned char>(name[at])) != 0;
}

// A part or a side?
bool tells(const std::string& word) {
  return side_of(word) || find_part(kMiddleNames, word) || find_part(kSideNames, word);
}

constexpr std::size_t kFewest = 4;  // names that share something

// Whole words that two thirds of the names begin with: "Bip01 ", "CC_Base_". Nothing where they say a part or a side.
std::string_view shared_prefix(std::span<const NamedJoint> joints) {
  std::vector<std::string_view> names;
  for (const NamedJoint& joint : joints) {
    if (!joint.name.empty()) names.push_back(joint.name);
  }
  if (names.size() < kFewest) return {};
  std::ranges::sort(names);
  const std::size_t many = (2 * names.size() + 2) / 3;
  std::string_view longest;
  for (std::size_t first = 0; first + many <= names.size(); ++first) {
    const std::string_view name = names[first], last = names[first + many - 1];
    auto length = static_cast<std::size_t>(std::ranges::mismatch(name, last).in1 - name.begin());
    while (length > 0 && !ends_word(name, length)) --length;
    if (length > longest.size()) longest = name.substr(0, length);
  }
  return std::ranges::any_of(name_words(longest), tells) ? std::string_view() : longest;
}

// The word that two thirds of the names end with: "_jnt". Nothing where it says a part, a side or a number.
std::string shared_ending(std::span<const NamedJoint> joints) {
  std::map<std::string, std::size_t> endings;
  for (const NamedJoint& joint : joints) {
    if (const std::vector<std::string> words = name_words(joint.name); words.size() > 1) ++endings[words.back()];
  }
  for (const auto& [word, count] : endings) {
    if (count >= kFewest && 3 * count >= 2 * joints.size() && !tells(word) && std::isdigit(word[0]) == 0) return word;
  }
  return {};
}

// The parts of a skeleton by its names, those that mean different things on different rigs by the names beside them.
class PartNames {
 public:
  explicit PartNames(std::span<const NamedJoint> joints) {
    const std::string prefix(shared_prefix(joints)), ending = shared_ending(joints);
    for (const NamedJoint& joint : joints) {
      names_.push_back(parse_name(joint.name.substr(joint.name.starts_with(prefix) ? prefix.size() : 0), ending));
      known_.insert({names_.back().side, names_.back().word});
    }
  }

  std::optional<JointRole> role(std::size_t joint) const {
    const auto& [word, side] = names_[joint];
    const bool is_middle = side == BodySide::middle;
    const PartName* found = is_middle ? find_part(kMiddleNames, word) : find_part(kSideNames, word);
    if (found != nullptr) return JointRole{is_middle ? found->part : part_among(found->part, word, side), side};
    const bool has_hips = has(side, {"hips", "pelvis", "hip"});
    if (is_middle && word == "root" && !has_hips) return JointRole{BodyPart::hips, side};
    return std::nullopt;
  }

 private:
  bool has(BodySide side, std::initializer_list<const char*> words) const {
    return std::ranges::any_of(words, [&](const char* word) { return known_.contains({side, word}); });
  }

  BodyPart part_among(BodyPart usual, const std::string& word, BodySide side) const {
    if (word == "shoulder" && !has(side, {"arm", "upperarm", "shldr"})) return BodyPart::upper_arm;
    if (word == "hip" && has(side, {"upleg", "upperleg", "thigh"})) return BodyPart::hip_joint;
    if (word == "leg" && !has(side, {"upleg", "upperleg", "thigh", "hip"}) &&
        has(side, {"lowerleg", "shin", "calf", "knee"})) {
      return BodyPart::thigh;
    }
    if (word == "hand" && has(side, {"wrist"})) return BodyPart::palm;
    if (word == "foot" && has(side, {"ankle"}) && !has(side, {"toe", "toes", "toebase", "ball"})) return BodyPart::toe;
    return usual;
  }

  std::vector<ParsedName> names_;
  std::set<std::pair<BodySide, std::string>> known_;
};

struct Sides {
  const char *left, *right;
};
constexpr Sides kSides[] = {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}, {"L", "R"}, {"l", "r"}};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

// Whether the letter is a word, or a capital where a word of capitals and small letters begins or ends.
bool is_side(const std::string& name, std::size_t at) {
  const char before = at == 0 ? ' ' : name[at - 1], after = at + 1 < name.size() ? name[at + 1] : ' ';
  if (!is_letter(before) && !is_letter(after)) return true;
  if (!is_upper(name[at])) return false;
  return is_letter(before) ? !is_letter(after) && !is_upper(before) : is_upper(after);
}

// Replaces one `from` such that the name is a known one; empty: none does.
std::string replaced(const std::string& name, const std::string& from, const std::string& to,
                     std::span<const std::string> names) {
  for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from, at + 1)) {
    if (from.size() == 1 && !is_side(name, at)) continue;
    const std::string other = std::string(name).replace(at, from.size(), to);
    if (std::ranges::find(names, other) != names.end()) return other;
  }
  return {};
}

}  // namespace

std::vector<std::string> name_words(std::string_view whole_name) {
  const std::string_view name = without_prefix(whole_name);
  const auto kind = [&](std::size_t i) {  // of a character: 0 none, 1 digit, 2 small letter, 3 capital
    const auto c = static_cast<unsigned char>(name[i]);
    return std::isdigit(c) ? 1 : (std::islower(c) ? 2 : (std::isupper(c) ? 3 : 0));
  };
  std::vector<std::string> words;
  bool inside = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const int now = kind(i), before = i > 0 ? kind(i - 1) : 0;
    if (now == 0) {
      inside = false;
      continue;
    }
    const bool ends_capitals = now == 3 && before == 3 && i + 1 < name.size() && kind(i + 1) == 2;
    if (!inside || ends_capitals || (now != before && !(before == 3 && now == 2))) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
    inside = true;
  }
  return words;
}

BodySide side_of_name(std::string_view name) {
  for (const std::string& word : name_words(name)) {
    if (const auto side = side_of(word)) return *side;
  }
  return BodySide::middle;
}

std::vector<NamedJoint> named_joints(const Skeleton& skeleton) {
  return transformed(skeleton.joints, [&](const Joint& joint) { return NamedJoint{joint.name, joint.parent}; });
}

std::vector<std::optional<JointRole>> joint_roles(std::span<const NamedJoint> joints) {
  constexpr std::size_t kParts = static_cast<std::size_t>(BodyPart::pinky) + 1, kSides = 3;
  const PartNames names(joints);
  std::vector<std::optional<JointRole>> roles;
  std::vector<std::array<std::size_t, kParts * kSides>> above_and_own;  // per joint: how many of a part
  std::set<std::pair<std::size_t, std::size_t>> known;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    above_and_own.push_back({});
    if (joints[j].parent >= 0) above_and_own[j] = above_and_own[static_cast<std::size_t>(joints[j].parent)];
    std::optional<JointRole>& role = roles.emplace_back(names.role(j));
    if (!role) continue;
    const std::size_t which = static_cast<std::size_t>(role->part) * kSides + static_cast<std::size_t>(role->side);
    role->nested = above_and_own[j][which]++;
    if (!known.insert({which, role->nested}).second) role.reset();
  }
  return roles;
}

std::string mirrored_name(const std::string& name, std::span<const std::string> names) {
  for (const auto& [left, right] : kSides) {
    for (const auto& [from, to] : {Sides{left, right}, Sides{right, left}}) {
      if (std::string other = replaced(name, from, to, names); !other.empty()) return other;
    }
  }
  return {};
}

std::vector<int> mirrored_places(std::span<const std::string> names) {
  std::vector<int> places;
  for (const std::string& name : names) {
    const auto other = std::find(names.begin(), names.end(), mirrored_name(name, names));
    places.push_back(other == names.end() ? -1 : static_cast<int>(other - names.begin()));
  }
  return places;
}

}  // namespace bodyopt
