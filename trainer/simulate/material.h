// Constants of the tissue, in one place. SI units: pascals, metres.
//
// Passive soft tissue under large, slow strain is a few to some tens of kilopascals stiff: fat softer than relaxed
// muscle (elastography: Wells & Liang 2011, "Medical ultrasound: imaging of soft tissue strain and elasticity"). A body
// is nearly incompressible; linear tetrahedra lock long before its true bulk modulus, so lambda is held at 10 to 20 mu
// (Poisson 0.45 to 0.475): volume then changes by about one percent.
#pragma once

namespace bodyopt {

struct TetMaterial {
  double mu = 0;      // shear modulus, Pa
  double lambda = 0;  // Lamé's first parameter, Pa
};

constexpr TetMaterial kFat{4e3, 80e3};
constexpr TetMaterial kMuscle{8e3, 80e3};

// What holds the volume of a muscle as a whole: active fibres squeeze it with up to a third of their stress.
constexpr double kMuscleBulk = 3e6;  // Pa

// Active fibres pull with activation x kActiveStiffness x (stretch - kActiveSlack). Full activation at rest length
// then is 180 kPa; maximal isometric muscle reaches about 250 kPa (Zajac 1989, "Muscle and tendon").
constexpr double kActiveStiffness = 600e3;  // Pa
constexpr double kActiveSlack = 0.7;        // stretch below which a fibre cannot shorten further by itself

// Relaxed fibres resist stretch beyond rest length (titin and connective tissue).
constexpr double kPassiveFibreStiffness = 20e3;  // Pa

// A tet compressed below this share of its volume is pushed back by a logarithmic barrier (kappa = 2 lambda) that no
// step can cross: J <= 0 has infinite energy.
constexpr double kBarrierVolume = 0.3;
constexpr double kBarrierWeight = 2;  // x lambda

// Bones hold the tissue inside them by springs, newtons per metre per cubic metre of bone: an arm bone of 0.16 litres
// pulled by 50 N gives way 0.3 mm.
constexpr double kBoneStiffness = 1e9;  // N/m^4

// Bending stiffness of skin and superficial fascia: E t^3 / (12 (1 - nu^2)) of 5 mm at 300 kPa; what skin measures
// depends on the method over orders of magnitude (Pailler-Mattei et al. 2008). It keeps wrinkles from being as short as
// the mesh allows.
constexpr double kSkinBending = 4e-3;  // N m

// Skin that has passed through skin by a depth is pushed back by a pressure of stiffness x depth (1 + depth / reach):
// 20 kPa at 2 mm, 88 kPa at 5 mm.
constexpr double kContactStiffness = 5e6;  // Pa/m
constexpr double kContactReach = 2e-3;     // m

}  // namespace bodyopt
