#include "trainer/anatomy/human_bones.h"

#include <algorithm>

namespace bodyopt {

void HumanSkeleton::add(int joint, std::function<double(const Spot&)> distance, double cover) {
  if (joint >= 0) bones.push_back({joint, mm(cover), std::move(distance)});
}

void HumanSkeleton::add_cores(BodyRegion region, const std::function<double(int)>& share) {
  const std::vector<BodyRegion>& regions = survey.regions();
  for (int j = 0; j < static_cast<int>(regions.size()); ++j) {
    const double of_half = regions[static_cast<std::size_t>(j)] == region ? share(j) : 0;
    if (of_half == 0) continue;
    const auto distance = [=](const Spot& spot) {
      return spot.joint == j ? of_half * spot.half_thickness - spot.depth : kFarFromBone;
    };
    add(j, distance, 0);
  }
}

void add_head(HumanSkeleton& skeleton) {
  if (!skeleton.frame.head) return;
  const auto& [joint, head] = *skeleton.frame.head;
  const double mm = skeleton.mm(1);
  // The skull ends above the neck, in front with the chin. Skin and muscle lie thin over it, thicker on the face and
  // below the back of the head.
  const Table base({{head.z() + 10 * mm, head.y() + 5 * mm}, {head.z() + 50 * mm, head.y() - 60 * mm}});
  const Table face_below({{head.y() + 10 * mm, 1}, {head.y() + 60 * mm, 0}});
  const Table face_before({{head.z() - 20 * mm, 0}, {head.z() + 20 * mm, 1}});
  const Table nape_below({{head.y() + 10 * mm, 1}, {head.y() + 40 * mm, 0}});
  const Table nape_behind({{head.z() - 30 * mm, 1}, {head.z(), 0}});
  const auto skull = [=](const Spot& spot) {
    if (spot.region != BodyRegion::head) return kFarFromBone;
    const double y = spot.point.y(), z = spot.point.z();
    const double face = face_below(y) * face_before(z), nape = nape_below(y) * nape_behind(z);
    return std::max(spot.fat + (4 + 10 * face + 20 * nape) * mm - spot.depth, base(z) - y);
  };
  skeleton.add(joint, skull, 2);
}

}  // namespace bodyopt
