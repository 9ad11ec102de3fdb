#include "trainer/anatomy/region_growth.h"

#include <functional>
#include <queue>
#include <tuple>

namespace bodyopt {
namespace {

// Pieces of equal labels, numbered, by flooding.
struct Pieces {
  std::vector<int> of_sample;  // L, -1: no label
  std::vector<int> size, muscle;
};

Pieces pieces_of(const LeanSamples& lean, const std::vector<int>& label) {
  Pieces pieces;
  pieces.of_sample.assign(lean.size(), -1);
  std::vector<int> open;
  for (std::size_t first = 0; first < lean.size(); ++first) {
    if (label[first] < 0 || pieces.of_sample[first] >= 0) continue;
    const int piece = static_cast<int>(pieces.size.size());
    pieces.size.push_back(0);
    pieces.muscle.push_back(label[first]);
    pieces.of_sample[first] = piece;
    open.push_back(static_cast<int>(first));
    while (!open.empty()) {
      const auto i = static_cast<std::size_t>(open.back());
      open.pop_back();
      ++pieces.size.back();
      for (const int beside : lean.neighbours[i]) {
        const auto j = static_cast<std::size_t>(beside);
        if (beside < 0 || label[j] != label[first] || pieces.of_sample[j] >= 0) continue;
        pieces.of_sample[j] = piece;
        open.push_back(beside);
      }
    }
  }
  return pieces;
}

}  // namespace

std::vector<int> keep_largest_pieces(const LeanSamples& lean, std::size_t muscles, std::vector<int>& label) {
  const Pieces pieces = pieces_of(lean, label);
  std::vector<int> largest(muscles, -1);
  for (std::size_t p = 0; p < pieces.size.size(); ++p) {
    int& best = largest[static_cast<std::size_t>(pieces.muscle[p])];
    if (best < 0 || pieces.size[p] > pieces.size[static_cast<std::size_t>(best)]) best = static_cast<int>(p);
  }
  std::vector<int> loose;
  for (std::size_t i = 0; i < lean.size(); ++i) {
    if (label[i] < 0 || pieces.of_sample[i] == largest[static_cast<std::size_t>(label[i])]) continue;
    loose.push_back(static_cast<int>(i));
    label[i] = -1;
  }
  return loose;
}

void grow_into(const LeanSamples& lean, const MuscleCandidates& candidates, const std::vector<double>& radii,
               double farthest, const std::vector<int>& loose, std::vector<int>& label) {
  using Step = std::tuple<double, int, int>;  // distance, sample, muscle
  std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
  std::vector<bool> is_loose(lean.size(), false);
  for (const int i : loose) is_loose[static_cast<std::size_t>(i)] = true;
  const auto offer = [&](int sample, int muscle) {
    const auto i = static_cast<std::size_t>(sample);
    const std::size_t entry = candidates.find(i, muscle);
    if (entry == candidates.begin(i + 1)) return;
    const double distance = candidates.distance(entry, radii[static_cast<std::size_t>(muscle)]);
    if (distance < farthest) steps.emplace(distance, sample, muscle);
  };
  for (const int i : loose) {
    for (const int beside : lean.neighbours[static_cast<std::size_t>(i)]) {
      if (beside >= 0 && label[static_cast<std::size_t>(beside)] >= 0)
        offer(i, label[static_cast<std::size_t>(beside)]);
    }
  }
  while (!steps.empty()) {
    const auto [distance, sample, muscle] = steps.top();
    steps.pop();
    const auto i = static_cast<std::size_t>(sample);
    if (label[i] >= 0) continue;
    label[i] = muscle;
    for (const int beside : lean.neighbours[i]) {
      if (beside < 0 || !is_loose[static_cast<std::size_t>(beside)] || label[static_cast<std::size_t>(beside)] >= 0)
        continue;
      offer(beside, muscle);
    }
  }
}

}  // namespace bodyopt
