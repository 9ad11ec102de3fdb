#include <algorithm>
#include <cmath>

#include "trainer/anatomy/human_bones.h"

namespace bodyopt {
namespace {

using Place = HumanFrame::Place;

constexpr int kHeights = 40, kCurveSmoothings = 6;

// The vertebrae's middles lie so far before the skin of the back, but for fat; at most 0.45 of the way to the front.
double forward_of_back(const HumanSkeleton& skeleton, const BodySurvey::Depths& depths, double height, double share) {
  static const Table kFromSkin({{0, 72}, {0.3, 70}, {0.6, 55}, {0.8, 45}, {1, 55}});
  constexpr double kMost = 0.45;
  const double fat = skeleton.survey.spot({0, height, depths.back + skeleton.mm(3)}).fat;
  return depths.back + std::min(skeleton.mm(kFromSkin(share)) + fat, kMost * (depths.front - depths.back));
}

}  // namespace

SpineLine spine_line(const HumanSkeleton& skeleton) {
  const HumanFrame& frame = skeleton.frame;
  SpineLine spine;
  const Positions& vertices = skeleton.survey.body().vertices;
  const double bottom = vertices.col(1).minCoeff(), top = vertices.col(1).maxCoeff();
  spine.low = (frame.hip ? frame.hip->at.y() : frame.pelvis ? frame.pelvis->at.y() : bottom) + skeleton.mm(75);
  spine.high = std::max((frame.head ? frame.head->at.y() : top) - skeleton.mm(10), spine.low + skeleton.mm(10));
  std::vector<std::pair<double, double>> rows;
  for (int k = 0; k < kHeights; ++k) {
    const double share = static_cast<double>(k) / (kHeights - 1), height = std::lerp(spine.low, spine.high, share);
    if (const auto depths = skeleton.survey.depths(height))
      rows.emplace_back(height, forward_of_back(skeleton, *depths, height, share));
  }
  smooth(rows, &std::pair<double, double>::second, kCurveSmoothings);
  spine.forward = Table(rows);
  const auto at = [&](double share) { return std::lerp(spine.low, spine.high, share); };
  const auto mm = [&](double length) { return skeleton.mm(length); };
  spine.half_width = Table({{at(0), mm(26)}, {at(0.3), mm(24)}, {at(0.6), mm(16)}, {at(1), mm(12)}});
  spine.half_depth = Table({{at(0), mm(19)}, {at(0.3), mm(18)}, {at(0.6), mm(14)}, {at(1), mm(10)}});
  return spine;
}

void HumanSkeleton::add_by_height(std::vector<Place> places, const std::function<double(const Spot&)>& distance) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double low = k == 0 ? -HUGE_VAL : places[k].at.y();
    const double high = k + 1 < places.size() ? places[k + 1].at.y() : HUGE_VAL;
    add(places[k].joint, [=](const Spot& spot) {
      return spot.point.y() > low && spot.point.y() <= high ? distance(spot) : kFarFromBone;
    });
  }
}

void add_spine(HumanSkeleton& skeleton, const SpineLine& spine) {
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const double arch_back = mm(14), arch_half = mm(8), process_half = mm(4), process_back = mm(42),
               process_cover = mm(4);
  const auto vertebrae = [=](const Spot& spot) {
    const Eigen::Vector3d& p = spot.point;
    const double middle = spine.forward(p.y()), width = spine.half_width(p.y()), depth = spine.half_depth(p.y());
    const double body = (std::hypot(p.x() / width, (p.z() - middle) / depth) - 1) * depth;
    const double arch =
        std::max(std::abs(p.z() - (middle - depth - arch_back)) - arch_half, std::abs(p.x()) - 0.85 * width);
    const double process = std::max({std::abs(p.x()) - process_half, p.z() - middle,
                                     middle - depth - process_back - p.z(), spot.fat + process_cover - spot.depth});
    return std::max({std::min({body, arch, process}), spine.low - p.y(), p.y() - spine.high});
  };
  std::vector<Place> places;
  if (skeleton.frame.pelvis) places.push_back(*skeleton.frame.pelvis);
  places.insert(places.end(), skeleton.frame.spine.begin(), skeleton.frame.spine.end());
  places.insert(places.end(), skeleton.frame.cervical.begin(), skeleton.frame.cervical.end());
  skeleton.add_by_height(places, vertebrae);
}

}  // namespace bodyopt
