#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "trainer/anatomy/human_bones.h"
#include "trainer/anatomy/shapes.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

constexpr double kHipAside = 83.5;  // millimetres from the median plane, in the model the landmarks are from
constexpr double kWidest = 1.15;    // a rig's hips may lie farther apart than a pelvis is wide

struct PelvisPlaces {
  Vector3d asis, psis, crest, ischium, pubis, sacrum, sacrum_middle, coccyx, aiis, socket;
};

// Forward, up, outwards of the hip's centre, after the pelvis of gait2392 (Delp et al. 1990) and by eye; what lies
// inwards follows how far apart the rig's hips are.
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

}  // namespace

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

}  // namespace bodyopt
