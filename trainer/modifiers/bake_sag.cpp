// Sag: how far soft parts hang by the dynamics' tables, for a difference of gravity along each axis of every joint.
#include <algorithm>

#include "base/json_file.h"
#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"

namespace bodyopt::trainer {
namespace {

constexpr double kGravity = 9.81;    // m/s^2
constexpr double kLeastHang = 1e-4;  // metres that the skin of a joint must hang for it to be listened to
constexpr float kSettled = 1e-3f;    // change of a step over the largest displacement
constexpr int kMostSteps = 2000;

// Solves K u = M g. The dynamics have only the inverse of A = inertia + b K. Implicit steps without momentum end there:
// A u' = inertia u + b M g. `settled`: whether they did.
std::vector<float> hanging(const Dynamics& dynamics, int axis, bool& settled) {
  const std::size_t numbers = dynamics.tets.nodes.size();
  const double stage = dynamics.jiggle.step.stage();
  const auto b = static_cast<float>(1 + dynamics.jiggle.step.stiffness_damping / stage);
  std::vector<float> u(numbers, 0.0f), right_side(numbers), next(numbers), scratch;
  for (int step = 0; step < kMostSteps; ++step) {
    for (std::size_t n = 0; n < dynamics.jiggle.nodes.size(); ++n) {
      const JiggleNode& node = dynamics.jiggle.nodes[n];
      for (std::size_t i = 0; i < 3; ++i) right_side[3 * n + i] = node.inertia * u[3 * n + i];
      right_side[3 * n + static_cast<std::size_t>(axis)] += b * node.mass * static_cast<float>(kGravity);
    }
    cpu::block_solve(dynamics.jiggle.inverse, right_side, 1, 1, scratch, next);
    float change = 0, largest = 0;
    for (std::size_t k = 0; k < numbers; ++k) {
      change = std::max(change, std::abs(next[k] - u[k]));
      largest = std::max(largest, std::abs(next[k]));
    }
    u.swap(next);
    if (change <= kSettled * largest) return u;
  }
  settled = false;
  return u;
}

// V x 3: of the skin, as far as it goes with its tets, however far.
Positions hanging_skin(const Basis& basis, Dynamics& dynamics, int axis, bool& settled) {
  std::ranges::fill(dynamics.tets.skin_limit, kNoLimit);
  std::vector<float> moved(basis.mesh.rest.size());
  cpu::jiggle_skin(dynamics.tets, basis.mesh.rest, hanging(dynamics, axis, settled), 1, moved);
  return rows_of(moved) - rows_of(basis.mesh.rest);
}

}  // namespace

// joints, components: see runtime/modifiers/drive_sag.cpp.
BakedModifier bake_sag(const BakeInput& input) {
  Dynamics dynamics = load_dynamics(input.folder / input.parameters.name("dynamics"), input.basis);
  std::vector<Positions> fields;
  bool settled = true;
  for (int axis = 0; axis < 3; ++axis) fields.push_back(hanging_skin(input.basis, dynamics, axis, settled));
  if (!settled) {
    input.notes.push_back(input.place + ": so soft that it did not come to rest in " + std::to_string(kMostSteps) +
                          " steps, and hangs less than it would");
  }
  BakedModifier baked;
  for (std::uint32_t joint = 0; joint < input.basis.skeleton.size(); ++joint) {
    std::vector<char> chosen(input.basis.skeleton.size(), 0);
    chosen[joint] = 1;
    const Eigen::VectorXd share = held_by(input.basis, chosen);
    std::vector<Positions> own;
    double most = 0;
    for (const Positions& field : fields) {
      own.emplace_back(share.asDiagonal() * field);
      most = std::max(most, own.back().rowwise().norm().maxCoeff());
    }
    if (most < kLeastHang) continue;
    baked.joints.push_back(joint);
    std::ranges::move(own, std::back_inserter(baked.components));
  }
  if (baked.joints.empty()) {
    throw Error(ErrorKind::mismatch, input.place,
                ": no skin hangs by a tenth of a millimetre: its dynamics have no soft parts; "
                "'bodyopt dynamics' makes softer ones");
  }
  return baked;
}

}  // namespace bodyopt::trainer
