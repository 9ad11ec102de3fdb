#include "proxy_viewer/curation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "dataset/stack_history.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr double kNear = 15;        // degrees
constexpr std::size_t kPairs = 12;  // that the panel lists
constexpr double kDense = 12;       // neighbours of a pose that is well covered

}  // namespace

void Curation::look(const Scene& scene, Controls& controls) {
  const NamedShapes* truth = scene.empty() ? nullptr : scene.lead().truth();
  const std::shared_ptr<const ShapeStack> stack = truth && truth->is_whole() ? truth->stack() : nullptr;
  if (stack != stack_) {
    *this = {};
    const Curating before = std::exchange(controls.curating, {});
    stack_ = stack;
    if (!stack) return;
    numbers_ = truth->numbers();
    parts_ = skin_parts(stack->database());
    double widest = -1;
    for (const SkinPart& part : parts_) {
      controls.curating.regions.push_back(part.region.name);
      const double spread = pose_map(stack->database(), part, 0).spread;
      if (spread <= widest) continue;
      widest = spread;
      controls.curating.region = part.region.name;
    }
    for (const Modifier& modifier : stack->database().dataset.modifiers) {
      controls.curating.modifiers.push_back(modifier.name);
    }
    // An edit made this stack of the one before: what was chosen stays.
    controls.curating.colour = before.colour;
    controls.curating.raw = before.raw;
    if (std::ranges::find(controls.curating.regions, before.region) != controls.curating.regions.end()) {
      controls.curating.region = before.region;
    }
  }
  if (stack_ && controls.curating.region != region_) choose_region(controls.curating.region);
}

void Curation::choose_region(const std::string& name) {
  const auto part =
      std::find_if(parts_.begin(), parts_.end(), [&](const SkinPart& p) { return p.region.name == name; });
  if (part == parts_.end()) return;
  region_ = name;
  map_ = pose_map(stack_->database(), *part, kNear);
}

std::string Curation::frame_text(std::size_t number) const {
  const DatabaseFrame& frame = stack_->database().frames[number];
  return stack_->database().takes[static_cast<std::size_t>(frame.take)] + " " + std::to_string(frame.frame);
}

// Of the frames of the clip; not a number: not known.
std::vector<double> Curation::values(const Controls& controls, const Snapshot& snapshot) const {
  std::vector<double> values(numbers_.size(), NAN);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t n = numbers_[k];
    switch (controls.curating.colour) {
      case MapColour::coverage:
        values[k] = kDense - std::min(kDense, double(map_.neighbours[n]));
        break;
      case MapColour::contradiction:
        if (report_) values[k] = report_->frame_mm[n];
        break;
      case MapColour::error:
        if (k < snapshot.errors.size()) values[k] = static_cast<double>(snapshot.errors[k].rms);
        break;
    }
  }
  return values;
}

std::vector<PoseDot> Curation::dots(const Controls& controls, const Snapshot& snapshot) const {
  const double extent = std::max(1e-9, map_.places.cwiseAbs().maxCoeff());
  const std::vector<double> heat = values(controls, snapshot);
  double hottest = 1e-9;
  for (const double value : heat) hottest = std::isfinite(value) ? std::max(hottest, value) : hottest;
  std::vector<PoseDot> dots;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const Eigen::RowVector2d place = map_.places.row(static_cast<Index>(numbers_[k])) / extent;
    dots.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(heat[k] / hottest),
                    frame_text(numbers_[k])});
  }
  return dots;
}

void Curation::describe(const Controls& controls, Snapshot& snapshot) const {
  snapshot.curation.reset();
  if (!stack_ || numbers_.empty()) return;
  CurationRow row;
  row.region = region_;
  row.dots = dots(controls, snapshot);
  const std::vector<double> heat = values(controls, snapshot);
  const auto hottest = std::max_element(heat.begin(), heat.end(),
                                        [](double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; });
  const bool known = std::isfinite(*hottest);
  char text[96];
  switch (controls.curating.colour) {
    case MapColour::coverage:
      std::snprintf(text, sizeof(text), "hot: fewer than %.0f poses within %.0f degrees", kDense, kNear);
      break;
    case MapColour::contradiction:
      std::snprintf(text, sizeof(text), known ? "hottest: %.2f mm from like poses" : "not compared yet", *hottest);
      break;
    case MapColour::error:
      std::snprintf(text, sizeof(text), known ? "hottest: %.2f mm RMS" : "not measured yet", *hottest);
      break;
  }
  row.legend = text;
  for (const Modifier& modifier : stack_->database().dataset.modifiers) {
    row.modifiers.push_back({modifier.name, modifier.type, modifier.enabled, modifier.strength});
  }
  for (std::size_t k = 0; report_ && k < report_->pairs.size(); ++k) {
    const DisagreeingPair& pair = report_->pairs[k];
    std::snprintf(text, sizeof(text), "%.2f mm  ", pair.apart_mm);
    row.pairs.push_back(text + frame_text(pair.first) + " \xe2\x80\x93 " + frame_text(pair.second) + "  " +
                        pair.region);
  }
  snapshot.curation = std::move(row);
}

void Curation::find_contradictions(Controls& controls) {
  report_ = report_consistency(*stack_, kNear, kPairs);
  controls.curating.pairs.clear();
  const auto frame_of = [&](std::size_t n) {
    const auto place = std::lower_bound(numbers_.begin(), numbers_.end(), n);
    return controls.playback.first() + static_cast<int>(place - numbers_.begin());
  };
  for (const DisagreeingPair& pair : report_->pairs) {
    controls.curating.pairs.push_back({frame_of(pair.first), frame_of(pair.second), pair.region});
  }
  controls.curating.colour = MapColour::contradiction;
}

void Curation::edit(const ModifierEdit& edit) const {
  if (edit.enabled) enable_modifier(path(), edit.name, *edit.enabled);
  if (edit.strength) change_modifier(path(), edit.name, {.strength = edit.strength});
}

void Curation::step(bool back) const {
  if (back) {
    undo_modifiers(path());
  } else {
    redo_modifiers(path());
  }
}

}  // namespace bodyopt
