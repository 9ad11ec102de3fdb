// One number of an FBX file over time.
#pragma once

#include <vector>

#include "assets/fbx/fbx_scene.h"

namespace bodyopt {

class FbxCurve {
 public:
  // Throws Error(file): keys that do not fit, times that decrease, numbers that are not finite.
  FbxCurve(const FbxScene& scene, const FbxObject& curve);

  const std::vector<double>& times() const { return times_; }  // seconds; at least one
  // The value is held before the first and after the last key.
  double at(double seconds) const;
  // Does the file say so, too? Otherwise the curve repeats or goes on.
  bool is_held() const { return is_held_; }

 private:
  enum class Kind { constant, constant_next, linear, cubic };
  // The curve from a key to the next. Weights are how far its tangents reach, of the time between the two.
  struct Span {
    Kind kind = Kind::linear;
    double slope_out = 0, slope_in = 0, weight_out = 1.0 / 3, weight_in = 1.0 / 3;
  };
  void set_spans(const FbxScene& scene, const FbxObject& curve);
  void set_slopes(std::size_t key, std::int64_t flags, const double* data, double before);
  double slope_between(std::size_t key, std::int64_t flags, double bias) const;

  std::vector<double> times_, values_;
  std::vector<Span> spans_;
  bool is_held_ = true;
};

}  // namespace bodyopt
