#include "trainer/anatomy/muscle_targets.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>

#include "base/json_file.h"
#include "trainer/anatomy/division.h"
#include "trainer/anatomy/human_tables.h"
#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt::trainer {
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

using Eigen::Index;
using Eigen::Vector3d;

struct FilledLimb {
  const char* name;
  double filled;  // of its lean tissue by muscles: what else there is are vessels, nerves, fascia, in the calf
                  // tendons, in the trunk the muscles between the ribs and the diaphragm
};
constexpr std::array<FilledLimb, 5> kLimbs{
    {{"leg", 0.867}, {"calf", 0.83}, {"arm", 0.98}, {"forearm", 0.985}, {"trunk", 0.74}}};
constexpr double kLeastFactor = 0.2;
constexpr double kMostFactor = 1.6;  // more is a limb whose other muscles are missing: what they leave is other lean
constexpr int kPasses = 10;

// The limb that a place's lean tissue belongs to; kLimbs.size(): none. The hips are the leg's up to the iliac crest.
std::size_t limb_at(BodyRegion region, double height, double crest) {
  constexpr std::size_t kLeg = 0, kTrunk = 4, kNone = kLimbs.size();
  // Rows are in the order of BodyRegion.
  constexpr std::array<std::size_t, kBodyRegions> kOfRegion{kTrunk, kTrunk, kTrunk, kNone, kLeg,  1,
                                                            kNone,  2,      3,      kNone, kNone, kNone};
  return region == BodyRegion::hip && height < crest ? kLeg : kOfRegion[static_cast<std::size_t>(region)];
}

using Shares = std::array<double, kLimbs.size() + 1>;  // one by one of kLimbs, and of none

// The share of a muscle's belly in each limb.
Shares belly_shares(const LeanSamples& lean, const HalfMuscle& muscle, double crest) {
  Shares shares{};
  double sum = 0;
  for (Index k = 0; k < muscle.path.rows(); ++k) {
    const double section = belly_section(muscle, static_cast<double>(k) / static_cast<double>(muscle.path.rows() - 1));
    const Vector3d place = muscle.path.row(k);
    const int sample = lean.grid.sample_at(place);
    if (sample < 0) continue;
    shares[limb_at(lean.tissue.region[static_cast<std::size_t>(sample)], place.y(), crest)] += section;
    sum += section;
  }
  for (double& share : shares) share /= std::max(sum, 1e-12);
  return shares;
}

Shares lean_volumes(const LeanSamples& lean, double crest) {
  Shares volumes{};
  for (std::size_t i = 0; i < lean.size(); ++i) {
    volumes[limb_at(lean.region(i), lean.points(static_cast<Index>(i), 1), crest)] += lean.grid.volume();
  }
  return volumes;
}

// M: the published volume of each, without a factor.
std::vector<double> published_volumes(const std::vector<HalfMuscle>& muscles) {
  std::map<const WholeMuscle*, double> by_radius;
  for (const HalfMuscle& muscle : muscles) by_radius[muscle.whole] += muscle.volume_by_radius;
  std::vector<double> volumes;
  for (const HalfMuscle& muscle : muscles) {
    const double own = muscle.volume_by_radius;
    volumes.push_back(muscle.whole ? muscle.whole->volume * own / by_radius[muscle.whole] : own);
  }
  return volumes;
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

LimbTargets limb_targets(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles) {
  const auto crest = lean.tissue.landmarks.find("iliac_crest");
  const double height = crest == lean.tissue.landmarks.end() ? 1e9 : crest->second.y();
  const Shares room = lean_volumes(lean, height);
  LimbTargets targets;
  targets.volume = published_volumes(muscles);
  std::vector<std::size_t> limb;
  std::vector<Shares> shares;
  for (const HalfMuscle& muscle : muscles) {
    const auto of_limb = std::ranges::find_if(
        kLimbs, [&](const FilledLimb& one) { return muscle.whole && muscle.whole->limb == one.name; });
    limb.push_back(static_cast<std::size_t>(of_limb - kLimbs.begin()));
    shares.push_back(belly_shares(lean, muscle, height));
  }
  Shares factors{};
  factors.fill(1);
  // Muscles reach into limbs of others: a few passes settle what they take there.
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t l = 0; l < kLimbs.size(); ++l) {
      double own = 0, others = 0;
      for (std::size_t m = 0; m < muscles.size(); ++m) {
        const double volume = targets.volume[m] * shares[m][l];
        (limb[m] == l ? own : others) += limb[m] == l ? volume : factors[limb[m]] * volume;
      }
      if (own > 0) factors[l] = std::clamp((kLimbs[l].filled * room[l] - others) / own, kLeastFactor, kMostFactor);
    }
  }
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    targets.volume[m] *= factors[limb[m]];
    if (limb[m] < kLimbs.size()) targets.factors[kLimbs[limb[m]].name] = factors[limb[m]];
  }
  return targets;
}

}  // namespace bodyopt::trainer
