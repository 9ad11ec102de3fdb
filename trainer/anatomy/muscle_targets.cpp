#include "trainer/anatomy/muscle_targets.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "trainer/anatomy/human_tables.h"

namespace bodyopt {
namespace {

constexpr std::size_t kPrefixLetters = 6;

bool is_letter_or_digit(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

// Runs of letters and digits; where capitals follow small letters another begins.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    const bool is_new = std::isupper(static_cast<unsigned char>(c)) && std::islower(static_cast<unsigned char>(before));
    if (is_letter_or_digit(c) && (is_new || !is_letter_or_digit(before))) words.emplace_back();
    if (is_letter_or_digit(c)) words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    before = c;
  }
  return words;
}

WholeMuscle read_whole_muscle(const JsonObject& json) {
  json.allow({"name", "names", "cm3", "belly", "limb", "source", "checked", "is_sheet", "slips_share_a_region"});
  WholeMuscle muscle;
  muscle.name = json.name("name");
  muscle.names.push_back(matching_name(muscle.name));
  if (json.has("names")) {
    for (const std::string& name : json.names("names")) muscle.names.push_back(matching_name(name));
  }
  muscle.volume = 1e-6 * json.number("cm3", 0.1, 1e4);
  const Json& belly = json.array("belly");
  if (belly.size() != 2 || !(belly[0] < belly[1])) json.refuse("'belly' is not two shares of the path that ascend");
  muscle.belly_from = belly[0].get<double>();
  muscle.belly_to = belly[1].get<double>();
  muscle.limb = json.name("limb");
  muscle.is_sheet = json.has("is_sheet") && json.boolean("is_sheet");
  muscle.slips_share_a_region = json.has("slips_share_a_region") && json.boolean("slips_share_a_region");
  return muscle;
}

}  // namespace

const std::vector<WholeMuscle>& whole_muscles() {
  static const std::vector<WholeMuscle> muscles = [] {
    const std::filesystem::path path = "rigs/human/muscle_volumes.json";
    const Json json = parse_json(kMuscleVolumes, path, "bodyopt-muscle-volumes-1");
    std::vector<WholeMuscle> read;
    for (const JsonObject& row : JsonObject(json, path, "the file").objects("muscles")) {
      read.push_back(read_whole_muscle(row));
    }
    return read;
  }();
  return muscles;
}

std::string matching_name(const std::string& name) {
  std::string joined;
  for (const std::string& word : words_of(name)) {
    if (word != "l" && word != "r" && word != "left" && word != "right") joined += word;
  }
  return joined;
}

std::size_t match_length(const std::string& muscle, const std::string& table_name) {
  if (table_name.empty() || !muscle.starts_with(table_name)) return 0;
  const bool is_whole = std::all_of(muscle.begin() + static_cast<std::ptrdiff_t>(table_name.size()), muscle.end(),
                                    [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
  return is_whole || table_name.size() >= kPrefixLetters ? table_name.size() : 0;
}

const WholeMuscle* find_whole_muscle(const std::string& name) {
  return longest_match(whole_muscles(), matching_name(name));
}

}  // namespace bodyopt
