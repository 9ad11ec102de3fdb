#include "trainer/dynamics/build_dynamics.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/simulate/limb.h"
#include "tests/support/on_threads.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

TEST(BuildDynamics, IsAFunctionOfItsArgumentsWhateverTheThreads) {
  const Character limb = make_limb();
  const Basis basis = build_ddm_basis(limb, {});
  const auto built = [&] { return build_dynamics(limb, {make_flexor()}, basis, {}).dynamics; };
  const Dynamics one = testing::on_threads(1, built), three = testing::on_threads(3, built);
  EXPECT_NO_THROW(validate(one, basis, "built"));
  EXPECT_EQ(one.tets.nodes, three.tets.nodes);
  EXPECT_EQ(one.tets.tets, three.tets.tets);
  EXPECT_EQ(one.diffuse.inverse.values, three.diffuse.inverse.values);
  EXPECT_EQ(one.jiggle.inverse.values, three.jiggle.inverse.values);
  EXPECT_EQ(one.jiggle.springs, three.jiggle.springs);
  EXPECT_EQ(one.metadata, three.metadata);
}

// Rest positions of the nodes come out of the diffuse tables, and skin of the tets, in the basis' own vertex order.
TEST(BuildDynamics, IsInTheBasisOrder) {
  const Character limb = make_limb();
  const Basis basis = build_ddm_basis(limb, {});
  const BuiltDynamics built = build_dynamics(limb, {}, basis, {});
  const TetTable& tets = built.dynamics.tets;
  ASSERT_EQ(tets.skin.size(), basis.mesh.vertex_count());
  for (std::size_t v = 0; v < tets.skin.size(); ++v) {
    const TetPoint& point = tets.skin[v];
    const float weights[4] = {point.w0, point.w1, point.w2, point.w3};
    for (std::size_t i = 0; i < 3; ++i) {
      float x = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        x += weights[a] * tets.nodes[3 * std::size_t{tets.tets[4 * std::size_t{point.tet} + a]} + i];
      }
      EXPECT_NEAR(x, basis.mesh.rest[3 * v + i], 1e-6f);
    }
  }
  EXPECT_TRUE(built.report.notes.empty());
}

// What reads the file finds what the caller was given.
TEST(BuildDynamics, ItsMetadataHoldWhatWasFound) {
  const Character limb = make_limb();
  DynamicsOptions options;
  options.settings.regions = {{JiggleRegion::By::joint, limb.skeleton.joints[1].name, 2.0}};
  const auto [dynamics, report, settings] = build_dynamics(limb, {}, build_ddm_basis(limb, {}), options);
  const auto told = [&metadata = dynamics.metadata](const char* key) { return Json::parse(metadata.at(key)); };
  EXPECT_EQ(told("report"), to_json(report));
  EXPECT_EQ(told("jiggle_settings"), jiggle_json(settings));
  EXPECT_EQ(report.tets, dynamics.tets.tet_count());
  EXPECT_EQ(report.surface_nodes, dynamics.tets.surface_count());
  EXPECT_GT(report.quality.worst, 0);
  EXPECT_LE(report.quality.worst, report.quality.first_percentile);
  EXPECT_GT(report.bone_springs, report.joints_with_bones);
}

TEST(BuildDynamics, AnotherCharactersBasisIsRefused) {
  const Character limb = make_limb();
  const Basis basis = build_ddm_basis(limb, {});
  const auto expect = [&](const char* named, const std::function<void(Character&)>& change) {
    Character other = limb;
    change(other);
    try {
      build_dynamics(other, {}, basis, {});
      ADD_FAILURE() << "accepted: " << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::mismatch);
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  };
  expect("triangles are others", [](Character& c) { c.triangles.row(0).reverseInPlace(); });
  expect("skeleton is another", [](Character& c) { c.skeleton.joints[1].name = "else"; });
  expect("stand elsewhere", [](Character& c) { c.vertices.rowwise() += Eigen::RowVector3d(0.01, 0, 0); });
}

// Before tets are looked for, of which there would be none so few.
// A skin that cannot be filled: where one has to look.
TEST(BuildDynamics, ARefusalNamesJointAndPlace) {
  Character sheet = make_limb();
  sheet.triangles = sheet.triangles.topRows(sheet.triangles.rows() / 2).eval();
  try {
    build_dynamics(sheet, {}, build_ddm_basis(sheet, {}), {});
    FAIL() << "filled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    const std::string said = error.what(), place = "; the skin is open at 'upper' (";
    ASSERT_NE(said.find(place), std::string::npos) << said;
    double x = -1, y = -1, z = -1;
    ASSERT_EQ(std::sscanf(said.c_str() + said.find(place) + place.size(), "%lf %lf %lf m)", &x, &y, &z), 3) << said;
    EXPECT_LT((sheet.vertices.rowwise() - Eigen::RowVector3d(x, y, z)).rowwise().norm().minCoeff(), 1e-3);
  }
}

TEST(BuildDynamics, NamesThatAreNotThereAreRefusedFirst) {
  const Character limb = make_limb();
  const Basis basis = build_ddm_basis(limb, {});
  DynamicsOptions options;
  options.resolution = 1;
  options.settings.regions = {{JiggleRegion::By::joint, "tail", 2.0}};
  try {
    build_dynamics(limb, {}, basis, options);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("the joint 'tail'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodyopt::trainer
