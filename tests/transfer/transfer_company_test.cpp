// What goes with a basis to another body: levels of detail and dynamics.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/mesh.h"
#include "runtime/core/json.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/temporary_folder.h"
#include "tests/transfer/refined_limb.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/transfer_basis.h"
#include "trainer/transfer/transfer_levels.h"

namespace bodyopt::trainer {
namespace {

const SampleSet& few_samples() {
  static const SampleSet set = limb_samples(60, 10);
  return set;
}

const Basis& limb_basis() {
  static const Basis basis = train(few_samples(), {}).basis;
  return basis;
}

const std::vector<Level>& limb_levels() {
  static const std::vector<Level> levels = [] {
    std::vector<std::string> notes;
    return build_proxy(few_samples(), {.errors = {5e-4, 1e-3}}, notes).levels;
  }();
  return levels;
}

// A limb of other bones and another size.
Character other_limb(double size) {
  Character limb = limb_character();
  limb.vertices *= size;
  for (Joint& joint : limb.skeleton.joints) {
    joint.name = "other_" + joint.name;
    for (double& x : joint.bind.translation) x *= size;
    joint.default_local = joint.bind;
    for (auto& row : joint.inverse_bind.m) row[3] *= size;
  }
  return limb;
}

// joint_map.json of those.
class OtherJoints {
 public:
  OtherJoints() {
    Json joints = Json::array();
    for (const Joint& joint : limb_skeleton().joints)
      joints.push_back({{"from", joint.name}, {"to", "other_" + joint.name}});
    std::ofstream(file()) << Json{{"schema", "bodyopt-joint-map-1"}, {"joints", joints}};
  }
  std::string file() const { return (folder_ / "map.json").string(); }

 private:
  TemporaryFolder folder_;
};

Character with_beak(Character limb) {
  const double from = 0.9 * kLimbLength;
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    double& z = limb.vertices(v, 2);
    if (z > from) z += 6 * (z - from);
  }
  return limb;
}

double off_by(const Positions& difference) {
  return std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows()));
}

Positions evaluated(const Basis& basis, const Pose& pose) {
  Deformer deformer(basis, {.name = "cpu"});
  return rows_of(deformer.evaluate({&pose, 1}).positions);
}

// The full skin that the level carries.
Positions carried_skin(const Level& level, const Pose& pose) {
  Deformer deformer(level.basis, {.name = "cpu"});
  deformer.set_normals(true);
  const Evaluation frame = deformer.evaluate({&pose, 1});
  return rows_of(carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals));
}

}  // namespace

TEST(TransferLevels, CarriedToTheirOwnCharacterTheyAreTheSame) {
  const Character limb = limb_character();
  const TransferPair pair(limb_basis(), limb, {});
  std::vector<std::string> notes;
  const std::vector<Level> carried = transfer_levels(pair, limb, limb_levels(), {}, notes);
  ASSERT_EQ(carried.size(), limb_levels().size());
  const Pose& bent = few_samples().heldout[7].pose;
  for (std::size_t k = 0; k < carried.size(); ++k) {
    EXPECT_EQ(carried[k].basis.mesh.output_triangles, limb_levels()[k].basis.mesh.output_triangles);
    EXPECT_LT(off_by(carried_skin(carried[k], bent) - carried_skin(limb_levels()[k], bent)), 1e-4);
  }
  const ProxyReport told = read_proxy_report(carried.front().basis),
                    before = read_proxy_report(limb_levels().front().basis);
  ASSERT_EQ(told.levels.size(), carried.size());
  EXPECT_NEAR(told.levels[1].distance_rms, before.levels[1].distance_rms, 1e-4);
  EXPECT_NE(told.measured_on.find("of the source"), std::string::npos);
}

TEST(TransferLevels, OnABodyOfAnotherSizeTheyMoveAsItsBasisDoes) {
  const OtherJoints joints;
  const Character other = other_limb(1.5);
  const TransferOptions options{.joint_map = joints.file()};
  const TransferPair pair(limb_basis(), other, options);
  std::vector<std::string> notes;
  const Level level = transfer_levels(pair, other, limb_levels(), options, notes).front();
  EXPECT_EQ(level.carried.size(), other.output_count());
  const Pose& bent = few_samples().heldout[7].pose;
  const Pose moved = transferred_pose(pair.match, pair.source.skeleton, other.skeleton, bent);
  Positions difference = carried_skin(level, moved) - 1.5 * carried_skin(limb_levels().front(), bent);
  difference.rowwise() -= difference.colwise().mean().eval();  // of where the root stands
  EXPECT_LT(off_by(difference), 3e-4);
}

// Of the source there is nothing but its proxy.
TEST(TransferLevels, AProxyAloneTakesAllOfItsLevelsAlong) {
  const Character limb = limb_character();
  const TransferPair pair(limb_levels().front().basis, limb, {});
  std::vector<std::string> notes;
  const std::vector<Level> carried = transfer_levels(pair, limb, limb_levels(), {}, notes);
  ASSERT_EQ(carried.size(), limb_levels().size());
  const Pose& bent = few_samples().heldout[7].pose;
  const Positions bare = evaluated(pair.target, bent);
  for (std::size_t k = 0; k < carried.size(); ++k) {
    EXPECT_EQ(carried[k].basis.mesh.output_triangles, limb_levels()[k].basis.mesh.output_triangles);
    EXPECT_EQ(carried[k].carried.size(), limb.output_count());
    const Positions own = carried_skin(limb_levels()[k], bent);
    EXPECT_LT(off_by(carried_skin(carried[k], bent) - own), 0.2 * off_by(bare - own)) << k;
  }
}

// A long beak at the end of other triangles, which nothing of the source lies on: levels laid onto it would lack it.
TEST(TransferLevels, WhereTheyWouldLackAPartTheyAreOfTheTargetsOwnSkin) {
  const Character beaked = with_beak(refined_limb());
  const TransferPair pair(limb_basis(), beaked, {});
  std::vector<std::string> notes;
  const std::vector<Level> carried = transfer_levels(pair, beaked, limb_levels(), {}, notes);
  EXPECT_TRUE(std::ranges::any_of(
      notes, [](const std::string& note) { return note.find("made of its own skin") != std::string::npos; }));
  const ProxyReport told = read_proxy_report(carried.front().basis);
  ASSERT_EQ(told.levels.size(), carried.size());
  for (std::size_t k = 0; k < carried.size(); ++k) {
    EXPECT_EQ(carried[k].carried.size(), beaked.output_count());
    EXPECT_LT(told.levels[k].distance_rms, 2 * told.levels[k].error) << k;
  }
  const std::vector<float>& rest = carried.back().basis.mesh.rest;
  double highest = 0;
  for (std::size_t z = 2; z < rest.size(); z += 3) highest = std::max<double>(highest, rest[z]);
  EXPECT_NEAR(highest, beaked.vertices.col(2).maxCoeff(), 0.02);
}

TEST(TransferLevels, ASkinTooCoarseForLevelsOfItsOwnGetsNone) {
  const Character limb = limb_character();
  const Character coarse = with_beak(proxy_character(limb, simplify_skin(limb, {limb.vertices}, 6e-3)));
  ASSERT_LT(coarse.vertices.rows(), 100);
  const TransferPair pair(limb_basis(), coarse, {});
  std::vector<std::string> notes;
  EXPECT_TRUE(transfer_levels(pair, coarse, limb_levels(), {}, notes).empty());
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes.back().find("it gets no levels"), std::string::npos) << notes.back();
}

TEST(TransferLevels, RefusesAProxyOfAnotherCharacter) {
  std::vector<Level> strange = limb_levels();
  EXPECT_NO_THROW(require_proxy_of(limb_basis(), strange));
  strange.back().carried.points.pop_back();
  EXPECT_EQ(testing::kind_of([&] { require_proxy_of(limb_basis(), strange); }), ErrorKind::mismatch);
}

TEST(TransferDynamics, SettingsGoToTheTargetsJointsInItsSize) {
  const OtherJoints joints;
  const Character limb = limb_character(), other = other_limb(1.5);
  DynamicsOptions asked;
  asked.resolution = 800;
  asked.step.frames_per_second = 48;
  asked.step.substeps = 2;
  asked.settings.softness = 2;
  asked.settings.flesh = 0.01;
  asked.settings.regions = {{.name = limb.skeleton.joints[1].name, .softness = 3, .flesh = 0.004}};
  const Dynamics source = build_dynamics(limb, {}, limb_basis(), asked).dynamics;
  const DynamicsOptions again = asked_options(source);
  EXPECT_EQ(again.resolution, 800);
  EXPECT_EQ(again.settings.flesh, 0.01);

  const TransferOptions options{.joint_map = joints.file()};
  const TransferPair pair(limb_basis(), other, options);
  std::vector<std::string> notes;
  const Basis basis = transfer_basis(pair, options, notes);
  const Dynamics carried = transfer_dynamics(pair, other, basis, source, {}, notes);
  EXPECT_NO_THROW(validate(carried, basis, "it"));
  const DynamicsOptions told = asked_options(carried);
  EXPECT_EQ(told.step.frames_per_second, 48);
  EXPECT_EQ(told.step.substeps, 2u);
  EXPECT_EQ(told.settings.softness, 2);
  EXPECT_NEAR(told.settings.flesh, 0.015, 1e-12);
  ASSERT_EQ(told.settings.regions.size(), 1u);
  EXPECT_EQ(told.settings.regions[0].name, other.skeleton.joints[1].name);
  EXPECT_NEAR(told.settings.regions[0].flesh.value(), 0.006, 1e-12);
  EXPECT_TRUE(notes.empty());
}

TEST(TransferDynamics, SaysWhatOfTheSettingsIsLeftOut) {
  const Character limb = limb_character();
  DynamicsOptions asked;
  asked.resolution = 800;
  asked.settings.regions = {{.by = JiggleRegion::By::painted, .name = "belly", .softness = 3}};
  asked.painted = {{"belly", {0, 1, 2}, {1, 1, 1}}};
  const Dynamics source = build_dynamics(limb, {}, limb_basis(), asked).dynamics;
  const TransferPair pair(limb_basis(), limb, {});
  std::vector<std::string> notes;
  const Dynamics carried = transfer_dynamics(pair, limb, limb_basis(), source, {}, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("belly"), std::string::npos) << notes[0];
  EXPECT_TRUE(asked_options(carried).settings.regions.empty());
}

TEST(TransferDynamics, RefusesDynamicsThatDoNotSayWhatTheyAreOf) {
  Dynamics dynamics;
  EXPECT_EQ(testing::kind_of([&] { asked_options(dynamics); }), ErrorKind::file);
  for (const char* damaged : {"", "[]", "{", R"({"resolution":5})", R"({"resolution":800,"softness":"soft"})"}) {
    dynamics.metadata["provenance"] = damaged;
    EXPECT_EQ(testing::kind_of([&] { asked_options(dynamics); }), ErrorKind::file) << damaged;
  }
}

}  // namespace bodyopt::trainer
