// What the tissue is made of. SI units: pascals, metres. rigs/materials.json says where the defaults come from.
#pragma once

#include <filesystem>

namespace bodyopt {

// Stable neo-Hookean. A body is nearly incompressible, but linear tetrahedra lock long before its true bulk modulus:
// lambda of 10 to 20 mu (Poisson 0.45 to 0.475) lets volume change by about one percent.
struct TetMaterial {
  double mu = 0;      // shear modulus, Pa
  double lambda = 0;  // Lamé's first parameter, Pa
};

struct Materials {
  TetMaterial fat{4e3, 80e3};
  TetMaterial muscle{8e3, 80e3};
  // Holds the volume of a muscle as a whole: active fibres squeeze it with up to a third of their stress.
  double muscle_bulk = 3e6;  // Pa
  // Active fibres pull with activation x stiffness x (stretch - slack): beyond slack a fibre does not shorten by
  // itself.
  double active_fibre = 600e3;  // Pa
  double active_slack = 0.7;    // stretch
  double passive_fibre = 20e3;  // Pa, beyond rest length
  // Bones hold the tissue inside them by springs: an arm bone of 0.16 litres pulled by 50 N gives way 0.3 mm.
  double bone_springs = 1e9;  // N/m per cubic metre of bone
  // Keeps wrinkles from being as short as the mesh allows.
  double skin_bending = 4e-3;  // N m
  // Skin that has passed through skin by a depth is pushed back by a pressure of stiffness x depth (1 + depth / 2 mm).
  double contact = 5e6;  // Pa/m
};

// materials.json (docs/formats.md). What the file leaves out keeps its default. Throws Error(file).
Materials read_materials(const std::filesystem::path& path);

}  // namespace bodyopt
