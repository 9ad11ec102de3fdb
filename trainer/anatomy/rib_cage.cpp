#include <algorithm>
#include <cmath>

#include "trainer/anatomy/human_bones.h"

namespace bodyopt {
namespace {

constexpr int kCageHeights = 12;

// Muscle, and behind it the shoulder blade, between the fat and the ribs; millimetres by the distance from the middle.
double muscle_on_ribs(double aside, double height, bool is_front) {
  static const Table kFront({{0, 5}, {25, 8}, {50, 16}}), kBack({{0, 30}, {60, 24}, {120, 14}});
  return is_front ? kFront(aside) * std::clamp(3 * height, 0.4, 1.0) : kBack(aside);
}

}  // namespace

RibCage::RibCage(const HumanSkeleton& skeleton, double crest_height) : mm_(skeleton.mm(1)) {
  const HumanFrame& frame = skeleton.frame;
  const auto& upper = frame.clavicle ? frame.clavicle : frame.neck ? frame.neck : frame.shoulder;
  bottom_ = crest_height + 45 * mm_;
  top_ = std::max(upper ? upper->at.y() + 45 * mm_ : bottom_, bottom_ + 100 * mm_);
  std::vector<std::pair<double, double>> back, front;
  for (int k = 0; k < kCageHeights; ++k) {
    const double height = std::lerp(bottom_, top_, static_cast<double>(k) / (kCageHeights - 1));
    const auto depths = skeleton.survey.depths(height);
    if (!depths) continue;
    back.emplace_back(height, depths->back);
    front.emplace_back(height, depths->front);
  }
  back_ = Table(back);
  front_ = Table(front);
  // No wider than the skin allows where it is widest.
  const double widest = std::lerp(bottom_, top_, 0.35);
  double flank = 0;
  for (const Spot& spot : skeleton.survey.spots()) {
    if (is_trunk(spot.region) && std::abs(spot.point.y() - widest) < skeleton.survey.grid().cell)
      flank = std::max(flank, spot.point.x());
  }
  const double scale = mm_ * std::clamp((flank - 22 * mm_) / (136 * mm_), 0.1, 1.0);
  std::vector<std::pair<double, double>> rows;
  for (const auto& [share, width] : {std::pair(0.0, 125), {0.2, 136}, {0.45, 136}, {0.7, 118}, {0.88, 85}, {1.0, 45}})
    rows.emplace_back(std::lerp(bottom_, top_, share), scale * width);
  half_width_ = Table(rows);
}

double RibCage::costal_arch(const Spot& spot) const {
  const double back = back_(spot.point.y()), front = front_(spot.point.y());
  const double forward = std::clamp((2 * spot.point.z() - back - front) / std::max(front - back, mm_), 0.0, 1.0);
  return bottom_ + 120 * mm_ * forward * std::clamp(1 - std::abs(spot.point.x()) / (105 * mm_), 0.0, 1.0);
}

double RibCage::wall_distance(const Spot& spot) const {
  constexpr double kRound = 2.3;  // exponent of the section's outline: 2 is an ellipse
  const double height = spot.point.y(), aside = std::abs(spot.point.x());
  const double back = back_(height), front = front_(height), width = half_width_(height);
  const double middle = 0.5 * (back + front), half = std::max(0.5 * (front - back), mm_);
  const double outline = std::pow(
      std::pow(aside / width, kRound) + std::pow(std::abs(spot.point.z() - middle) / half, kRound), 1 / kRound);
  const double share = std::clamp((height - bottom_) / (top_ - bottom_), 0.0, 1.0);
  const double muscle = mm_ * muscle_on_ribs(aside / mm_, share, spot.point.z() > middle);
  return std::max((outline - 1) * std::min(width, half), spot.fat + muscle - spot.depth);
}

double RibCage::distance(const Spot& spot) const {
  if (!is_trunk(spot.region) && spot.region != BodyRegion::neck) return kFarFromBone;
  return std::max({wall_distance(spot), costal_arch(spot) - spot.point.y(), spot.point.y() - top_});
}

double RibCage::bone_distance(const Spot& spot) const {
  constexpr double kPitch = 27, kFall = 0.35;  // millimetres from rib to rib; down on the way to the front
  if (!is_trunk(spot.region) && spot.region != BodyRegion::neck) return kFarFromBone;
  const Eigen::Vector3d& p = spot.point;
  const double wall = std::abs(wall_distance(spot) + shell() / 2) - shell() / 2;
  const double middle = 0.5 * (back_(p.y()) + front_(p.y()));
  const double turns = (p.y() + kFall * (p.z() - middle)) / (kPitch * mm_);
  const double rib = (std::abs(turns - std::floor(turns) - 0.25) - 0.25) * kPitch * mm_;
  const double sternum = std::max({std::abs(p.x()) - 19 * mm_, middle - p.z(), top_ - 240 * mm_ - p.y()});
  const double ends = std::max(p.y() - (top_ - 4 * mm_), costal_arch(spot) + 3 * mm_ - p.y());
  return std::max({wall, std::min(rib, sternum), ends});
}

void add_rib_cage(HumanSkeleton& skeleton, const RibCage& cage) {
  std::vector<HumanFrame::Place> beside;  // joints of the spine at the cage's height, the highest at least
  for (const auto& place : skeleton.frame.spine) {
    if (place.at.y() > cage.bottom() || &place == &skeleton.frame.spine.back()) beside.push_back(place);
  }
  if (beside.empty() && skeleton.frame.pelvis) beside.push_back(*skeleton.frame.pelvis);
  skeleton.add_by_height(beside, [cage](const Spot& spot) { return cage.bone_distance(spot); });
}

}  // namespace bodyopt
