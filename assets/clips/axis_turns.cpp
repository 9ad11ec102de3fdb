#include "assets/clips/axis_turns.h"

#include <cmath>
#include <numbers>

namespace bodyopt {

std::vector<Quat> axis_turns() {
  const double quarter = std::numbers::pi / 2;
  std::vector<Quat> turns{{0, 0, 0, 1}, axis_angle({1, 0, 0}, -quarter), axis_angle({1, 0, 0}, quarter)};
  for (int tip = 0; tip < 6; ++tip) {
    const Quat top = tip < 4 ? axis_angle({1, 0, 0}, tip * quarter) : axis_angle({0, 0, 1}, (2 * tip - 9) * quarter);
    for (int spin = 0; spin < 4; ++spin) turns.push_back(top * axis_angle({0, 1, 0}, spin * quarter));
  }
  return turns;
}

Quat turn_upright(const Skeleton& skeleton) {
  const Quat none{0, 0, 0, 1};
  if (skeleton.joints.empty()) return none;
  const Joint& first = skeleton.joints.front();
  const Quat turned = normalized(first.default_local.rotation) * conjugate(normalized(first.bind.rotation));
  const double within = std::cos(std::numbers::pi / 24);  // of half the angle
  for (const Quat& turn : axis_turns()) {
    const double cosine = turn[0] * turned[0] + turn[1] * turned[1] + turn[2] * turned[2] + turn[3] * turned[3];
    if (std::abs(cosine) < within) continue;
    return rotate(turn, {0, 1, 0})[1] > 0.5 ? none : turn;
  }
  return none;
}

Positions upright_skin(const Skeleton& skeleton, const Positions& vertices) {
  const auto rows = rotation_matrix(turn_upright(skeleton));
  return vertices * Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&rows[0][0]).transpose();
}

}  // namespace bodyopt
