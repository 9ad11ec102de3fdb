// Simulation in a cage: drafts, and skins that no conforming tets fill.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/shape_reader.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "tests/builtin/shared_arm.h"
#include "tests/simulate/limb.h"
#include "tests/simulate/one_take.h"
#include "tests/support/shared_data.h"
#include "tests/support/stand_in_human.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/simulate/quasi_static.h"
#include "trainer/simulate/simulate.h"
#include "trainer/tets/cage.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/second_order.h"

namespace bodyopt::trainer {
namespace {

QuasiStaticBody caged(const Character& character, const std::vector<Muscle>& muscles, Eigen::Index nodes) {
  const AnatomyOptions coarse{.cell = 2 * default_cell(character)};
  return {character, muscles, look_inside(character, muscles, {.anatomy = coarse}),
          make_cage(character.vertices, character.triangles, character.weights, {nodes, 0, 0, nodes})};
}

double rms(const Positions& a, const Positions& b) { return std::sqrt((a - b).rowwise().squaredNorm().mean()); }

Clip bend(const Character& limb, int frames) {
  Clip clip;
  clip.name = "bend";
  clip.first_frame = 1;
  for (int k = 0; k < frames; ++k) clip.poses.push_back(bent(limb, degrees(25.0 * k)));
  return clip;
}

TEST(CageBody, BindPoseIsTheRestSkin) {
  const Character& character = arm().character;
  const QuasiStaticBody body = caged(character, arm().muscles, 1500);
  const SolvedPose solved = body.solve(bind_pose(character.skeleton));
  EXPECT_TRUE(solved.status.converged);
  EXPECT_LT((body.skin(solved.nodes) - character.vertices).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CageBody, ADraftIsNearTheFullShape) {
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{make_flexor()};
  const QuasiStaticBody full = own_body(limb, muscles, 0.05, kLimbAnatomy), draft = caged(limb, muscles, 1500),
                        coarse = caged(limb, muscles, 200);
  const Pose pose = bent(limb, degrees(70));
  const SolvedPose a = full.solve(pose), b = draft.solve(pose), c = coarse.solve(pose);
  EXPECT_TRUE(b.status.converged);
  EXPECT_TRUE(c.status.converged);
  EXPECT_LT(rms(full.skin(a.nodes), draft.skin(b.nodes)), 0.004);
  EXPECT_LT(rms(full.skin(a.nodes), coarse.skin(c.nodes)), 0.008);
  // And nearer to it than the skinning it starts from.
  Positions skinned(limb.vertices.rows(), 3);
  const std::vector<Affine> skinning = skinning_matrices(limb.skeleton, pose.joints);
  for (Eigen::Index v = 0; v < skinned.rows(); ++v) {
    Vec3 sum{0, 0, 0};
    for (const JointWeight& w : limb.weights[static_cast<std::size_t>(v)]) {
      sum = sum + w.weight * (skinning[w.joint] * Vec3{limb.vertices(v, 0), limb.vertices(v, 1), limb.vertices(v, 2)});
    }
    skinned.row(v) << sum[0], sum[1], sum[2];
  }
  EXPECT_LT(rms(full.skin(a.nodes), draft.skin(b.nodes)), 0.5 * rms(full.skin(a.nodes), skinned));
}

// Of second order in a coarser skin.
QuasiStaticBody quadratic(const Character& character, const std::vector<Muscle>& muscles, Eigen::Index nodes,
                          bool walks) {
  const Cage cage = filled_cage(character.vertices, character.triangles, character.weights, nodes);
  const AnatomyOptions coarse{.cell = 2 * default_cell(character)};
  const AnatomyField anatomy(character, muscles, coarse);
  QuasiStaticBody body(character, muscles, anatomy, second_order(cage));
  if (walks) body.walk_in(std::make_unique<QuasiStaticBody>(character, muscles, anatomy, cage));
  return body;
}

TEST(CageBody, WalksToTheShapeThatTheOwnTetsWalkTo) {
  const Character limb = make_limb();
  const QuasiStaticBody own = quadratic(limb, {make_flexor()}, 150, false),
                        nested = quadratic(limb, {make_flexor()}, 150, true);
  EXPECT_NE(nested.hash(), own.hash());
  for (const double turn : {40.0, 80.0}) {
    const Pose pose = bent(limb, degrees(turn));
    const SolvedPose a = own.solve(pose), b = nested.solve(pose);
    EXPECT_TRUE(b.status.converged);
    EXPECT_NE(a.nodes, b.nodes);
    EXPECT_LT((a.nodes - b.nodes).rowwise().norm().maxCoeff(), 2e-5);
  }
  // So few linear tets lie deeper in each other than their contact can tell.
  const QuasiStaticBody coarse = quadratic(limb, {make_flexor()}, 30, false),
                        nested_coarse = quadratic(limb, {make_flexor()}, 30, true);
  const Pose folded = bent(limb, degrees(150)), bent_little = bent(limb, degrees(40));
  EXPECT_EQ(coarse.solve(folded).nodes, nested_coarse.solve(folded).nodes);
  EXPECT_NE(coarse.solve(bent_little).nodes, nested_coarse.solve(bent_little).nodes);
}

TEST(CageBody, AFrameThatTakesTooLongIsGivenUp) {
  const Character limb = make_limb();
  const auto solve = [&](int most) {
    QuasiStaticBody body = quadratic(limb, {make_flexor()}, 150, false);
    body.give_up_after(most);
    return body.solve(bent(limb, degrees(80)));
  };
  const SolvedPose solved = quadratic(limb, {make_flexor()}, 150, false).solve(bent(limb, degrees(80)));
  const int taken = solved.status.iterations;
  const SolvedPose same = solve(taken + 1), given_up = solve(taken);
  EXPECT_TRUE(same.status.converged);
  EXPECT_EQ(same.nodes, solved.nodes);
  EXPECT_FALSE(given_up.status.converged);
  EXPECT_EQ(given_up.status.iterations, taken);
  EXPECT_TRUE(std::isinf(given_up.status.residual));
  EXPECT_TRUE(given_up.nodes.allFinite());
}

// Against tets a good deal finer.
TEST(CageBody, TellsHowFarFinerTetsWouldMoveTheSkin) {
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{make_flexor()};
  QuasiStaticBody body = quadratic(limb, muscles, 120, true);
  const Pose pose = bent(limb, degrees(60));
  const Positions skin = body.skin(body.solve(pose).nodes);
  EXPECT_TRUE(std::isnan(body.discretisation_error(pose, {}, skin)));
  body.compare_with(std::make_unique<QuasiStaticBody>(quadratic(limb, muscles, 60, true)));
  const QuasiStaticBody fine = quadratic(limb, muscles, 600, true);
  const double found = body.discretisation_error(pose, {}, skin),
               expected = rms(skin, fine.skin(fine.solve(pose).nodes));
  EXPECT_GT(found, 0.4 * expected);
  EXPECT_LT(found, 2.5 * expected);
}

// What is simulated is the body, not its tets: half as many and twice as many give the same shape.
TEST(CageBody, TheShapeHangsLittleOnTheSizeOfTets) {
  const Pose pose = arm_heldout(arm().character.skeleton, 144).poses[35];
  const auto skin = [&](Eigen::Index nodes) {
    const QuasiStaticBody body = quadratic(arm().character, arm().muscles, nodes, true);
    const SolvedPose solved = body.solve(pose);
    EXPECT_TRUE(solved.status.converged);
    return body.skin(solved.nodes);
  };
  EXPECT_LT(rms(skin(2000), skin(4000)), 0.5e-3);
}

// Tet by tet: flesh of these materials gives way a little, where bone presses it most.
TEST(CageBody, VolumeIsKeptEverywhere) {
  const Character limb = make_limb();
  const QuasiStaticBody body = quadratic(limb, {make_flexor()}, 300, true);
  const SolvedPose solved = body.solve(bent(limb, degrees(60)));
  const TetMesh posed{solved.nodes, body.mesh().tets};
  std::vector<double> changes;
  for (Eigen::Index t = 0; t < posed.tets.rows(); t += 8) {
    double now = 0, rest = 0;
    for (Eigen::Index eighth = t; eighth < t + 8; ++eighth) {
      now += tet_edges(posed, eighth).determinant();
      rest += tet_edges(body.mesh(), eighth).determinant();
    }
    changes.push_back(std::abs(now / rest - 1));
  }
  std::sort(changes.begin(), changes.end());
  EXPECT_LT(changes[changes.size() * 9 / 10], 0.025);
  EXPECT_LT(changes[changes.size() * 99 / 100], 0.075);
}

// The points at which tets of second order are summed do not see their corners, which contact and large bends push
// through tets as large as these.
TEST(CageBody, NoEighthOfALargeTetTurnsOver) {
  const Character limb = make_limb();
  const QuasiStaticBody body = quadratic(limb, {make_flexor()}, 60, true);
  for (const double turn : {90.0, 110.0, 130.0}) {
    const SolvedPose solved = body.solve(bent(limb, degrees(turn)));
    EXPECT_TRUE(solved.status.converged) << turn;
    const TetMesh posed{solved.nodes, body.mesh().tets};
    int turned_over = 0;
    for (Eigen::Index t = 0; t < posed.tets.rows(); ++t) turned_over += tet_edges(posed, t).determinant() <= 0 ? 1 : 0;
    EXPECT_EQ(turned_over, 0) << turn;
  }
}

TEST(CageBody, HashTellsSkinsInOneCageApart) {
  Character limb = make_limb();
  const auto hash = [&] {
    return QuasiStaticBody(limb, {}, AnatomyField(limb, {}, kLimbAnatomy),
                           lattice_cage(limb.vertices, limb.triangles, limb.weights, 200))
        .hash();
  };
  const std::uint64_t before = hash();
  EXPECT_EQ(hash(), before);
  limb.vertices(40, 1) += 1e-6;
  EXPECT_NE(hash(), before);
}

// Skin is pushed out of skin in both kinds of cage.
TEST(CageBody, FoldsOfADraftAreHeldApart) {
  const Character limb = make_limb();
  const Pose pose = bent(limb, degrees(140));
  const AnatomyField anatomy(limb, {}, kLimbAnatomy);
  const QuasiStaticBody filled(limb, {}, anatomy, skin_cage(limb.vertices, limb.triangles, 400)),
      lattice(limb, {}, anatomy, lattice_cage(limb.vertices, limb.triangles, limb.weights, 400));
  Materials soft;
  soft.contact = 1;  // as good as none
  const Cage cage = lattice_cage(limb.vertices, limb.triangles, limb.weights, 400);
  EXPECT_GT(QuasiStaticBody(limb, {}, anatomy, cage, soft).solve(pose).status.contact_depth, 0.01);
  for (const QuasiStaticBody* body : {&filled, &lattice}) {
    const FrameStatus status = body->solve(pose).status;
    EXPECT_TRUE(status.converged);
    EXPECT_LT(status.contact_depth, 2e-3);
  }
}

TEST(CageBody, SimulateStoresADraftAsNodes) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  const Clip clip = bend(limb, 3);
  const SimulateOptions options{.threads = 1, .draft = true, .anatomy = kLimbAnatomy};
  const std::vector<FrameStatus> status =
      simulate_one_take(limb, {make_flexor()}, clip, {1, 3}, folder / "take.nodes", folder / "take.json", options);
  ASSERT_EQ(status.size(), 2u);
  for (const FrameStatus& frame : status) EXPECT_TRUE(frame.converged);
  const ShapeReader shapes(folder / "take.nodes");
  ASSERT_EQ(shapes.point_count(), limb.output_count());
  ASSERT_EQ(shapes.sample_count(), 2u);
  EXPECT_LE(NodesReader(folder / "take.nodes").node_count(), 1500);
  const QuasiStaticBody body = make_body(limb, {make_flexor()}, options);
  for (const std::uint32_t k : {0u, 1u}) {
    const Positions expected = body.skin(body.solve(clip.poses[2 * k]).nodes);
    const Positions found = welded_from_output(limb, shapes.sample(k).data());
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 0.5 / 65535 + 1e-6);
  }
  // Frames of a finished draft are taken over, not solved again, and lose nothing by it.
  const std::vector<FrameStatus> again =
      simulate_one_take(limb, {make_flexor()}, clip, {3, 1}, folder / "take.nodes", folder / "take.json", options);
  const ShapeReader turned(folder / "take.nodes");
  for (const std::uint32_t k : {0u, 1u}) {
    EXPECT_EQ(turned.sample(k), shapes.sample(1 - k));
    EXPECT_EQ(again[k].seconds, status[1 - k].seconds);
  }
}

TEST(CageBody, SkinsWithHolesAreMendedAndSaid) {
  const TemporaryFolder folder;
  Character limb = make_limb();
  limb.triangles = limb.triangles.topRows(limb.triangles.rows() - 3).eval();
  std::string warning;
  SimulateOptions options{.tet_size = 0.03, .threads = 1, .anatomy = kLimbAnatomy};
  options.warn = [&](const std::string& text) { warning += text; };
  const std::vector<FrameStatus> status = simulate_one_take(limb, {make_flexor()}, bend(limb, 3), {1, 2, 3},
                                                            folder / "take.pc2", folder / "take.json", options);
  EXPECT_NE(warning.find("holes filled with"), std::string::npos) << warning;
  for (const FrameStatus& frame : status) EXPECT_TRUE(frame.converged);
  const QuasiStaticBody full = own_body(make_limb(), {make_flexor()}, 0.05, kLimbAnatomy);
  const Positions expected = full.skin(full.solve(bent(limb, degrees(50))).nodes);
  const Positions found = welded_from_output(limb, ShapeReader(folder / "take.pc2").sample(2).data());
  EXPECT_LT(rms(found, expected), 0.003);
}

// And at rest.
void expect_poses(const Character& character, const std::vector<Pose>& poses, const std::string& name) {
  const QuasiStaticBody body = caged(character, {}, 800);
  const SolvedPose rest = body.solve(bind_pose(character.skeleton));
  EXPECT_LT(rest.status.residual, 1e-3) << name;
  EXPECT_LT((body.skin(rest.nodes) - character.vertices).cwiseAbs().maxCoeff(), 1e-6) << name;
  for (const Pose& pose : poses) {
    const SolvedPose solved = body.solve(pose);
    EXPECT_TRUE(solved.nodes.allFinite()) << name;
    EXPECT_TRUE(solved.status.converged) << name << " " << solved.status.residual;
  }
}

// Every child joint, by 20 degrees.
Pose turned_joints(const Skeleton& skeleton) {
  Pose pose = bind_pose(skeleton);
  for (std::size_t j = 1; j < pose.joints.size(); ++j) {
    pose.joints[j].rotation = pose.joints[j].rotation * axis_angle({0, 0, 1}, degrees(20));
  }
  return pose;
}

// Springs of bones, in newtons per metre and cubic metre, know no size.
TEST(CageBody, AGiantDeformsAsAHumanDoes) {
  const auto posed = [](double size) {
    Character limb = make_limb();
    limb.vertices *= size;
    for (Joint& joint : limb.skeleton.joints) {
      for (double& x : joint.bind.translation) x *= size;
      joint.default_local = joint.bind;
      for (auto& row : joint.inverse_bind.m) row[3] *= size;
    }
    const QuasiStaticBody body(limb, {}, look_inside(limb, {}, {.anatomy = {.cell = size * kLimbAnatomy.cell}}),
                               make_cage(limb.vertices, limb.triangles, limb.weights, {400, 0, 0, 400}));
    const SolvedPose solved = body.solve(bent(limb, degrees(60)));
    EXPECT_TRUE(solved.status.converged) << size;
    return Positions(body.skin(solved.nodes) / size);
  };
  // Litres: 160, 12,000. Contact and the bending of skin know their size: 0.9 mm; as stiff bones would make it 10.
  EXPECT_LT((posed(17) - posed(4)).rowwise().norm().maxCoeff(), 2e-3);
}

TEST(CageBody, AHuman) {
  const Character human = stand_in_human();
  expect_poses(human, {turned_joints(human.skeleton)}, "stand-in");
}

TEST(CageBody, RealCharactersOfEveryKind) {
  for (const char* file :
       {"cesium_man.glb", "fox.glb", "simple_skin.gltf", "quaternius_man.glb", "quaternius_horse.glb"}) {
    const auto path = shared_data(std::string("characters/") + file);
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    const Character character = read_character(*path, std::string(file) == "fox.glb" ? 0.01 : 0);
    expect_poses(character, {turned_joints(character.skeleton)}, file);
  }
  // In motion of their own: feet that hang on the root, and 31 units, taken for metres, from snout to tail.
  for (const auto& [file, clip] : {std::pair("quaternius_horse.glb", "#Run"), std::pair("quaternius_trex.glb", "")}) {
    const auto path = shared_data(std::string("characters/") + file);
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    const Character character = read_character(*path);
    const std::vector<Pose> poses = read_clip(path->string() + clip, character.skeleton, {}).poses;
    expect_poses(character, {poses[poses.size() / 4], poses[poses.size() / 2]}, file);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
