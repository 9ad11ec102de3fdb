// Functions of one variable in muscle models: couplings of joints, moving path points.
#pragma once

#include <vector>

namespace bodyopt::muscle_models {

class Curve {
 public:
  // sum of coefficients[k] x^k; none: zero.
  static Curve polynomial(std::vector<double> coefficients);
  // The cubic spline through (x, y), x ascending, 2 points or more, straight beyond its ends. At each end its third
  // derivative is that of the cubic through the four outermost points (Forsythe, Malcolm, Moler 1977, chapter 4);
  // OpenSim's SimmSpline is the same function.
  static Curve spline(const std::vector<double>& x, const std::vector<double>& y);

  // Straight from point to point, and on beyond the ends; points as above.
  static Curve polyline(const std::vector<double>& x, const std::vector<double>& y);

  double operator()(double x) const;
  Curve scaled(double factor) const;

 private:
  struct Piece {
    double x = 0;                // where it begins
    double a[4] = {0, 0, 0, 0};  // sum of a[k] (t - x)^k
  };
  // Cubics from point to point, by a sixth of the second derivative at each.
  static Curve pieces(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sixth);
  std::vector<double> polynomial_;
  std::vector<Piece> pieces_;
};

}  // namespace bodyopt::muscle_models
