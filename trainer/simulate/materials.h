// The soft tissues, SI units. Orders of magnitude are those of quasi-static measurements of human fat and relaxed or
// contracted skeletal muscle (a few kPa of shear, tens to hundreds of kPa along active fibres); bulk stiffness is kept
// at ten to twenty times shear (Poisson's ratio 0.45 to 0.475), where linear tets do not lock visibly.
#pragma once

namespace bodyopt {

constexpr double kFatShear = 4e3;        // Pa
constexpr double kMuscleShear = 8e3;     // Pa
constexpr double kBulk = 8e4;            // Pa, first Lame parameter of both
constexpr double kActiveFibre = 1.6e5;   // Pa at full activation, per unit of stretch above kContracted
constexpr double kContracted = 0.7;      // stretch at which an active fibre stops pulling
constexpr double kPassiveFibre = 2e4;    // Pa per unit of stretch above rest length
constexpr double kBarrierStart = 0.3;    // volume ratio below which the barrier against inversion acts
constexpr double kBarrier = 2 * kBulk;   // Pa
constexpr double kBoneSpring = 4e3;       // N/m per attachment point: several times an element's own stiffness
constexpr double kFullyActiveAt = 0.15;  // shortening of a muscle's path at which its activation nears its maximum

}  // namespace bodyopt
