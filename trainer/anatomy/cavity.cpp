#include <algorithm>
#include <cmath>

#include "trainer/anatomy/human_bones.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

// Millimetres of muscle between fat and belly: thin in front, three layers at the side.
const Table kBellyWall({{0, 9}, {50, 9}, {110, 15}});
// Where the belly ends behind, forward of the vertebrae's middle, by the distance from the median plane: before the
// vertebrae and psoas, then as far back as the kidneys.
const Table kBellyBack({{0, 19}, {25, 19}, {45, 14}, {62, -12}, {90, -22}});

}  // namespace

std::function<double(const Spot&)> human_cavity(const HumanSkeleton& skeleton, const SpineLine& spine,
                                                const RibCage& cage) {
  const double mm = skeleton.mm(1);
  const auto landmark = [&](const char* name, const Vector3d& otherwise) {
    const auto found = skeleton.landmarks.find(name);
    return found == skeleton.landmarks.end() ? otherwise : found->second;
  };
  const Vector3d low(0, spine.low, spine.forward(spine.low));
  const Vector3d crest = landmark("iliac_crest", low), pubis = landmark("pubis", low), coccyx = landmark("coccyx", low);
  const double psis = landmark("posterior_superior_iliac_spine", low).y();
  const double loin = std::max(crest.y() - 15 * mm, psis + mm);
  // The pelvis is a bowl: narrow and between pubis and coccyx below, open to the belly above.
  const Table half_width(
      {{pubis.y(), 20 * mm}, {pubis.y() + 40 * mm, 52 * mm}, {psis, 80 * mm}, {crest.y(), 130 * mm}});
  const Table front({{pubis.y(), pubis.z() - 12 * mm}, {pubis.y() + 30 * mm, pubis.z()}, {psis, pubis.z() + 80 * mm}});
  const Table sacrum({{coccyx.y(), coccyx.z() + 18 * mm}, {psis, spine.forward(psis) + 22 * mm}});

  return [=](const Spot& spot) {
    const Vector3d& p = spot.point;
    const double aside = std::abs(p.x()), middle = spine.forward(p.y());
    const double chest = cage.distance(spot) + cage.shell();
    // Gullet and windpipe.
    if (spot.region == BodyRegion::neck) return std::min(chest, std::hypot(aside, p.z() - middle - 36 * mm) - 19 * mm);
    if (!is_trunk(spot.region)) return kFarFromBone;
    const double above_pelvis = std::clamp((p.y() - psis) / (loin - psis), 0.0, 1.0);
    const double back = std::lerp(sacrum(p.y()), middle + mm * kBellyBack(aside / mm), above_pelvis);
    const double wall = spot.fat + mm * kBellyWall(aside / mm) - spot.depth;
    const double belly = std::max({wall, pubis.y() - p.y(), p.y() - cage.costal_arch(spot), back - p.z(),
                                   p.z() - front(p.y()), aside - half_width(p.y())});
    return std::min(chest, belly);
  };
}

}  // namespace bodyopt
