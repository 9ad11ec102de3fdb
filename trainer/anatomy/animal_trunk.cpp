#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "trainer/anatomy/animal.h"
#include "trainer/anatomy/bone.h"

namespace bodyopt::trainer {
namespace {

// Walls of the cavity of lungs, heart and gut, by BodyKind: quadrupeds have thin flanks, birds a breast full of muscle.
// Fish have their gut in the lower third, between thick flanks.
constexpr CavityWalls kWalls[] = {{0.22, 0.16, 0.5}, {0.18, 0.10, 0.6}, {0.25, 0.36, 0.7}, {0.42, 0.22, 1, 0.1},
                                  {0.35, 0.12, 1},   {0.3, 0.25},       {0.22, 0.16, 0.5}};

// The skin of upper limbs reaches over the trunk.
bool may_hold_cavity(BodyRegion region) {
  constexpr BodyRegion kNone[] = {BodyRegion::head, BodyRegion::neck, BodyRegion::tail,
                                  BodyRegion::foot, BodyRegion::hand, BodyRegion::fin};
  return std::ranges::find(kNone, region) == std::end(kNone);
}

// Shares of the body's size.
constexpr double kVertebra = 0.022, kProcess = 0.0022, kRib = 0.0035, kAxisCover = 0.002;
constexpr double kRibShare = 0.42;  // of the length that a rib and the gap beside it take

bool has_processes(BodyKind kind) { return kind != BodyKind::many_legs && kind != BodyKind::limb; }

// Radius of the vertebrae's bodies, metres.
double vertebra_radius(const Animal& animal, const SpineCurve::Row& row) {
  constexpr double kShare = 0.11, kMost = 0.0095;  // of the section's height, of the body's size
  const double part = kShare * (row.up + row.down), most = kMost * animal.size;
  return 2 * part * most / (part + most);
}

// The bones of those rows of the spine that one joint holds.
class AxisPart {
 public:
  AxisPart(const Animal& animal, const AnimalCavity& cavity, double thickness, double from, double to)
      : animal_(animal), cavity_(cavity), thickness_(thickness), from_(from), to_(to) {}

  double operator()(const Spot& spot) const {
    constexpr double kNext = 4;  // rows: what is nearer to those belongs to the bones of another joint
    const SpineCurve::Spot at = animal_.spine.spot(spot.point, from_ - kNext, to_ + kNext);
    if (at.row < from_ || at.row > to_) return animal_.size;
    const SpineCurve::Row row = animal_.spine.at(at.row);
    const double height = at.height - (row.place - row.middle).dot(row.dorsal);
    double distance = vertebra(at, row, height);
    if (at.is_beyond()) return distance;
    if (has_processes(animal_.kind)) distance = std::min(distance, process(spot, at, row, height));
    if (!cavity_.empty() && at.row >= cavity_.chest_from() && at.row <= cavity_.to() && has_processes(animal_.kind))
      distance = std::min({distance, rib(spot, at, row), breastbone(at, row)});
    return distance;
  }

 private:
  double vertebra(const SpineCurve::Spot& at, const SpineCurve::Row& row, double height) const {
    return std::hypot(at.aside, height, at.beyond) - thickness_ * vertebra_radius(animal_, row);
  }

  // -1 to 1 along one of many equal pieces of the body's length.
  double in_piece(double along, double piece) const { return 2 * (along / piece - std::floor(along / piece)) - 1; }

  // A process reaches from a vertebra to below the back; in fish also downwards, behind the gut.
  double process(const Spot& spot, const SpineCurve::Spot& at, const SpineCurve::Row& row, double height) const {
    const double piece = kVertebra * animal_.size;
    const double above = row.up - (row.place - row.middle).dot(row.dorsal), below = row.up + row.down - above;
    const bool reaches_down = animal_.kind == BodyKind::fish && at.row < cavity_.from();
    const double up = (at.row < animal_.spine.hip() ? 0.4 : 0.75) * above;
    const double off = height > 0 ? height - up : -height - (reaches_down ? 0.75 * below : 0);
    const double along = (std::abs(in_piece(row.along, piece)) - 0.5) * piece / 2;
    const double skin = spot.fat + 2 * kAxisCover * animal_.size - spot.depth;
    return std::max({off, at.aside - kProcess * thickness_ * animal_.size, along, skin});
  }

  // A shell about the chest, of which strips that slant backwards are rib.
  double rib(const Spot& spot, const SpineCurve::Spot& at, const SpineCurve::Row& row) const {
    const double thick = kRib * thickness_ * animal_.size, piece = kVertebra * animal_.size;
    const double shell = cavity_.distance(spot, at, thick / 2);
    const double slanted = row.along + 0.35 * (row.up - at.height);
    const double strip = (std::abs(in_piece(slanted, piece)) - kRibShare) * piece / 2;
    return std::max(std::abs(shell) - thick / 2, strip);
  }

  double breastbone(const SpineCurve::Spot& at, const SpineCurve::Row& row) const {
    if (animal_.kind == BodyKind::snake || animal_.kind == BodyKind::fish) return animal_.size;
    const double thick = 1.2 * kRib * thickness_ * animal_.size, wide = 2 * thick;
    const double floor = -row.down + (animal_.kind == BodyKind::bird ? 0.28 : 0.09) * (row.up + row.down);
    const double front = cavity_.chest_from() + 0.35 * (cavity_.to() - cavity_.chest_from()) - at.row;
    return std::max({std::abs(at.height - floor) - thick, at.aside - wide, front * kVertebra * animal_.size});
  }

  const Animal& animal_;
  const AnimalCavity& cavity_;
  double thickness_, from_, to_;
};

using Eigen::Vector3d;
using Use = JointLimb::Use;

// Shares of the body's size.
constexpr double kPlate = 0.0028, kGirdleCover = 0.002;

// Plates from a limb's socket to the spine, measured along the body, to the back, and out of the median plane.
class Girdle {
 public:
  Girdle(const Animal& animal, const JointLimb& limb, double thickness)
      : animal_(animal),
        front_(limb.joints.front()),
        socket_(socket_of(limb)),
        half_(kPlate * thickness * animal.size) {
    const SpineCurve& spine = animal.spine;
    row_ = spine.row_near(animal.place(socket_));
    section_ = spine.at(row_);
    trunk_ = spine.at(spine.shoulder()).along - spine.at(spine.hip()).along;
    back_ = section_.up - (section_.place - section_.middle).dot(section_.dorsal);
  }

  bool is_hind() const { return row_ < 0.5 * (animal_.spine.hip() + animal_.spine.shoulder()); }

  // Ilium to the sacrum, ischium and pubis; they move with the spine.
  void add_pelvis(std::vector<Bone>& bones) const {
    const Vector3d& socket = animal_.place(socket_);
    const double x = std::abs(socket.x());
    const Vector3d ischium = socket - 0.6 * x * section_.forward + 0.3 * x * section_.dorsal;
    Vector3d pubis = socket - 0.5 * x * section_.dorsal;
    pubis.x() *= 0.15;
    add(section_.joint, socket, corner(0.16, 0.1, 0.75 * x), corner(0.02, 0, 0), bones);
    add(section_.joint, socket, ischium, pubis, bones);
  }

  // The blade begins at the limb's joint at its upper end, if there is one; otherwise below the back.
  void add_shoulder_blade(std::vector<Bone>& bones) const {
    const Vector3d& socket = animal_.place(socket_);
    const bool has_joint = socket_ != front_ && is_named(animal_.name(front_), {"scapula"});
    const double x = std::abs(socket.x());
    const Vector3d top = has_joint ? animal_.place(front_) : corner(0, 0.5, 0.45 * x);
    const Vector3d behind = has_joint ? Vector3d(top - 0.14 * trunk_ * section_.forward) : corner(-0.16, 0.4, 0.5 * x);
    add(socket_ == front_ ? section_.joint : front_, socket, top, behind, bones);
  }

 private:
  // The joint where a limb's first long bone begins.
  int socket_of(const JointLimb& limb) const {
    const int first = limb.joints.front();
    for (const int joint : limb.joints) {
      if (animal_.chains.parent[static_cast<std::size_t>(joint)] != first || !animal_.chains.has_skin(joint)) continue;
      const Vector3d along = animal_.place(joint) - animal_.place(first);
      const bool is_girdle = is_named(animal_.name(first), {"scapula", "clavicle", "collar", "pelvis"});
      if (is_girdle || std::abs(along.x()) > 0.7 * along.norm()) return joint;
    }
    return first;
  }

  // Shares of the trunk's length, of what lies behind the spine; metres aside.
  Vector3d corner(double along, double height, double aside) const {
    return section_.place + along * trunk_ * section_.forward + height * back_ * section_.dorsal +
           aside * Vector3d::UnitX();
  }

  void add(int joint, const Vector3d& a, const Vector3d& b, const Vector3d& c, std::vector<Bone>& bones) const {
    bones.push_back({joint, kGirdleCover * animal_.size,
                     [a, b, c, half = half_](const Spot& spot) { return plate_distance(spot.point, a, b, c, half); }});
  }

  const Animal& animal_;
  int front_, socket_;
  double half_, row_ = 0, trunk_ = 0, back_ = 0;
  SpineCurve::Row section_;
};

}  // namespace

bool holds_piece_of_trunk(const Animal& animal, int joint) {
  return animal.kind == BodyKind::limb && joint >= 0 && animal.chains.has_skin(joint) &&
         is_named(animal.name(joint), {"torso", "body", "chest", "spine", "hips"});
}

double rib_shell_distance(const Animal& animal, const Spot& spot) {
  constexpr double kWall = 0.013;  // of the body's size: muscle over the ribs
  return spot.fat + kWall * animal.size - spot.depth;
}

AnimalCavity::AnimalCavity(const Animal& animal)
    : animal_(animal), walls_(kWalls[static_cast<std::size_t>(animal.kind)]) {
  if (animal.spine.empty() || animal.kind == BodyKind::limb) return;
  const double hip = animal.spine.hip(), shoulder = animal.spine.shoulder();
  // The thoracic inlet lies a little before the shoulders' roots, the pelvic outlet at the hips.
  to_ = shoulder + 0.03 * (shoulder - hip);
  from_ = hip + 0.03 * (shoulder - hip);
}

double AnimalCavity::distance(const trainer::Spot& spot, const SpineCurve::Spot& at, double grown) const {
  constexpr double kPower = 2.4;  // of a section: a little fuller than an ellipse
  const SpineCurve::Row row = animal_.spine.at(at.row);
  const double spine = (row.place - row.middle).dot(row.dorsal) - 1.2 * vertebra_radius(animal_, row);
  const double floor = -row.down + walls_.below * (row.up + row.down);
  const double end = walls_.end * (to_ - from_),
               from_end = std::min(at.row - from_, to_ - at.row) / std::max(end, 1e-9);
  const double narrow = 1 - std::clamp(from_end, 0.0, 1.0), taper = std::sqrt(std::max(1 - narrow * narrow, 0.0));
  const double half = 0.5 * (spine - floor), middle = 0.5 * (spine + floor);
  const double wide = taper * (1 - walls_.aside) * row.half_width + grown, high = taper * half + grown;
  if (wide <= 0 || high <= 0 || from_end < 0 || at.is_beyond()) return animal_.size;
  const double place =
      std::pow(std::pow(at.aside / wide, kPower) + std::pow(std::abs(at.height - middle) / high, kPower), 1 / kPower);
  const double section = (place - 1) * std::min(wide, high);
  return std::max(section, spot.fat + 0.12 * row.half_width - grown - spot.depth);
}

double AnimalCavity::distance(const trainer::Spot& spot) const {
  if (holds_piece_of_trunk(animal_, spot.joint)) return rib_shell_distance(animal_, spot);
  if (empty() || !may_hold_cavity(spot.region)) return animal_.size;
  return distance(spot, animal_.spine.spot(spot.point, from_, to_));
}

std::vector<Bone> axis_bones(const Animal& animal, const AnimalCavity& cavity, double thickness) {
  std::vector<Bone> bones;
  const std::vector<SpineCurve::Row>& rows = animal.spine.rows();
  for (std::size_t first = 0; first + 1 < rows.size();) {
    std::size_t last = first + 1;
    while (last + 1 < rows.size() && rows[last].joint == rows[first].joint) ++last;
    const AxisPart part(animal, cavity, thickness, static_cast<double>(first), static_cast<double>(last));
    bones.push_back({rows[first].joint, kAxisCover * animal.size, part});
    first = last;
  }
  return bones;
}

std::vector<Bone> skull_bones(const Animal& animal) {
  constexpr double kOfHead = 0.42, kOfBody = 0.035;  // of the volume, at most
  int head = -1;
  for (int j = static_cast<int>(animal.chains.is_head.size()); j-- > 0;)
    head = animal.chains.is_head[static_cast<std::size_t>(j)] && animal.chains.has_skin(j) ? j : head;
  std::vector<double> deep;
  for (const Spot& spot : animal.survey.spots()) {
    if (spot.region == BodyRegion::head) deep.push_back(spot.depth - spot.fat);
  }
  if (head < 0 || deep.empty()) return {};
  const double most = std::min(kOfHead * static_cast<double>(deep.size()), kOfBody * animal.survey.grid().size());
  const auto edge = deep.end() - 1 - static_cast<std::ptrdiff_t>(most);
  std::nth_element(deep.begin(), edge, deep.end());
  const double over = std::max(*edge, 0.0), far = animal.size;
  return {{head, kAxisCover * animal.size, [over, far](const Spot& spot) {
             return spot.region == BodyRegion::head ? spot.fat + over - spot.depth : far;
           }}};
}

std::vector<Bone> girdle_bones(const Animal& animal, double thickness) {
  std::vector<Bone> bones;
  if (animal.spine.empty() || animal.kind == BodyKind::many_legs) return bones;
  for (const JointLimb& limb : animal.chains.limbs) {
    if (!limb.is_left || limb.use == Use::none || limb.use == Use::fin) continue;
    const Girdle girdle(animal, limb, thickness);
    if (limb.use == Use::leg && girdle.is_hind()) {
      girdle.add_pelvis(bones);
    } else {
      girdle.add_shoulder_blade(bones);
    }
  }
  return bones;
}

}  // namespace bodyopt::trainer
