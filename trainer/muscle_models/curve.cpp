#include "trainer/muscle_models/curve.h"

#include <algorithm>
#include <cstddef>

namespace bodyopt::muscle_models {
namespace {

// A sixth of the spline's second derivative at each knot.
std::vector<double> second_derivatives(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  if (n < 3) return std::vector<double>(n, 0.0);
  std::vector<double> step(n - 1), diagonal(n), right(n, 0.0);
  std::vector<double> slope(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    step[i] = x[i + 1] - x[i];
    slope[i] = (y[i + 1] - y[i]) / step[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    diagonal[i] = 2 * (x[i + 1] - x[i - 1]);
    right[i] = slope[i] - slope[i - 1];
  }
  // The ends: minus the step times a sixth of the third derivative of the cubic through four points.
  diagonal[0] = -step[0];
  diagonal[n - 1] = -step[n - 2];
  if (n > 3) {
    const auto third = [&](std::size_t k) {  // divided difference over x[k] .. x[k + 3]
      return (right[k + 2] / (x[k + 3] - x[k + 1]) - right[k + 1] / (x[k + 2] - x[k])) / (x[k + 3] - x[k]);
    };
    const double first = third(0), last = third(n - 4);
    right[0] = step[0] * step[0] * first;
    right[n - 1] = -step[n - 2] * step[n - 2] * last;
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = step[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * step[i - 1];
    right[i] -= factor * right[i - 1];
  }
  std::vector<double> sixth(n);
  sixth[n - 1] = right[n - 1] / diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) sixth[i] = (right[i] - step[i] * sixth[i + 1]) / diagonal[i];
  return sixth;
}

}  // namespace

Curve Curve::polynomial(std::vector<double> coefficients) {
  Curve curve;
  curve.polynomial_ = std::move(coefficients);
  return curve;
}

Curve Curve::pieces(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sixth) {
  Curve curve;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double h = x[i + 1] - x[i];
    curve.pieces_.push_back({x[i],
                             {y[i], (y[i + 1] - y[i]) / h - h * (sixth[i + 1] + 2 * sixth[i]), 3 * sixth[i],
                              (sixth[i + 1] - sixth[i]) / h}});
  }
  const Piece& last = curve.pieces_.back();
  const double h = x.back() - last.x;
  curve.pieces_.push_back({x.back(), {y.back(), last.a[1] + h * (2 * last.a[2] + h * 3 * last.a[3]), 0, 0}});
  return curve;
}

Curve Curve::spline(const std::vector<double>& x, const std::vector<double>& y) {
  return pieces(x, y, second_derivatives(x, y));
}

Curve Curve::polyline(const std::vector<double>& x, const std::vector<double>& y) {
  return pieces(x, y, std::vector<double>(x.size(), 0.0));
}

double Curve::operator()(double x) const {
  if (pieces_.empty()) {
    double sum = 0;
    for (std::size_t k = polynomial_.size(); k-- > 0;) sum = sum * x + polynomial_[k];
    return sum;
  }
  const Piece& first = pieces_.front();
  if (x < first.x) return first.a[0] + first.a[1] * (x - first.x);
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), x,
                                      [](double value, const Piece& piece) { return value < piece.x; });
  const Piece& piece = *(after - 1);
  const double t = x - piece.x;
  return piece.a[0] + t * (piece.a[1] + t * (piece.a[2] + t * piece.a[3]));
}

Curve Curve::scaled(double factor) const {
  Curve curve = *this;
  for (double& coefficient : curve.polynomial_) coefficient *= factor;
  for (Piece& piece : curve.pieces_) {
    for (double& coefficient : piece.a) coefficient *= factor;
  }
  return curve;
}

}  // namespace bodyopt::muscle_models
