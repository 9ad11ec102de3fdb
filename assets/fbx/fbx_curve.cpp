#include "assets/fbx/fbx_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace bodyopt {
namespace {

// Bits of KeyAttrFlags describe a key and the way to the next.
enum FbxKeyFlag : std::int64_t {
  kConstant = 0x2,
  kCubic = 0x8,
  kConstantNext = 0x100,  // of constants: the next key's value
  kTensionContinuityBias = 0x200,
  kUserTangents = 0x400,
  kClamp = 0x1000,
  kTimeIndependent = 0x2000,
  kClampProgressively = 0x4000,
  kWeightedOut = 0x1000000,
  kWeightedIn = 0x2000000
};

// The parameter at which a Bezier curve from 0 to 1 reaches `x`; its inner points are at `a` and 1 - b.
double bezier_place(double a, double b, double x) {
  constexpr double kThird = 1.0 / 3, kRounded = 5e-5;  // files have 0.3333
  if (std::abs(a - kThird) < kRounded && std::abs(b - kThird) < kRounded) return x;
  double low = 0, high = 1;
  for (int k = 0; k < 32; ++k) {
    const double u = (low + high) / 2, v = 1 - u;
    (3 * u * v * v * a + 3 * u * u * v * (1 - b) + u * u * u < x ? low : high) = u;
  }
  return low;
}

const FbxNode& required(const FbxScene& scene, const FbxObject& object, const char* name) {
  const FbxNode* found = object.node->find(name);
  if (found == nullptr) scene.fail("an animation curve has no ", name, "; the FBX file is damaged");
  return *found;
}

}  // namespace

FbxCurve::FbxCurve(const FbxScene& scene, const FbxObject& curve) {
  for (const std::int64_t tick : required(scene, curve, "KeyTime").integers()) {
    times_.push_back(static_cast<double>(tick) / scene.ticks());
  }
  values_ = required(scene, curve, "KeyValueFloat").numbers();
  if (times_.empty() || values_.size() != times_.size()) {
    scene.fail("an animation curve has ", times_.size(), " times and ", values_.size(),
               " values; the FBX file is damaged");
  }
  if (!std::ranges::is_sorted(times_)) scene.fail("the times of an animation curve decrease; the FBX file is damaged");
  if (!std::ranges::all_of(values_, [](double value) { return std::isfinite(value); })) {
    scene.fail("a value of an animation curve is not a finite number");
  }
  for (const char* name : {"Pre-Extrapolation", "Post-Extrapolation"}) {
    const FbxNode* type = curve.node->child(name).find("Type");
    if (type == nullptr) continue;
    const std::string letter = type->text(0);  // of text; binary has its number
    is_held_ = is_held_ && (letter.empty() ? type->integer(0, 'C') : letter.front()) == 'C';
  }
  set_spans(scene, curve);
}

void FbxCurve::set_spans(const FbxScene& scene, const FbxObject& curve) {
  const auto flags = required(scene, curve, "KeyAttrFlags").integers();
  const auto data = required(scene, curve, "KeyAttrDataFloat").numbers();
  const auto repeats = required(scene, curve, "KeyAttrRefCount").integers();
  if (flags.empty() || flags.size() != repeats.size() || data.size() != 4 * flags.size()) {
    scene.fail("the attributes of an animation curve's keys do not fit together; the FBX file is damaged");
  }
  spans_.resize(times_.size());
  double before = 0;  // slope into a key, as the key before it says
  std::int64_t used = 0;
  for (std::size_t k = 0, entry = 0; k < times_.size(); ++k, ++used) {
    if (used >= repeats[entry] && entry + 1 < flags.size()) {
      ++entry;
      used = 0;
    }
    const std::int64_t flag = flags[entry];
    const double* numbers = &data[4 * entry];
    Span& span = spans_[k];
    // Two whole numbers in the bits of a real, which text gives as one.
    const auto packed = scene.is_text() && numbers[2] >= 1 && numbers[2] < 0x1p32
                            ? static_cast<std::uint32_t>(numbers[2])
                            : std::bit_cast<std::uint32_t>(static_cast<float>(numbers[2]));
    if ((flag & kConstant) != 0) {
      span.kind = (flag & kConstantNext) != 0 ? Kind::constant_next : Kind::constant;
    } else if ((flag & kCubic) != 0) {
      span.kind = Kind::cubic;
      if ((flag & kWeightedOut) != 0) span.weight_out = std::min(1.0, (packed & 0xffff) * 1e-4);
      if ((flag & kWeightedIn) != 0) span.weight_in = std::min(1.0, (packed >> 16) * 1e-4);
      span.slope_in = (flag & kTensionContinuityBias) != 0 ? 0 : numbers[1];
      set_slopes(k, flag, numbers, before);
    }
    before = span.slope_in;
  }
}

// Sets the slopes after the key and before it.
void FbxCurve::set_slopes(std::size_t key, std::int64_t flags, const double* data, double before) {
  double out = data[0], in = before;
  if ((flags & kTensionContinuityBias) != 0) {
    const bool has_left = key > 0 && times_[key] > times_[key - 1];
    const bool has_right = key + 1 < times_.size() && times_[key + 1] > times_[key];
    const double left = has_left ? (values_[key] - values_[key - 1]) / (times_[key] - times_[key - 1]) : 0;
    const double right = has_right ? (values_[key + 1] - values_[key]) / (times_[key + 1] - times_[key]) : 0;
    const double all = (has_left && has_right ? 0.5 : 1) * (1 - data[0]), c = data[1], b = data[2];
    in = all * ((1 + b) * (1 - c) * left + (1 - b) * (1 + c) * right);
    out = all * ((1 + b) * (1 + c) * left + (1 - b) * (1 - c) * right);
  } else if ((flags & kUserTangents) == 0) {
    out = slope_between(key, flags, data[0]);
    in = slope_between(key, flags, -before);
  }
  spans_[key].slope_out = out;
  if (key > 0) spans_[key - 1].slope_in = in;
}

// The slope that a program chooses by itself, drawn to the next key or the one before it by `bias` of 100.
double FbxCurve::slope_between(std::size_t key, std::int64_t flags, double bias) const {
  const bool has_left = key > 0 && times_[key] > times_[key - 1];
  const bool has_right = key + 1 < times_.size() && times_[key + 1] > times_[key];
  const double before = has_left ? times_[key] - times_[key - 1] : 0;
  const double after = has_right ? times_[key + 1] - times_[key] : 0;
  const double rise = has_left ? values_[key] - values_[key - 1] : 0;
  const double next_rise = has_right ? values_[key + 1] - values_[key] : 0;
  if (!has_left && !has_right) return 0;
  if (!has_left || !has_right) {
    if ((flags & kClampProgressively) != 0) return 0;
    return (rise + next_rise) / (before + after);
  }
  if ((flags & kClamp) != 0 && std::min(std::abs(rise), std::abs(next_rise)) == 0) return 0;
  double slope = (rise + next_rise) / (before + after);
  if ((flags & kTimeIndependent) == 0) {
    const double part = before / (before + after);
    slope = 0.5 * slope + 0.5 * ((1 - part) * rise / before + part * next_rise / after);
    const double drawn = std::abs(bias) / 100;
    slope = (1 - drawn) * slope + drawn * (bias > 0 ? next_rise / after : rise / before);
  }
  if ((flags & kClampProgressively) == 0) return slope;
  // The slope must not lead beyond either neighbour.
  const double sign = slope < 0 ? -1 : 1, third = 3 * sign;
  const double most = std::max(0.0, std::min(third * rise / before, third * next_rise / after));
  return sign * std::min(std::abs(slope), most);
}

double FbxCurve::at(double seconds) const {
  if (!(seconds > times_.front())) return values_.front();
  if (seconds >= times_.back()) return values_.back();
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(times_, seconds) - times_.begin());
  const Span& span = spans_[after - 1];
  const double from = values_[after - 1], to = values_[after], length = times_[after] - times_[after - 1];
  const double x = (seconds - times_[after - 1]) / length;
  switch (span.kind) {
    case Kind::constant:
      return from;
    case Kind::constant_next:
      return x > 0 ? to : from;
    case Kind::linear:
      return from + x * (to - from);
    case Kind::cubic:
      break;
  }
  const double u = bezier_place(span.weight_out, span.weight_in, x), v = 1 - u;
  const double leaving = from + span.slope_out * span.weight_out * length;
  const double arriving = to - span.slope_in * span.weight_in * length;
  return v * v * v * from + 3 * u * v * v * leaving + 3 * u * u * v * arriving + u * u * u * to;
}

}  // namespace bodyopt
