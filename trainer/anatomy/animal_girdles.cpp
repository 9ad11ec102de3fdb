#include <Eigen/Geometry>
#include <cmath>

#include "trainer/anatomy/animal.h"
#include "trainer/anatomy/shapes.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;
using Use = JointLimb::Use;

// Shares of the body's size.
constexpr double kPlate = 0.0028, kGirdleCover = 0.002;

// Plates from a limb's socket to the spine, told along the body, to the back, and out of the median plane.
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

  // Of a limb that has a joint at the blade's upper end, from there; otherwise to below the back.
  void add_shoulder_blade(std::vector<Bone>& bones) const {
    const Vector3d& socket = animal_.place(socket_);
    const bool has_joint = socket_ != front_ && is_named(animal_.name(front_), {"scapula"});
    const double x = std::abs(socket.x());
    const Vector3d top = has_joint ? animal_.place(front_) : corner(0, 0.5, 0.45 * x);
    const Vector3d behind = has_joint ? Vector3d(top - 0.14 * trunk_ * section_.forward) : corner(-0.16, 0.4, 0.5 * x);
    add(socket_ == front_ ? section_.joint : front_, socket, top, behind, bones);
  }

 private:
  // Where a limb's first long bone begins.
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

}  // namespace bodyopt
