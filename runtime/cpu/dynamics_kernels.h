// The CPU path of diffuse and jiggle: one function per kernel, one file each; the reference for the Vulkan kernels.
// Arrays are frame-major over frame_count frames; shapes are those of runtime/basis/dynamics.h: V skin vertices, N
// nodes, B of them on the skin, T tets. Loops are spread over `threads`, with the same bits for any number of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/core/executor.h"
#include "shaders/include/layout.h"

namespace bodyopt {
struct BlockInverse;
struct InverseLevel;
struct DiffuseTable;
struct JiggleTable;
struct TetTable;
}  // namespace bodyopt

namespace bodyopt::cpu {

// Diffuse stage: the places of the nodes that lie on the skin, relative to the frame's origin. Takes positions F x V x
// 3 (world), origins F x 4 -> the first B of nodes F x N x 3; leaves others.
void diffuse_surface(const TetTable& tets, std::span<const float> positions, std::span<const float> origins,
                     std::uint32_t frame_count, std::span<float> nodes, Executor& threads = calling_thread());

// Diffuse stage: -L_IB X_B. Takes nodes F x N x 3 -> right_sides F x N x 3, of all nodes but the first B (left alone).
void diffuse_gather(const DiffuseTable& diffuse, std::uint32_t surface_count, std::span<const float> nodes,
                    std::uint32_t frame_count, std::span<float> right_sides, Executor& threads = calling_thread());

// Indexes the unknowns of one of many right sides, see below.
struct RightSide {
  RightSide(std::uint32_t number, std::uint32_t interleave, std::uint32_t unknown_count)
      : step(interleave), begin(std::size_t{number / interleave} * unknown_count * interleave + number % interleave) {}

  std::size_t operator()(std::uint32_t unknown) const { return begin + std::size_t{unknown} * step; }

  std::size_t step, begin;
};

// One level of a solve with R right sides. Unknown q of right side r stands at
//   (r / interleave) * unknown_count * interleave + q * interleave + r % interleave.
// An interleave of 3 puts x, y and z of a node side by side. gathered, results: R x slot_count.
//
// Up, first half: gathered = right side of own slots less what children hand up; of boundary slots what they hand up.
void block_gather(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> right_sides,
                  std::uint32_t right_side_count, std::uint32_t interleave, std::span<const float> results,
                  std::span<float> gathered, Executor& threads = calling_thread());
// Up, second half: results = P gathered at own slots; gathered + W^T gathered (of the own slots) at boundary slots.
void block_up(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> gathered,
              std::uint32_t right_side_count, std::span<float> results, Executor& threads = calling_thread());
// Down: solution at the unknowns of own slots = results - W times the solution at those of the boundary slots.
void block_down(const BlockInverse& inverse, const InverseLevel& level, std::span<const float> results,
                std::uint32_t right_side_count, std::uint32_t interleave, std::span<float> solutions,
                Executor& threads = calling_thread());

// All levels up, then down. scratch is resized as needed.
void block_solve(const BlockInverse& inverse, std::span<const float> right_sides, std::uint32_t right_side_count,
                 std::uint32_t interleave, std::vector<float>& scratch, std::span<float> solutions,
                 Executor& threads = calling_thread());

// Jiggle stage: the rotation of every node, that of the volume-weighted mean of the deformation gradients of its tets
// (F_e = D(X) D^-1). Takes nodes F x N x 3 -> rotations F x N x 9, row-major.
void jiggle_rotate(const TetTable& tets, std::span<const float> nodes, std::uint32_t frame_count,
                   std::span<float> rotations, Executor& threads = calling_thread());

// The state that a frame of the jiggle starts from. All in world axes, N x 3 each.
struct JiggleMotion {
  std::span<const float> displacement, velocity;  // u and du/dt, relative to the quasi-static nodes
  std::span<const float> nodes, node_velocity;    // X of the frame before, relative to its origin; its dX/dt
};
struct JiggleMotionOut {
  std::span<float> displacement, velocity, nodes, node_velocity;
};

// Jiggle stage, once a frame: the quasi-static nodes move in straight lines from frame to frame, and inertia changes
// velocities where they turn. V = (X - X_before + origin_step) / interval, du/dt -= V - V_before. As a splitting it is
// of second order (Hairer, Lubich, Wanner 2003, "kick"). X: `nodes` of this frame, N x 3. `kick.start`: 0, no frame
// before is known (u, du/dt and V become 0); 1, one is (V is found; no kick); 2, all are.
void jiggle_kick(const JiggleKickPush& kick, std::span<const float> nodes, const JiggleMotion& before,
                 const JiggleMotionOut& after, Executor& threads = calling_thread());

// Jiggle stage, begin of a step: turns u and v into the nodes' frames (R^T), where active muscles hold theirs. Implicit
// Euler kicks v by the muscle's springs, w2 = stiffening x activation:
//   v := (v - h w2 u) / (1 + h^2 w2).
// The right side of the first solve is velocity_weight m (v + d R^T g) + displacement_weight inertia u.
// The activation is clamp(-mean strain of the muscle's fibres / kFullActivationStrain, 0, 1). Of what is left the
// control's value (clamped to 0..1) is added. Takes strains S, controls C and rotations N x 9 of this frame.
void jiggle_begin(const JiggleTable& jiggle, const JiggleStepPush& step, std::span<const float> rotations,
                  std::span<const float> strains, std::span<const float> controls, std::span<const float> displacement,
                  std::span<const float> velocity, std::span<float> local_displacement, std::span<float> local_velocity,
                  std::span<float> right_side, Executor& threads = calling_thread());

// Jiggle stage, between the two solves of TR-BDF2. z: the first solution (3N). In the nodes' frames:
//   u' = u_from_u u + u_from_z z,   v' = v_from_u u + v_from_z z + v_from_v v.
// The right side is velocity_weight m (v' + d R^T g) + displacement_weight inertia u'.
void jiggle_advance(const JiggleTable& jiggle, const JiggleStepPush& step, std::span<const float> rotations,
                    std::span<const float> solution, std::span<const float> local_displacement,
                    std::span<const float> local_velocity, std::span<float> next_displacement,
                    std::span<float> next_velocity, std::span<float> right_side, Executor& threads = calling_thread());

// Jiggle stage, end of a step: u = R (u_from_u u + u_from_z z), v = R (v_from_u u + v_from_z z), world. Numbers below
// kStill become 0.
void jiggle_end(const JiggleStepPush& step, std::span<const float> rotations, std::span<const float> solution,
                std::span<const float> local_displacement, std::span<float> displacement, std::span<float> velocity,
                Executor& threads = calling_thread());

// Jiggle stage: the skin follows: x + weight x amount x what its tet has of u. It is cut where it nears the vertex'
// limit (limited_share in shaders/include/jiggle.h). A vertex whose amount is 0 keeps its bits. Takes positions V x 3,
// displacement N x 3 -> moved V x 3.
void jiggle_skin(const TetTable& tets, std::span<const float> positions, std::span<const float> displacement,
                 float weight, std::span<float> moved, Executor& threads = calling_thread());

}  // namespace bodyopt::cpu
