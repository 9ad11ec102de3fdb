// Squared distances from planes, summed (Garland and Heckbert 1997).
#pragma once

#include <Eigen/Core>
#include <array>

namespace bodyopt {

// x^T A x + 2 b^T x + c over all planes, each times its weight.
class Quadric {
 public:
  // The plane of all x with normal . x + offset = 0; `normal` of unit length.
  void add_plane(const Eigen::Vector3d& normal, double offset, double weight) {
    const double n[] = {normal.x(), normal.y(), normal.z(), offset};
    std::size_t k = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) sums_[k++] += weight * n[i] * n[j];
    }
  }

  Quadric& operator+=(const Quadric& other) {
    for (std::size_t k = 0; k < sums_.size(); ++k) sums_[k] += other.sums_[k];
    return *this;
  }

  double at(const Eigen::Vector3d& x) const {
    const auto& s = sums_;
    return x.x() * (s[0] * x.x() + 2 * (s[1] * x.y() + s[2] * x.z() + s[3])) +
           x.y() * (s[4] * x.y() + 2 * (s[5] * x.z() + s[6])) + x.z() * (s[7] * x.z() + 2 * s[8]) + s[9];
  }

 private:
  std::array<double, 10> sums_{};  // upper triangle, row by row
};

}  // namespace bodyopt
