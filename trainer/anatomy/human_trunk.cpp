#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "trainer/anatomy/bone.h"
#include "trainer/anatomy/human_bones.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Vector3d;
using Place = HumanFrame::Place;

// The vertebrae's middles, from the sacrum to the skull.
struct SpineLine {
  double low = 0, high = 0;  // heights
  Table forward;             // z of height
  Table half_width, half_depth;
};

constexpr int kHeights = 40, kCurveSmoothings = 6;

// The vertebrae's middles lie so far before the skin of the back, but for fat; at most 0.45 of the way to the front.
double forward_of_back(const HumanSkeleton& skeleton, const BodySurvey::Depths& depths, double height, double share) {
  static const Table kFromSkin({{0, 72}, {0.3, 70}, {0.6, 55}, {0.8, 45}, {1, 55}});
  constexpr double kMost = 0.45;
  const double fat = skeleton.survey.spot({0, height, depths.back + skeleton.mm(3)}).fat;
  return depths.back + std::min(skeleton.mm(kFromSkin(share)) + fat, kMost * (depths.front - depths.back));
}

constexpr int kCageHeights = 12;

// Muscle, and behind it the shoulder blade, between the fat and the ribs; millimetres by the distance from the middle.
double muscle_on_ribs(double aside, double height, bool is_front) {
  static const Table kFront({{0, 5}, {25, 8}, {50, 16}}), kBack({{0, 30}, {60, 24}, {120, 14}});
  return is_front ? kFront(aside) * std::clamp(3 * height, 0.4, 1.0) : kBack(aside);
}

// Ribs and breastbone: a shell about the lungs, of which every other strip is rib.
class RibCage {
 public:
  RibCage(const HumanSkeleton& skeleton, double crest_height) : mm_(skeleton.mm(1)) {
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

  // Distance to its outer surface, roughly; negative inside.
  double distance(const Spot& spot) const {
    if (!is_trunk(spot.region) && spot.region != BodyRegion::neck) return kFarFromBone;
    return std::max({wall_distance(spot), costal_arch(spot) - spot.point.y(), spot.point.y() - top_});
  }

  double bone_distance(const Spot& spot) const {
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

  double shell() const { return 10 * mm_; }  // metres thick
  double bottom() const { return bottom_; }

  // Height at which it ends, above or below a place
  double costal_arch(const Spot& spot) const {
    const double back = back_(spot.point.y()), front = front_(spot.point.y());
    const double forward = std::clamp((2 * spot.point.z() - back - front) / std::max(front - back, mm_), 0.0, 1.0);
    return bottom_ + 120 * mm_ * forward * std::clamp(1 - std::abs(spot.point.x()) / (105 * mm_), 0.0, 1.0);
  }

 private:
  // Open above and below
  double wall_distance(const Spot& spot) const {
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

  Table half_width_, back_, front_;  // of height
  double top_, bottom_, mm_;
};

// A place behind the ribs, under the skin of the back.
Vector3d behind_cage(const HumanSkeleton& skeleton, const RibCage& cage, double aside, double height, double behind) {
  const auto depths = skeleton.survey.depths(height, aside);
  if (!depths) return {aside, height, 0};
  const double step = skeleton.mm(2);
  const double under_skin =
      depths->back + skeleton.survey.spot({aside, height, depths->back + step}).fat + skeleton.mm(12);
  for (double z = depths->back; z < depths->front; z += step) {
    if (cage.distance(skeleton.survey.spot({aside, height, z})) < 0)
      return {aside, height, std::max(z - behind, under_skin)};
  }
  return {aside, height, depths->back + skeleton.mm(22)};
}

// The end of the collar bone at the breastbone.
Vector3d sternal_end(const HumanSkeleton& skeleton, double height) {
  const double aside = skeleton.mm(22);
  const auto depths = skeleton.survey.depths(height, aside);
  if (!depths) return {aside, height, 0};
  const double fat = skeleton.survey.spot({aside, height, depths->front - skeleton.mm(3)}).fat;
  return {aside, height, depths->front - fat - skeleton.mm(12)};
}

constexpr double kHipAside = 83.5;  // millimetres from the median plane, in the model the landmarks are from
constexpr double kWidest = 1.15;    // a rig's hips may lie farther apart than a pelvis is wide

struct PelvisPlaces {
  Vector3d asis, psis, crest, ischium, pubis, sacrum, sacrum_middle, coccyx, aiis, socket;
};

// Forward, up, outwards of the hip's centre, after the pelvis of gait2392 (Delp et al. 1990) and by eye. Places inwards
// follow how far apart the rig's hips are.
PelvisPlaces pelvis_places(const HumanSkeleton& skeleton, const Vector3d& hip) {
  const double wide = std::min(kWidest, hip.x() / skeleton.mm(kHipAside));
  const auto place = [&](double forward, double up, double out) {
    Vector3d at = hip + skeleton.mm(out < 0 ? wide * out : out, up, forward);
    at.x() = std::max(at.x(), 0.0);
    return at;
  };
  const double middle = -2 * kHipAside;
  return {place(62, 62, 36),   place(-74, 62, -38),        place(-5, 105, 42),     place(-28, -68, -20),
          place(52, -22, -80), place(-40, 78, middle),     place(-72, 30, middle), place(-85, -15, middle),
          place(40, 34, 14),   hip + skeleton.mm(0, 8, -8)};
}

// The socket is a bowl about the femur's head, open outwards.
double socket_distance(const Vector3d& point, const Vector3d& hip, double outer, double inner, double open) {
  const double away = (point - hip).norm();
  const double rim = (point - hip).dot(Vector3d(1, -0.5, 0).normalized()) + open;
  return std::max({away - outer, inner - away, rim});
}

// Millimetres of muscle between fat and belly: thin in front, three layers at the side.
const Table kBellyWall({{0, 9}, {50, 9}, {110, 15}});
// The belly's end behind, forward of the vertebrae's middle, by the distance from the median plane. It lies before the
// vertebrae and psoas, then as far back as the kidneys.
const Table kBellyBack({{0, 19}, {25, 19}, {45, 14}, {62, -12}, {90, -22}});

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

void add_rib_cage(HumanSkeleton& skeleton, const RibCage& cage) {
  std::vector<HumanFrame::Place> beside;  // joints of the spine at the cage's height, the highest at least
  for (const auto& place : skeleton.frame.spine) {
    if (place.at.y() > cage.bottom() || &place == &skeleton.frame.spine.back()) beside.push_back(place);
  }
  if (beside.empty() && skeleton.frame.pelvis) beside.push_back(*skeleton.frame.pelvis);
  skeleton.add_by_height(beside, [cage](const Spot& spot) { return cage.bone_distance(spot); });
}

void add_shoulder_girdle(HumanSkeleton& skeleton, const RibCage& cage) {
  const HumanFrame& frame = skeleton.frame;
  if (!frame.shoulder) return;
  const Vector3d shoulder = frame.shoulder->at;
  const int joint = frame.clavicle ? frame.clavicle->joint : frame.spine_joint(shoulder.y());
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const Vector3d acromion = shoulder + skeleton.mm(4, 34, -8), glenoid = shoulder - skeleton.mm(24, 0, 0);
  const Vector3d sternal = sternal_end(skeleton, (frame.clavicle ? frame.clavicle->at.y() : shoulder.y()) + mm(12));
  const std::vector<ChainLink> clavicle{{sternal, mm(9)},
                                        {sternal + 0.35 * (acromion - sternal) + skeleton.mm(0, 4, 14), mm(6.5)},
                                        {acromion + skeleton.mm(-14, 0, 8), mm(7)}};
  skeleton.add(
      joint, [=](const Spot& spot) { return chain_distance(spot.point, clavicle); }, 4);

  const Vector3d above = behind_cage(skeleton, cage, mm(62), shoulder.y() + mm(40), mm(14));
  const Vector3d below = behind_cage(skeleton, cage, mm(85), shoulder.y() - mm(95), mm(14));
  const Vector3d root = behind_cage(skeleton, cage, mm(60), shoulder.y() + mm(12), mm(17));
  const Vector3d neck = glenoid + skeleton.mm(-14, 0, -6), corner = glenoid + skeleton.mm(-6, 0, -8);
  const Vector3d coracoid[2] = {glenoid + skeleton.mm(-8, 10, 6), glenoid + skeleton.mm(4, 16, 32)};
  const std::vector<ChainLink> spine{
      {root, mm(5)}, {0.5 * (root + acromion) + skeleton.mm(0, 6, -14), mm(8)}, {acromion, mm(9)}};
  const double blade = mm(4.5), rim = mm(15), neck_radius = mm(10), head = mm(24.5);
  const double coracoid_radius[2] = {mm(8), mm(7)};
  const auto scapula = [=](const Spot& spot) {
    const Vector3d& p = spot.point;
    const double socket = std::max(cone_distance(p, glenoid, neck, rim, neck_radius), head - (p - shoulder).norm());
    return std::min({plate_distance(p, above, below, corner, blade), socket, chain_distance(p, spine),
                     cone_distance(p, coracoid[0], coracoid[1], coracoid_radius[0], coracoid_radius[1])});
  };
  skeleton.add(joint, scapula, 5);
  skeleton.landmarks["acromion"] = acromion;
  skeleton.landmarks["glenoid"] = glenoid;
  skeleton.landmarks["sternal_end_of_clavicle"] = sternal;
  skeleton.landmarks["superior_angle_of_scapula"] = above;
  skeleton.landmarks["inferior_angle_of_scapula"] = below;
  skeleton.landmarks["root_of_scapular_spine"] = root;
  skeleton.landmarks["coracoid_process"] = coracoid[1];
}

void add_pelvis(HumanSkeleton& skeleton) {
  if (!skeleton.frame.hip || !skeleton.frame.pelvis) return;
  const Vector3d hip = skeleton.frame.hip->at;
  const PelvisPlaces at = pelvis_places(skeleton, hip);
  const auto mm = [&skeleton](double length) { return skeleton.mm(length); };
  const double thin = mm(6), thick = mm(8), rim = mm(8), ramus = mm(9), wing = mm(13);
  const double bowl = mm(32), head = mm(25), open = mm(2), widest = mm(44);
  const double pubis[2] = {mm(14), mm(11)}, ischium[2] = {mm(19), mm(17)}, sacrum[2] = {mm(26), mm(22)};
  const auto distance = [=](const Spot& spot) {
    const Vector3d& p = spot.point;
    const double ilium = std::min(
        {plate_distance(p, at.asis, at.crest, at.socket, thin), plate_distance(p, at.crest, at.psis, at.socket, thin),
         plate_distance(p, at.asis, at.aiis, at.socket, thick), cone_distance(p, at.asis, at.crest, rim, rim),
         cone_distance(p, at.crest, at.psis, rim, rim)});
    const double below =
        std::min({cone_distance(p, at.socket, at.pubis, pubis[0], pubis[1]),
                  cone_distance(p, at.socket, at.ischium, ischium[0], ischium[1]),
                  cone_distance(p, at.ischium, at.pubis, ramus, ramus), socket_distance(p, hip, bowl, head, open)});
    const double back =
        std::min(plate_distance(p, at.psis, at.sacrum, at.coccyx, wing),
                 std::max(cone_distance(p, at.sacrum, at.sacrum_middle, sacrum[0], sacrum[1]), p.x() - widest));
    return std::min({ilium, below, back});
  };
  // The femur's head keeps the place that the socket leaves it.
  skeleton.add(
      skeleton.frame.pelvis->joint,
      [=](const Spot& spot) { return std::max(distance(spot), head - (spot.point - hip).norm()); }, 6);
  skeleton.landmarks["anterior_superior_iliac_spine"] = at.asis;
  skeleton.landmarks["posterior_superior_iliac_spine"] = at.psis;
  skeleton.landmarks["iliac_crest"] = at.crest;
  skeleton.landmarks["ischial_tuberosity"] = at.ischium;
  skeleton.landmarks["pubis"] = at.pubis;
  skeleton.landmarks["sacrum"] = at.sacrum;
  skeleton.landmarks["coccyx"] = at.coccyx;
}

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

}  // namespace

void HumanSkeleton::add_by_height(std::vector<Place> places, const std::function<double(const Spot&)>& distance) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double low = k == 0 ? -HUGE_VAL : places[k].at.y();
    const double high = k + 1 < places.size() ? places[k + 1].at.y() : HUGE_VAL;
    add(places[k].joint, [=](const Spot& spot) {
      return spot.point.y() > low && spot.point.y() <= high ? distance(spot) : kFarFromBone;
    });
  }
}

std::function<double(const Spot&)> add_trunk(HumanSkeleton& skeleton) {
  add_pelvis(skeleton);
  const SpineLine spine = spine_line(skeleton);
  add_spine(skeleton, spine);
  const auto crest = skeleton.landmarks.find("iliac_crest");
  const RibCage cage(skeleton, crest == skeleton.landmarks.end() ? spine.low : crest->second.y());
  add_rib_cage(skeleton, cage);
  add_shoulder_girdle(skeleton, cage);
  return human_cavity(skeleton, spine, cage);
}

}  // namespace bodyopt::trainer
