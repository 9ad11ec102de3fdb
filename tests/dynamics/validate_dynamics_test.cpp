#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "runtime/core/error.h"
#include "tests/support/small_dynamics.h"

namespace bodyopt::trainer {
namespace validate_dynamics_test {

using testing::small_dynamics;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Case {
  const char* named;  // what the message must contain
  std::function<void(Dynamics&)> change;
};

void expect_refused(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    Dynamics dynamics = small_dynamics().dynamics;
    c.change(dynamics);
    try {
      validate(dynamics, small_dynamics().basis, "here.safetensors");
      ADD_FAILURE() << "accepted: " << c.named;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind("here.safetensors: ", 0), 0u) << text;
      EXPECT_NE(text.find(c.named), std::string::npos) << "expected '" << c.named << "' in: " << text;
    }
  }
}

TEST(ValidateDynamics, WhatIsBuiltIsSound) {
  const auto& small = small_dynamics();
  EXPECT_NO_THROW(validate(small.dynamics, small.basis, "built"));
  EXPECT_LE(small.dynamics.tets.tet_count(), 600u);
  EXPECT_GT(small.dynamics.tets.node_count(), small.dynamics.tets.surface_count());
  EXPECT_GT(small.dynamics.diffuse.inverse.levels.size(), 0u);
  EXPECT_GT(small.dynamics.jiggle.inverse.levels.size(), 1u);
}

TEST(ValidateDynamics, Tets) {
  expect_refused({
      {"tets.nodes has", [](Dynamics& d) { d.tets.nodes.pop_back(); }},
      {"tets.nodes has 0", [](Dynamics& d) { d.tets.nodes.clear(); }},
      {"tets.nodes[5] is nan", [](Dynamics& d) { d.tets.nodes[5] = kNan; }},
      {"tets.tets has", [](Dynamics& d) { d.tets.tets.pop_back(); }},
      {"tets.tets[7] is 4294967295", [](Dynamics& d) { d.tets.tets[7] = ~0u; }},
      {"tets.shapes[3] is inf", [](Dynamics& d) { d.tets.shapes[3].inverse_edges[4] = kInfinity; }},
      {"tets.shapes[3] has a volume", [](Dynamics& d) { d.tets.shapes[3].volume = 0; }},
      {"tets.corner_begin has", [](Dynamics& d) { d.tets.corner_begin.pop_back(); }},
      {"tets.corner_begin[3]", [](Dynamics& d) { d.tets.corner_begin[2] = 100000; }},
      {"tets.corners does not list", [](Dynamics& d) { std::swap(d.tets.corners[0], d.tets.corners[1]); }},
      {"tets.corners does not list", [](Dynamics& d) { d.tets.corners[9] = ~0u; }},
      {"belongs to no tetrahedron",
       [](Dynamics& d) {
         d.tets.nodes.insert(d.tets.nodes.end(), 3, 0.0f);
         d.tets.corner_begin.push_back(d.tets.corner_begin.back());
       }},
      {"tets.surface has 0", [](Dynamics& d) { d.tets.surface.clear(); }},
      {"tets.surface[0] is 578", [](Dynamics& d) { d.tets.surface[4].a = 578; }},
      {"tets.surface[4] is nan", [](Dynamics& d) { d.tets.surface[4].wc = kNan; }},
      {"tets.surface[4] has weights", [](Dynamics& d) { d.tets.surface[4].wb += 0.01f; }},
      {"its skin stands elsewhere", [](Dynamics& d) { d.tets.nodes[3] += 0.01f; }},
      {"tets.skin has", [](Dynamics& d) { d.tets.skin.pop_back(); }},
      {"tets.skin[8] names tetrahedron", [](Dynamics& d) { d.tets.skin[8].tet = d.tets.tet_count(); }},
      {"tets.skin[8] has weights", [](Dynamics& d) { d.tets.skin[8].w3 += 0.5f; }},
      {"tets.skin[8] is nan", [](Dynamics& d) { d.tets.skin[8].amount = kNan; }},
      {"tets.skin[8] takes an amount", [](Dynamics& d) { d.tets.skin[8].amount = -1; }},
      {"tets.skin_limit has", [](Dynamics& d) { d.tets.skin_limit.pop_back(); }},
      {"tets.skin_limit[8] is", [](Dynamics& d) { d.tets.skin_limit[8] = kNan; }},
      {"tets.skin_limit[8] is", [](Dynamics& d) { d.tets.skin_limit[8] = 0; }},
  });
}

TEST(ValidateDynamics, Diffuse) {
  expect_refused({
      {"diffuse.row_begin has", [](Dynamics& d) { d.diffuse.row_begin.pop_back(); }},
      {"diffuse.row_begin ends", [](Dynamics& d) { d.diffuse.columns.push_back(0); }},
      {"diffuse.row_begin has entries for nodes on the skin",
       [](Dynamics& d) { d.diffuse.row_begin[d.tets.surface.size()] = 1; }},
      {"diffuse.columns[2] is", [](Dynamics& d) { d.diffuse.columns[2] = d.tets.surface_count(); }},
      {"diffuse.values has", [](Dynamics& d) { d.diffuse.values.pop_back(); }},
      {"diffuse.values[2] is inf", [](Dynamics& d) { d.diffuse.values[2] = kInfinity; }},
      // A node on the skin must not be solved for.
      {"diffuse.inverse.slot_unknown[0] is 0", [](Dynamics& d) { d.diffuse.inverse.slot_unknown[0] = 0; }},
  });
}

TEST(ValidateDynamics, BlockInverse) {
  const auto last_boundary = [](const BlockInverse& inverse) {
    for (std::size_t k = inverse.levels.size(); k-- > 0;) {
      if (inverse.levels[k].own_end < inverse.levels[k].end_slot) return inverse.levels[k].own_end;
    }
    return 0u;
  };
  const auto child = [](const BlockInverse& inverse) {  // index of the first that is there
    std::size_t k = 0;
    while (inverse.child_slots[k] == kNoSlot) ++k;
    return k;
  };
  expect_refused({
      {"is of 3 unknowns", [](Dynamics& d) { d.jiggle.inverse.unknown_count = 3; }},
      {"jiggle.inverse.levels[1] has ranges", [](Dynamics& d) { ++d.jiggle.inverse.levels[1].first_slot; }},
      {"jiggle.inverse.levels[0] has ranges", [](Dynamics& d) { d.jiggle.inverse.levels[0].own_end = ~0u; }},
      {"jiggle.inverse.levels[1] has ranges", [](Dynamics& d) { --d.jiggle.inverse.levels[1].up_begin; }},
      {"jiggle.inverse.levels[0] has ranges", [](Dynamics& d) { --d.jiggle.inverse.levels[0].down_begin; }},
      {"jiggle.inverse.up has", [](Dynamics& d) { ++d.jiggle.inverse.levels.back().up_end; }},
      {"jiggle.inverse.down has", [](Dynamics& d) { ++d.jiggle.inverse.levels.back().down_end; }},
      {"jiggle.inverse.slot_unknown has", [](Dynamics& d) { d.jiggle.inverse.levels.pop_back(); }},
      {"jiggle.inverse.slot_unknown[2] is 4294967295", [](Dynamics& d) { d.jiggle.inverse.slot_unknown[2] = ~0u; }},
      {"solved for, once", [](Dynamics& d) { d.jiggle.inverse.slot_unknown[2] = d.jiggle.inverse.slot_unknown[3]; }},
      {"that a level above solves",
       [&](Dynamics& d) {
         BlockInverse& inverse = d.jiggle.inverse;
         inverse.slot_unknown[last_boundary(inverse)] = inverse.slot_unknown[0];
       }},
      {"jiggle.inverse.child_slots has", [](Dynamics& d) { d.jiggle.inverse.child_slots.pop_back(); }},
      {"expected a slot of the same unknown",
       [&](Dynamics& d) { ++d.jiggle.inverse.child_slots[child(d.jiggle.inverse)]; }},
      {"expected a slot of the same unknown", [](Dynamics& d) { d.jiggle.inverse.child_slots[0] = 0; }},
      {"jiggle.inverse.up[1] has rows", [](Dynamics& d) { d.jiggle.inverse.up[1].row_count = 17; }},
      {"jiggle.inverse.up[1] has rows", [](Dynamics& d) { d.jiggle.inverse.up[1].row_count = 0; }},
      {"jiggle.inverse.up[1] has rows", [](Dynamics& d) { d.jiggle.inverse.up[1].first_slot = ~0u; }},
      {"jiggle.inverse.up[1] has rows", [](Dynamics& d) { d.jiggle.inverse.up[1].first_input = ~0u; }},
      {"jiggle.inverse.up[1] has rows", [](Dynamics& d) { d.jiggle.inverse.up[1].input_count = ~0u; }},
      {"jiggle.inverse.up[1] needs numbers", [](Dynamics& d) { d.jiggle.inverse.up[1].first_value = ~0u; }},
      {"once more", [](Dynamics& d) { d.jiggle.inverse.up[1].first_slot = d.jiggle.inverse.up[0].first_slot; }},
      {"jiggle.inverse.up gives", [](Dynamics& d) { --d.jiggle.inverse.up[0].row_count; }},
      {"jiggle.inverse.down gives", [](Dynamics& d) { --d.jiggle.inverse.down[0].row_count; }},
      {"jiggle.inverse.down[0] has rows",
       [](Dynamics& d) { d.jiggle.inverse.down[0].first_slot = d.jiggle.inverse.levels[0].own_end; }},
      {"jiggle.inverse.down[0] has rows", [](Dynamics& d) { d.jiggle.inverse.down[0].first_input = 0; }},
      {"jiggle.inverse.values[0] is nan", [](Dynamics& d) { d.jiggle.inverse.values[0] = kNan; }},
      {"jiggle.inverse.up[", [](Dynamics& d) { d.jiggle.inverse.values.resize(d.jiggle.inverse.values.size() / 2); }},
  });
}

TEST(ValidateDynamics, Jiggle) {
  expect_refused({
      {"jiggle.step has 0.0", [](Dynamics& d) { d.jiggle.step.frames_per_second = 0; }},
      {"jiggle.step has nan", [](Dynamics& d) { d.jiggle.step.frames_per_second = kNan; }},
      {"of 0 substeps", [](Dynamics& d) { d.jiggle.step.substeps = 0; }},
      {"of 1025 substeps", [](Dynamics& d) { d.jiggle.step.substeps = 1025; }},
      {"damping below 0", [](Dynamics& d) { d.jiggle.step.stiffness_damping = -1; }},
      {"jiggle.nodes has", [](Dynamics& d) { d.jiggle.nodes.pop_back(); }},
      {"jiggle.nodes[4] is nan", [](Dynamics& d) { d.jiggle.nodes[4].inertia = kNan; }},
      {"jiggle.nodes[4] has a number of -1", [](Dynamics& d) { d.jiggle.nodes[4].mass = -1; }},
      {"jiggle.nodes[4] has a number of -1", [](Dynamics& d) { d.jiggle.nodes[4].stiffening = -1; }},
      {"jiggle.nodes[4] is of fibres",
       [](Dynamics& d) {
         d.jiggle.nodes[4].first_fibre = ~0u;
         d.jiggle.nodes[4].fibre_count = 2;
       }},
      {"jiggle.nodes[4] is flexed by a control", [](Dynamics& d) { d.jiggle.nodes[4].control = 0; }},
      {"jiggle.springs has", [](Dynamics& d) { d.jiggle.springs.pop_back(); }},
      {"jiggle.springs[1] is inf", [](Dynamics& d) { d.jiggle.springs[1] = kInfinity; }},
  });
}

}  // namespace validate_dynamics_test
}  // namespace bodyopt::trainer
