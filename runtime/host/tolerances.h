// How far a device may be from the CPU. The tests of the kernels use it, and the check while it runs
// (runtime/deformer/checked_backend.h).
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "runtime/host/stages.h"

namespace bodyopt {

// The tolerance of one output of a kernel, on the same inputs: absolute + relative x |the reference|, in its unit. Sums
// and products stand in one order and are not contracted: they have the same bits everywhere. Other operations may be
// off by units in the last place, ulp, of 1.2e-7 at most (Vulkan, "Precision and Operation of SPIR-V Instructions"). A
// quotient may be off by 2.5 ulp, a root by 2 + that, an exponential by 3 + 2 |x|.
struct KernelTolerance {
  std::string_view kernel;
  std::size_t output;
  double absolute = 0, relative = 0;
};

inline constexpr std::array kKernelTolerances = {
    KernelTolerance{"strain_skin", 0, 1e-6},           // m: as pose_skin, without its origin
    KernelTolerance{"strain_measure", 0, 1e-6, 1e-6},  // roots of segments and a quotient, of the order of 1
    KernelTolerance{"residual_features", 0},
    KernelTolerance{"residual_features", 1},
    KernelTolerance{"residual_project", 0},
    KernelTolerance{"residual_kernels", 0, 5e-7},  // an exponential: (3 + 2 x) ulp of e^-x are at most 4 ulp of 1
    KernelTolerance{"residual_coefficients", 0},
    KernelTolerance{"residual_blend", 0},
    KernelTolerance{"modify_blend", 0},
    // m: 1e-6 by the rotation's quotients and roots on an offset of centimetres, and by roundings of metres that
    // follow. Then the origin is rounded.
    KernelTolerance{"pose_skin", 0, 1e-6, 1.2e-7},
    KernelTolerance{"diffuse_surface", 0},
    KernelTolerance{"diffuse_gather", 0},
    KernelTolerance{"block_gather", 0},
    KernelTolerance{"block_up", 0},
    KernelTolerance{"block_down", 0},
    KernelTolerance{"jiggle_rotate", 0, 4e-6},  // a rotation's numbers: quotients and roots, one after the other
    KernelTolerance{"jiggle_kick", 0},
    KernelTolerance{"jiggle_begin", 0},
    KernelTolerance{"jiggle_begin", 1, 1e-5},  // of the order of 10 m/s: quotients
    KernelTolerance{"jiggle_begin", 2, 1e-4},  // as the velocity, times up to 4
    KernelTolerance{"jiggle_advance", 0},
    KernelTolerance{"jiggle_advance", 1},
    KernelTolerance{"jiggle_advance", 2},
    KernelTolerance{"jiggle_end", 0},
    KernelTolerance{"jiggle_skin", 0, 1e-7},   // m, of decimetres: a root and a quotient
    KernelTolerance{"output_relax", 0, 3e-6},  // m, of a box of 3 m a millionth: quotients and roots of areas
    KernelTolerance{"output_bound", 0},
    KernelTolerance{"output_separate", 0, 3e-6},  // m, as output_relax
    KernelTolerance{"output_normals", 0, 1e-6},   // a root and a quotient, of 1
    // 1 is the unit: roots and quotients, ten times as much where a triangle's tangent stands that near to the normal.
    // An angle's error is the cosine's over its sine.
    KernelTolerance{"output_tangents", 0, 1e-5},
    KernelTolerance{"output_place", 0},
    KernelTolerance{"output_stretch", 0, 1e-6},       // of 1: a root and a quotient
    KernelTolerance{"output_anchor", 0, 4e-6, 1e-7},  // a rotation's numbers, as jiggle_rotate
    KernelTolerance{"output_attach", 0},
};

// The tolerance of what a stage leaves behind after all stages before it ran there, too: their errors add up and grow.
// It is absolute + of_size x the diagonal of the rest skin + of_largest x the CPU's largest magnitude (1 at least).
struct StageTolerance {
  Stage stage;
  std::string_view output;
  double absolute = 0, of_size = 0, of_largest = 0;
};

inline constexpr double kPlace = 1e-5;  // of_size: as whole frames are held to; 1e-6 m of a kernel, of a person's 2 m

inline constexpr std::array kStageTolerances = {
    StageTolerance{Stage::strain, "strains", 1e-5},  // a place's error over a rest length of a decimetre
    // Strains, divided by their spread in training; what kernels make of that.
    StageTolerance{Stage::residual, "excess", 0, 0, 1e-3}, StageTolerance{Stage::residual, "coefficients", 0, 0, 1e-3},
    StageTolerance{Stage::pose, "posed", 0, kPlace}, StageTolerance{Stage::diffuse, "nodes", 0, kPlace},
    StageTolerance{Stage::jiggle, "displacement", 0, kPlace}, StageTolerance{Stage::jiggle, "positions", 0, kPlace},
    StageTolerance{Stage::output, "positions", 0, kPlace},
    StageTolerance{Stage::output, "tangents", 2e-2},  // as normals
    StageTolerance{Stage::output, "normals", 2e-2},   // a place's error over the edge of a small triangle
};

// A tolerance that is not in the table does not compile.
consteval StageTolerance tolerance_of(Stage stage, std::string_view output) {
  for (const StageTolerance& tolerance : kStageTolerances) {
    if (tolerance.stage == stage && tolerance.output == output) return tolerance;
  }
  throw "no such tolerance";
}

}  // namespace bodyopt
