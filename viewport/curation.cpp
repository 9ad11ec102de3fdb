#include "viewport/curation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/local_models.h"

namespace bodyopt::viewport {
namespace {

using Eigen::Index;
using namespace std::chrono_literals;

constexpr auto kAtOnce = 250ms;     // with others that edit: a window answers
constexpr std::size_t kPairs = 12;  // that the panel lists
constexpr double kDense = 12;       // neighbours of a pose that is well covered

}  // namespace

void Curation::look(const Scene& scene, Controls& controls) {
  const trainer::NamedShapes* truth = scene.empty() ? nullptr : scene.lead().truth();
  const std::shared_ptr<const trainer::ShapeStack> stack = truth && truth->is_whole() ? truth->stack() : nullptr;
  if (stack && stack_ && has_its_frames(*stack, truth->numbers())) {
    take_over(stack, controls);
  } else if (stack != stack_) {
    begin(stack, truth ? truth->numbers() : std::vector<std::size_t>(), controls);
    if (!scene.empty()) first_frame_ = scene.lead().clip().first_frame;
  }
  if (stack_ && controls.curating.region != region_) choose_region(controls.curating.region);
}

// Whether a stack is of the frames that are known here, in their poses.
bool Curation::has_its_frames(const trainer::ShapeStack& stack, const std::vector<std::size_t>& numbers) const {
  const std::vector<trainer::DatabaseFrame>&own = stack_->database().frames, &other = stack.database().frames;
  const auto in_one_pose = [](const trainer::DatabaseFrame& a, const trainer::DatabaseFrame& b) {
    return same({&a.pose, 1}, {&b.pose, 1});
  };
  return numbers == numbers_ && (&own == &other || std::ranges::equal(own, other, in_one_pose));
}

// An edit made this stack of the one before: what was chosen stays, and what was learned of the poses.
void Curation::take_over(const std::shared_ptr<const trainer::ShapeStack>& stack, Controls& controls) {
  if (stack == stack_) return;
  stack_ = stack;
  report_.reset();
  controls.curating.compared = false;
  controls.curating.pairs.clear();
  controls.curating.pair = -1;
  name_modifiers(controls);
}

void Curation::name_modifiers(Controls& controls) const {
  controls.curating.modifiers.clear();
  for (const Modifier& modifier : stack_->database().dataset.modifiers) {
    controls.curating.modifiers.push_back(modifier.name);
  }
}

// Looks at the region whose poses differ most, unless another was looked at in the stack before.
void Curation::begin(const std::shared_ptr<const trainer::ShapeStack>& stack, std::vector<std::size_t> numbers,
                     Controls& controls) {
  *this = {};
  const Curating before = std::exchange(controls.curating, {});
  stack_ = stack;
  if (!stack) return;
  numbers_ = std::move(numbers);
  for (const std::size_t number : numbers_) controls.curating.frames.push_back(stack_->database().name_of(number));
  parts_ = trainer::skin_parts(stack->database());
  double widest = -1;
  for (const trainer::SkinPart& part : parts_) {
    controls.curating.regions.push_back(part.region.name);
    const double spread = trainer::pose_spread(stack->database(), part);
    if (spread <= widest) continue;
    widest = spread;
    controls.curating.region = part.region.name;
  }
  name_modifiers(controls);
  controls.curating.colour = before.colour;
  controls.curating.raw = before.raw;
  if (std::ranges::find(controls.curating.regions, before.region) != controls.curating.regions.end()) {
    controls.curating.region = before.region;
  }
}

void Curation::choose_region(const std::string& name) {
  const auto part =
      std::ranges::find(parts_, name, [](const trainer::SkinPart& p) -> const std::string& { return p.region.name; });
  if (part == parts_.end()) return;
  region_ = name;
  map_ = trainer::pose_map(stack_->database(), *part, trainer::kAlikeDegrees);
}

std::size_t Curation::number_of(int frame) const {
  const auto last = static_cast<int>(numbers_.size()) - 1;
  return numbers_[static_cast<std::size_t>(std::clamp(frame - first_frame_, 0, last))];
}

// Returns values of the frames of the clip; not a number: not known.
std::vector<double> Curation::values(MapColour colour, const Snapshot& snapshot,
                                     std::span<const double> brushed) const {
  std::vector<double> values(numbers_.size(), NAN);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t n = numbers_[k];
    switch (colour) {
      case MapColour::coverage:
        values[k] = kDense - std::min(kDense, double(map_.neighbours[n]));
        break;
      case MapColour::contradiction:
        if (report_) values[k] = report_->frame_mm[n];
        break;
      case MapColour::error:
        if (k < snapshot.errors.size()) values[k] = static_cast<double>(snapshot.errors[k].rms);
        break;
      case MapColour::sculpt:
        if (n < brushed.size()) values[k] = brushed[n];
        break;
      case MapColour::weight:
        values[k] = stack_->weight(n);
        break;
    }
  }
  return values;
}

std::vector<PoseDot> Curation::dots(const std::vector<double>& heat) const {
  const double extent = std::max(1e-9, map_.places.cwiseAbs().maxCoeff());
  double hottest = 1e-9;
  for (const double value : heat) hottest = std::isfinite(value) ? std::max(hottest, value) : hottest;
  std::vector<PoseDot> dots;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const Eigen::RowVector2d place = map_.places.row(static_cast<Index>(numbers_[k])) / extent;
    dots.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(heat[k] / hottest),
                    stack_->database().name_of(numbers_[k])});
  }
  return dots;
}

void Curation::describe(const Controls& controls, Snapshot& snapshot, std::span<const double> brushed) const {
  snapshot.curation.reset();
  if (!stack_ || numbers_.empty()) return;
  CurationRow row;
  row.region = region_;
  const MapColour colour = brushed.empty() ? controls.curating.colour : MapColour::sculpt;
  const std::vector<double> heat = values(colour, snapshot, brushed);
  row.dots = dots(heat);
  const auto hottest = std::ranges::max_element(heat, {}, [](double h) { return std::isnan(h) ? -INFINITY : h; });
  const bool known = std::isfinite(*hottest);
  switch (colour) {
    case MapColour::coverage:
      row.legend = formatted("hot: fewer than %.0f poses within %.0f degrees", kDense, trainer::kAlikeDegrees);
      break;
    case MapColour::contradiction:
      row.legend = known ? formatted("hottest: %.2f mm from like poses", *hottest) : "not compared yet";
      break;
    case MapColour::error:
      row.legend = known ? formatted("hottest: %.2f mm RMS", *hottest) : "not measured yet";
      break;
    case MapColour::sculpt:
      row.legend = known ? "hottest: takes all of the stroke" : "nothing was brushed yet";
      break;
    case MapColour::weight:
      row.legend = formatted("hottest: counts %g times in training", *hottest);
      break;
  }
  for (const Modifier& modifier : stack_->database().dataset.modifiers) {
    row.modifiers.push_back({modifier.name, modifier.type, modifier.enabled, modifier.strength});
  }
  for (std::size_t k = 0; report_ && k < report_->pairs.size(); ++k) {
    const trainer::DisagreeingPair& pair = report_->pairs[k];
    row.pairs.push_back(formatted("%.2f mm  ", pair.apart_mm) + stack_->database().name_of(pair.first) +
                        " \xe2\x80\x93 " + stack_->database().name_of(pair.second) + "  " + pair.region);
  }
  snapshot.curation = std::move(row);
}

void Curation::require_open() const {
  if (!is_open()) throw Error(ErrorKind::usage, "no dataset is open: begin with bodyopt view DATASET");
}

void Curation::find_contradictions(Controls& controls) {
  require_open();
  report_ = trainer::report_consistency(*stack_, trainer::kAlikeDegrees, kPairs);
  controls.curating.compared = true;
  controls.curating.pairs.clear();
  const auto frame_of = [&](std::size_t n) {
    const auto place = std::lower_bound(numbers_.begin(), numbers_.end(), n);
    return controls.playback.first() + static_cast<int>(place - numbers_.begin());
  };
  for (const trainer::DisagreeingPair& pair : report_->pairs) {
    controls.curating.pairs.push_back({frame_of(pair.first), frame_of(pair.second), pair.region});
  }
  controls.curating.colour = MapColour::contradiction;
}

void Curation::edit(const ModifierEdit& edit) const {
  require_open();
  if (edit.enabled) trainer::enable_modifier(path(), edit.name, *edit.enabled, kAtOnce);
  if (edit.strength) trainer::change_modifier(path(), edit.name, {.strength = edit.strength}, kAtOnce);
}

void Curation::step(bool back) const {
  require_open();
  (back ? undo_modifiers : redo_modifiers)(path(), kAtOnce);
}

}  // namespace bodyopt::viewport
