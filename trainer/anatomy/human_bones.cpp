#include "trainer/anatomy/human_bones.h"

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

}  // namespace bodyopt
