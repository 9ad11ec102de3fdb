// Breathing: a breath is a rise, a fall and a pause. The fall is quick at first and slow in the end, as that of a
// relaxing lung. The phase is summed over the frames, so that rates may change while it goes on. Component 0 is the
// chest, 1 the belly, both in litres of this body. Components of a learnt breath are its shapes.
//   d phase / dt = rate / 60 (1 - hold) / (1 + irregularity * r_k / 2),   k: number of the breath, r_k in -1..1
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "runtime/modifiers/breath_shapes.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

enum Control { kRate, kDepth, kChest, kAsymmetry, kPause, kIrregularity, kSeed, kPhase, kHold, kExertion };

// The controls of one frame, after exertion.
struct BreathControls {
  double rate, depth, chest, asymmetry, pause, irregularity;

  BreathControls(const ModifierFrames& frames, std::size_t f) {
    const auto value = [&](Control control) { return static_cast<double>(frames.controls[control][f]); };
    constexpr double kHardRate = 45, kHardDepth = 2.6, kHardChest = 0.7;  // an adult at full effort
    const double effort = value(kExertion);
    rate = std::lerp(value(kRate), std::max(value(kRate), kHardRate), effort);
    depth = std::lerp(value(kDepth), std::max(value(kDepth), kHardDepth), effort);
    chest = std::lerp(value(kChest), std::max(value(kChest), kHardChest), effort);
    asymmetry = std::lerp(value(kAsymmetry), 1.0, effort);
    pause = std::lerp(value(kPause), 0.0, effort);
    irregularity = value(kIrregularity);
  }
};

// A number in -1..1, the same for the same breath on every machine (the finaliser of SplitMix64, Steele et al. 2014).
double noise(std::uint64_t seed, std::int64_t breath, std::uint64_t which) {
  std::uint64_t x = seed * 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(breath) * 4 + which;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-52 - 1;
}

struct Breath {
  double filled;  // share, 0..1; its slope is continuous
  bool comes_in;
};

// The breath at a phase in 0..1.
Breath breath_at(double phase, const BreathControls& c) {
  const double moving = 1 - c.pause, in = moving / (1 + c.asymmetry), out = moving - in;
  if (phase < in) return {0.5 - 0.5 * std::cos(std::numbers::pi * phase / in), true};
  if (phase >= moving) return {0, false};
  const double left = 1 - (phase - in) / out;  // 1 to 0
  return {0.5 + 0.5 * std::cos(std::numbers::pi * (1 - left * std::sqrt(left))), false};
}

// Sets the weights of one frame, of a breath of this depth in the modifier's own measure.
void set_weights(const Breath& breath, double depth, double chest, std::span<float> weights) {
  if (weights.size() == 2) {
    const double volume = depth * breath.filled;
    weights[0] = static_cast<float>(chest * volume);
    weights[1] = static_cast<float>((1 - chest) * volume);
    return;
  }
  const std::array<double, kBreathShapes> shares = breath_shapes(breath.filled, breath.comes_in);
  for (std::size_t k = 0; k < kBreathShapes; ++k) weights[k] = static_cast<float>(depth * shares[k]);
}

}  // namespace

void drive_breathing(const ModifierFrames& frames, std::span<float> weights) {
  const std::size_t components = frames.modifier.component_count;
  if (components != 2 && components != kBreathShapes) throw std::out_of_range("components of breathing");
  const double litres = static_cast<double>(frames.modifier.numbers.at(0));  // of this body for one of a man's
  if (frames.count() == 0) return;
  double phase = frames.phase.value_or(static_cast<double>(frames.controls[kPhase][0]));
  for (std::size_t f = 0; f < frames.count(); ++f) {
    const BreathControls c(frames, f);
    const auto seed = static_cast<std::uint64_t>(frames.controls[kSeed][f]);
    const auto breath = static_cast<std::int64_t>(std::floor(phase));
    const double depth = c.depth * (1 + 0.5 * c.irregularity * noise(seed, breath, 0));
    set_weights(breath_at(phase - std::floor(phase), c), litres * depth, c.chest,
                weights.subspan(components * f, components));
    const double length = 1 + 0.5 * c.irregularity * noise(seed, breath, 1);
    const double hold = static_cast<double>(frames.controls[kHold][f]);
    phase += c.rate / 60 * (1 - hold) / (length * frames.frames_per_second);
  }
  frames.phase = phase;
}

}  // namespace bodyopt
