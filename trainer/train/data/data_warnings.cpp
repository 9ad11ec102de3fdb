#include "trainer/train/data/data_warnings.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "assets/wording.h"

namespace bodyopt {
namespace {

// Sentences of one kind; the rest is counted.
constexpr std::size_t kShown = 5;

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f mm", 1e3 * metres);
  return text;
}

template <typename Found>
void worst_first(std::vector<Found>& found) {
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.distance > b.distance; });
}

// The first vertex of the file that is this welded one.
std::size_t file_vertex(const Character& character, std::uint32_t welded) {
  const std::vector<std::uint32_t>& output = character.output_vertex;
  return static_cast<std::size_t>(std::find(output.begin(), output.end(), welded) - output.begin());
}

}  // namespace

std::vector<std::string> contradiction_warnings(const SampleSet& set, std::vector<Contradiction> contradictions) {
  worst_first(contradictions);
  std::vector<std::string> warnings;
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [frames, distance, region] : contradictions) {
    if (!pairs.emplace(frames.first, frames.second).second || pairs.size() > kShown) continue;
    const Sample &first = set.train[frames.first], &second = set.train[frames.second];
    warnings.push_back(frame_name(set, first) + " and " + frame_name(set, second) +
                       " have the same pose and controls, but their shapes are " + millimetres(distance) +
                       " RMS apart in region '" + region +
                       "': one of them may have been made with another muscles file or other materials, or as a draft");
  }
  if (pairs.size() > kShown) {
    warnings.push_back(count_of(pairs.size() - kShown, "more pair", "more pairs") +
                       " of frames of the same pose and controls have shapes that contradict each other");
  }
  return warnings;
}

std::vector<std::string> stray_warnings(const SampleSet& set, const std::vector<std::uint32_t>& order,
                                        std::vector<StrayVertex> strays) {
  worst_first(strays);
  std::vector<std::string> warnings;
  for (const StrayVertex& stray : strays) {
    if (warnings.size() == kShown) break;
    warnings.push_back(frame_name(set, set.train[stray.frame]) + ": vertex " +
                       std::to_string(file_vertex(set.character, order[stray.vertex])) + " is " +
                       millimetres(stray.distance) +
                       " from where its neighbours take it: it was trained as if it moved with them");
  }
  if (strays.size() > kShown) {
    warnings.push_back(count_of(strays.size() - kShown, "more vertex", "more vertices") +
                       " of single frames flew away from their neighbours");
  }
  return warnings;
}

std::vector<std::string> constant_control_warnings(const SampleSet& set) {
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < set.controls.size(); ++k) {
    const float value = set.train.front().pose.controls[k];
    const auto same = [&](const Sample& sample) { return sample.pose.controls[k] == value; };
    if (!std::all_of(set.train.begin(), set.train.end(), same)) continue;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", double{value});
    warnings.push_back("control '" + set.controls[k] + "' is " + text +
                       " in every training frame: what it does cannot be learned");
  }
  return warnings;
}

std::vector<std::string> few_frames_warnings(const SampleSet& set, std::size_t features) {
  if (set.train.size() >= features) return {};
  return {std::to_string(set.train.size()) + " training frames for " + std::to_string(features) +
          " features that vary: trust the basis near these frames only, or simulate more"};
}

}  // namespace bodyopt
