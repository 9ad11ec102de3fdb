#include <array>

#include "geometry/extent.h"
#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {
namespace {

constexpr std::array kRegionNames{"trunk", "hip",       "neck",    "head", "thigh", "calf",
                                  "foot",  "upper_arm", "forearm", "hand", "tail",  "fin"};

// By BodyPart; of what follows, hands.
constexpr BodyRegion kRegionOfPart[] = {BodyRegion::hip,   BodyRegion::trunk,     BodyRegion::neck,
                                        BodyRegion::head,  BodyRegion::hip,       BodyRegion::thigh,
                                        BodyRegion::calf,  BodyRegion::foot,      BodyRegion::foot,
                                        BodyRegion::trunk, BodyRegion::upper_arm, BodyRegion::forearm};

BodyRegion region_of_part(BodyPart part) {
  return part < BodyPart::hand ? kRegionOfPart[static_cast<std::size_t>(part)] : BodyRegion::hand;
}

// Some rigs begin the spine at the hips.
bool stands_at_hips(const HalfBody& body, std::size_t joint) {
  constexpr double kBeside = 0.015;  // of the body's extent
  const int hip = body.find(BodyPart::thigh), other = body.find(BodyPart::thigh, BodySide::right);
  if (hip < 0 && other < 0) return false;
  const double height = body.places[static_cast<std::size_t>(hip < 0 ? other : hip)].y();
  return body.places[joint].y() < height + kBeside * longest_extent(body.vertices);
}

}  // namespace

const char* name_of(BodyRegion region) { return kRegionNames[static_cast<std::size_t>(region)]; }

std::vector<BodyRegion> regions_of_joints(const HalfBody& body) {
  std::vector<BodyRegion> regions;
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const int parent = body.joints[j].parent;
    regions.push_back(body.roles[j] ? region_of_part(body.roles[j]->part)
                      : parent >= 0 ? regions[static_cast<std::size_t>(parent)]
                                    : BodyRegion::trunk);
    const bool is_spine = body.roles[j] && body.roles[j]->part == BodyPart::spine;
    if (is_spine && stands_at_hips(body, j)) regions.back() = BodyRegion::hip;
  }
  return regions;
}

}  // namespace bodyopt
