// Materials of the tissue. SI units: pascals, metres. rigs/materials.json says where the defaults come from.
#pragma once

#include <filesystem>

namespace bodyopt::trainer {

// Stable neo-Hookean. A body is nearly incompressible, but linear tetrahedra lock long before its true bulk modulus.
// Lambda of 10 to 20 mu (Poisson's ratio 0.45 to 0.475) lets volume change by about one percent.
struct TetMaterial {
  double mu = 0;      // shear modulus, Pa
  double lambda = 0;  // Lamé's first parameter, Pa
};

struct Materials {
  TetMaterial fat{4e3, 80e3};
  TetMaterial muscle{8e3, 80e3};  // and other lean tissue
  TetMaterial cavity{1e3, 80e3};  // of chest and belly: soft, and nearly as incompressible as what is around it
  // Holds the volume of a muscle as a whole: active fibres squeeze it with up to a third of their stress.
  double muscle_bulk = 3e6;  // Pa
  // Active fibres pull with activation x stiffness x (stretch - slack). They shorten to the slack that bones, joints
  // and tendons leave them (FibreDrive), and never below the least.
  double active_fibre = 600e3;  // Pa
  double active_slack = 0.7;    // stretch, the least
  double passive_fibre = 20e3;  // Pa, beyond rest length
  // Bones hold the tissue inside them by springs: an arm bone of 0.16 litres pulled by 50 N gives way 1 mm. Stiffer
  // ones take up to twice the iterations.
  double bone_springs = 3e8;  // N/m per cubic metre of bone
  // Keeps wrinkles from being as short as the mesh allows.
  double skin_bending = 4e-3;  // N m
  // Skin that has passed through skin by a depth is pushed back by a pressure of stiffness x depth (1 + depth / 2 mm).
  double contact = 5e6;  // Pa/m
};

// materials.json (docs/formats.md). What the file leaves out keeps its default. Throws Error(file).
Materials read_materials(const std::filesystem::path& path);

}  // namespace bodyopt::trainer
