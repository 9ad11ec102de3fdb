#include "assets/characters/character.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "runtime/host/rig.h"
#include "tests/assets/character_checks.h"
#include "tests/assets/gltf_blob.h"
#include "tests/assets/plain_gltf.h"
#include "tests/support/shared_data.h"

namespace bodyopt {
namespace {

double difference(const Affine& a, const Affine& b) {
  double most = 0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(a.m[r][c] - b.m[r][c]));
  }
  return most;
}

// The bind pose must pose every joint where its inverse bind matrix says.
double bind_error(const Skeleton& skeleton) {
  double most = 0;
  for (const Affine& m : skinning_matrices(skeleton, bind_pose(skeleton).joints)) {
    most = std::max(most, difference(m, Affine{}));
  }
  return most;
}

TEST(Character, ReadsASquare) {
  const TemporaryFolder folder;
  const Character c = read(two_joint_square(), folder);
  expect_valid(c);
  EXPECT_EQ(c.name, "square");
  EXPECT_EQ(c.vertices.rows(), 4);
  EXPECT_EQ(c.triangles.rows(), 2);
  EXPECT_LT(bind_error(c.skeleton), 1e-12);
  EXPECT_EQ(c.skeleton.joints[1].parent, 0);
  EXPECT_EQ(c.skeleton.joints[1].bind.translation, (Vec3{0, 1, 0}));
  EXPECT_EQ(c.weights[1][0].joint, 0u);
  EXPECT_NEAR(c.weights[1][0].weight, 0.75, 1e-12);
  EXPECT_TRUE(c.notes.empty()) << c.notes.front();
}

TEST(Character, ReadsEveryKindOfTriangleListAndIntegerWeights) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  auto fan = primitive(blob), strip = primitive(blob), plain = primitive(blob);
  fan["mode"] = 6;
  fan["indices"] = blob.add(std::vector<std::uint8_t>{0, 1, 2, 3}, 5121, "SCALAR", 1);
  fan["attributes"]["POSITION"] = blob.vectors({0, 0, 1, 1, 0, 1, 1, 2, 1, 0, 2, 1});
  fan["attributes"]["WEIGHTS_0"] = blob.add(
      std::vector<std::uint8_t>{255, 0, 0, 0, 51, 204, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0}, 5121, "VEC4", 4, true);
  strip["mode"] = 5;
  strip["indices"] = blob.add(std::vector<std::uint32_t>{0, 1, 3, 2}, 5125, "SCALAR", 1);
  strip["attributes"]["POSITION"] = blob.vectors({0, 0, 2, 1, 0, 2, 1, 2, 2, 0, 2, 2});
  strip["attributes"]["WEIGHTS_0"] =
      blob.add(std::vector<std::uint16_t>{65535, 0, 0, 0, 13107, 52428, 0, 0, 0, 65535, 0, 0, 0, 65535, 0, 0}, 5123,
               "VEC4", 4, true);
  plain.erase("indices");
  plain["attributes"]["POSITION"] = blob.vectors({0, 0, 3, 1, 0, 3, 1, 2, 3});
  plain["attributes"]["JOINTS_0"] =
      blob.add(std::vector<std::uint16_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 5123, "VEC4", 4);
  plain["attributes"]["WEIGHTS_0"] = blob.quads({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  // The last goes onto a second mesh and node of the same skin.
  blob.root["meshes"][0]["primitives"].push_back(fan);
  blob.root["meshes"][0]["primitives"].push_back(strip);
  blob.root["meshes"].push_back({{"primitives", {plain}}});
  blob.root["nodes"].push_back({{"mesh", 1}, {"skin", 0}});

  const Character c = read(blob, folder);
  expect_valid(c);
  EXPECT_EQ(c.output_count(), 15u);
  Triangles expected(7, 3);
  expected << 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7, 8, 9, 11, 9, 10, 11, 12, 13, 14;
  EXPECT_EQ(c.output_triangles, expected);
  for (const std::size_t v : {5u, 9u}) {
    EXPECT_EQ(c.weights[v][0].joint, 1u);
    EXPECT_NEAR(c.weights[v][0].weight, 0.8, 1e-6);
  }
}

TEST(Character, AllWeightSetsCountAndAreNormalised) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  primitive(blob)["attributes"]["JOINTS_1"] = blob.joints({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  primitive(blob)["attributes"]["WEIGHTS_1"] = blob.quads({1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0, 0, 0});
  const Character c = read(blob, folder);
  expect_valid(c);
  ASSERT_EQ(c.weights[0].size(), 2u);  // 1 on the root, 1 on the tip from the second set
  EXPECT_NEAR(c.weights[0][1].weight, 0.5, 1e-12);
  ASSERT_EQ(c.weights[2].size(), 1u);  // twice the tip
  EXPECT_TRUE(mentions(c.notes, "2 vertices did not add up"));
  EXPECT_TRUE(mentions(c.notes, "1 negative weight"));
}

TEST(Character, UnweightedVerticesFollowTheRoot) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  primitive(blob)["attributes"]["WEIGHTS_0"] = blob.quads({0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  const Character c = read(blob, folder);
  EXPECT_EQ(c.weights[0][0].joint, 0u);
  EXPECT_TRUE(mentions(c.notes, "1 vertex has no weights"));
}

TEST(Character, WeldsSeamsButNotOtherWeights) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  // 0..3 as before; 4 repeats 2 within the tolerance, 5 repeats 3 with other weights, 6 and 7 repeat 0.
  primitive(blob)["attributes"]["POSITION"] =
      blob.vectors({0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 1, 2.000001f, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0});
  primitive(blob)["attributes"]["JOINTS_0"] = blob.joints(std::vector<std::uint8_t>{
      0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  primitive(blob)["attributes"]["WEIGHTS_0"] =
      blob.quads({1, 0, 0, 0, .75f, .25f, 0, 0, 0, 1, 0, 0, .5f,     .5f,     0, 0,
                  0, 1, 0, 0, .6f,  .4f,  0, 0, 1, 0, 0, 0, .99995f, .00005f, 0, 0});
  primitive(blob)["indices"] =
      blob.add(std::vector<std::uint16_t>{0, 1, 2, 0, 4, 5, 0, 6, 3, 2, 4, 1}, 5123, "SCALAR", 1);
  const Character c = read(blob, folder);
  EXPECT_EQ(c.output_vertex, (std::vector<std::uint32_t>{0, 1, 2, 3, 2, 4, 0, 0}));
  EXPECT_EQ(c.vertices.rows(), 5);
  EXPECT_EQ(c.output_triangles.rows(), 4);
  EXPECT_EQ(c.triangles.rows(), 2);
  EXPECT_TRUE(mentions(c.notes, "3 seam duplicates"));
  EXPECT_TRUE(mentions(c.notes, "2 triangles without area"));
  EXPECT_TRUE(mentions(c.notes, "1 vertex belongs to no triangle"));

  std::vector<float> output = output_from_welded(c, c.vertices);
  EXPECT_EQ(output.size(), 24u);
  output[3 * 4] = 77;  // not the first of its welded vertex
  EXPECT_EQ(welded_from_output(c, output.data()), c.vertices);
}

// Joints in child-first order, a node between them, nodes above the root, a matrix: posed_joints of the default pose
// must be the file's world matrices.
TEST(Character, FoldsNodesThatAreNoJoints) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  const double h = std::sqrt(0.5);
  blob.root["nodes"] = {
      {{"name", "tip"}, {"translation", {0, 1, 0}}, {"rotation", {0, 0, h, h}}},
      {{"name", "between"}, {"translation", {0.5, 0, 0}}, {"children", {0}}},
      {{"name", "root"}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1}}, {"children", {1}}},
      {{"name", "top"}, {"scale", {2, 2, 2}}, {"rotation", {h, 0, 0, h}}, {"children", {2}}},
      {{"mesh", 0}, {"skin", 0}}};
  blob.root["skins"][0]["joints"] = {0, 2};
  blob.root["skins"][0].erase("inverseBindMatrices");
  const Character c = read(blob, folder);
  ASSERT_EQ(c.skeleton.joints[0].name, "root");
  ASSERT_EQ(c.skeleton.joints[1].name, "tip");
  EXPECT_EQ(c.skeleton.joints[1].parent, 0);
  EXPECT_EQ(c.weights[0][0].joint, 1u);  // joint 0 of the skin is the tip

  // By hand: top = scale 2 of a quarter turn about x (y -> z, z -> -y); root = a quarter turn about z at (3, 4, 5).
  const std::vector<JointTransform> locals{c.skeleton.joints[0].default_local, c.skeleton.joints[1].default_local};
  const std::vector<Affine> world = posed_joints(c.skeleton, locals);
  const Vec3 root = world[0] * Vec3{0, 0, 0};
  EXPECT_NEAR(length(root - Vec3{6, -10, 8}), 0, 1e-9);
  // tip in root's parent frame: root * (0.5, 1, 0) = (3, 4, 5) + (-1, 0.5, 0) = (2, 4.5, 5)
  EXPECT_NEAR(length(world[1] * Vec3{0, 0, 0} - Vec3{4, -10, 9}), 0, 1e-9);
  // x axis: tip turns it to y, root to -x, top to -2 x.
  EXPECT_NEAR(length(world[1] * Vec3{1, 0, 0} - Vec3{2, -10, 9}), 0, 1e-9);
}

TEST(Character, RestShapeTakesTheScaleOfTheJoints) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  blob.root["nodes"][0]["scale"] = {0.01, 0.01, 0.01};  // a mesh of 1 x 2 "metres" that the joints shrink
  Character c = read(blob, folder, 100);
  EXPECT_TRUE(mentions(c.notes, "scale the whole skin by 0.01"));
  EXPECT_NEAR(c.vertices(2, 1), 2, 1e-6);  // 2 units of 100 m, shrunk to a hundredth
  EXPECT_LT(bind_error(c.skeleton), 1e-9);
  std::vector<JointTransform> locals;
  for (const Joint& joint : c.skeleton.joints) locals.push_back(joint.default_local);
  for (const Affine& m : skinning_matrices(c.skeleton, locals)) EXPECT_LT(difference(m, Affine{}), 1e-9);
}

// An armature that is longer than wide, above a turned root: the square as the file shows it rests in no joint's shear,
// and turns with the tip as glTF has it.
TEST(Character, WhatStretchesAllOfItStretchesItsRest) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  const double half = 0.26179938779914943;  // of 30 degrees
  blob.root["nodes"][0]["rotation"] = {0, 0, std::sin(half), std::cos(half)};
  const std::size_t armature = blob.root["nodes"].size();
  blob.root["nodes"].push_back({{"name", "armature"}, {"scale", {1, 1.4, 0.7}}, {"children", {0}}});
  Character c = read(blob, folder);
  EXPECT_TRUE(mentions(c.notes, "stretch the whole skin one way"));
  EXPECT_FALSE(mentions(c.notes, "from where it should"));
  ASSERT_EQ(c.skeleton.size(), 3u);
  EXPECT_EQ(c.skeleton.joints[0].name, "armature");
  std::vector<JointTransform> locals;
  for (const Joint& joint : c.skeleton.joints) locals.push_back(joint.default_local);
  for (const Affine& m : skinning_matrices(c.skeleton, locals)) EXPECT_LT(difference(m, Affine{}), 1e-6);

  const auto expect_as_plain = [&] {
    const std::vector<PlainGltf::Point> plain = PlainGltf(blob).skinned(armature - 1);
    const std::vector<Affine> matrices = skinning_matrices(c.skeleton, locals);
    ASSERT_EQ(plain.size(), c.output_vertex.size());
    for (std::size_t o = 0; o < plain.size(); ++o) {
      const std::uint32_t v = c.output_vertex[o];
      const auto rest = c.vertices.row(static_cast<Eigen::Index>(v));
      Vec3 posed{0, 0, 0};
      for (const JointWeight& w : c.weights[v]) {
        posed = posed + w.weight * (matrices[w.joint] * Vec3{rest[0], rest[1], rest[2]});
      }
      EXPECT_LT(length(posed - Vec3(plain[o])), 1e-6);
    }
  };
  expect_as_plain();
  locals[2].rotation = {0, std::sin(half), 0, std::cos(half)};
  blob.root["nodes"][1]["rotation"] = locals[2].rotation;
  expect_as_plain();
  blob.root["nodes"][armature]["scale"] = {1, 0, 1};
  EXPECT_NE(error_of(ErrorKind::file, [&] { read(blob, folder); }).find("scaled to nothing"), std::string::npos);
}

TEST(Character, UnitScalesEverything) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  const Character metres = read(blob, folder), centimetres = read(blob, folder, 0.01);
  EXPECT_TRUE(centimetres.vertices.isApprox(0.01 * metres.vertices, 1e-12));
  EXPECT_NEAR(centimetres.skeleton.joints[1].bind.translation[1], 0.01, 1e-12);
  EXPECT_NEAR(centimetres.skeleton.joints[1].default_local.translation[1], 0.01, 1e-12);
  EXPECT_NEAR(centimetres.skeleton.joints[1].inverse_bind.m[1][3], -0.01, 1e-12);
  EXPECT_LT(bind_error(centimetres.skeleton), 1e-12);
}

// A person's size tells the unit of what is plainly not in metres; what is given is heeded.
TEST(Character, PlainlyNotMetresIsReadInTheUnitThatItsSizeTells) {
  const TemporaryFolder folder;
  const auto square = [](float size) {
    GltfBlob blob = two_joint_square();
    primitive(blob)["attributes"]["POSITION"] = blob.vectors({0, 0, 0, size, 0, 0, size, 2 * size, 0, 0, 2 * size, 0});
    return blob;
  };
  for (const auto& [size, unit] : {std::pair{100.0f, 0.01}, {30.0f, 0.01}, {1500.0f, 0.001}, {0.01f, 100.0}}) {
    const Character found = read(square(size), folder), given = read(square(size), folder, unit);
    EXPECT_EQ(found.unit, unit);
    EXPECT_TRUE(mentions(found.notes, "a unit is taken as ")) << size;
    EXPECT_TRUE(given.notes.empty());
    EXPECT_EQ(found.vertices, given.vertices);
    EXPECT_EQ(found.skeleton.joints[1].inverse_bind.m[1][3], given.skeleton.joints[1].inverse_bind.m[1][3]);
  }
  for (const float size : {1e-5f, 1e6f}) {
    const std::string text = error_of(ErrorKind::file, [&] { read(square(size), folder); });
    EXPECT_NE(text.find("(--unit)"), std::string::npos) << text;
  }
  const GltfBlob blob = square(100);
  const Character giant = read(blob, folder, 1), tiny = read(blob, folder, 0.0001);
  EXPECT_TRUE(mentions(giant.notes, "measures 223.6 m from corner to corner, outside 0.05 to 50 m"));
  EXPECT_TRUE(mentions(giant.notes, "likely 0.01 m (--unit)"));
  EXPECT_TRUE(mentions(tiny.notes, "likely 0.01 m (--unit)"));
  EXPECT_FALSE(mentions(read(square(1e6f), folder, 1).notes, "likely"));  // no unit makes it a person
  GltfBlob shrunk = blob;  // in centimetres, which its joints make metres: a unit is 1 m
  shrunk.root["nodes"][0]["scale"] = {0.01, 0.01, 0.01};
  EXPECT_TRUE(mentions(read(shrunk, folder, 0.01).notes, "likely 1 m (--unit: its joints scale it by 0.01)"));
  EXPECT_FALSE(mentions(read(shrunk, folder, 1).notes, "outside"));
  EXPECT_EQ(read(square(1), folder).unit, 0);
  error_of(ErrorKind::usage, [&] { read(blob, folder, -1); });
  error_of(ErrorKind::usage, [&] { read(blob, folder, NAN); });
}

TEST(Character, NamesJointsThatHaveNoneOrTheSame) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  blob.root["nodes"][0].erase("name");
  EXPECT_EQ(read(blob, folder).skeleton.joints[0].name, "joint_0");
  blob.root["nodes"][0]["name"] = blob.root["nodes"][1]["name"] = "bone";
  const Character c = read(blob, folder);
  EXPECT_EQ(c.skeleton.joints[0].name, "bone");
  EXPECT_EQ(c.skeleton.joints[1].name, "bone_2");
  EXPECT_TRUE(mentions(c.notes, "'bone_2'"));
}

// Of other binds than the character's, a skin is another's; of the same it is one with it.
TEST(Character, LargestSkinIsChosenWithThoseThatAreAlike) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  auto small = primitive(blob);
  small.erase("indices");
  small["attributes"]["POSITION"] = blob.vectors({0, 0, 1, 1, 0, 1, 0, 1, 1});
  small["attributes"]["JOINTS_0"] = blob.joints({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  small["attributes"]["WEIGHTS_0"] = blob.quads({1, 0, 0, 0, .25f, .75f, 0, 0, 0, 1, 0, 0});
  blob.root["meshes"].push_back({{"primitives", {small}}});
  blob.root["skins"].insert(blob.root["skins"].begin(), blob.root["skins"][0]);
  blob.root["nodes"][2]["skin"] = 1;
  blob.root["nodes"].push_back({{"mesh", 1}, {"skin", 0}, {"name", "hat"}});
  const Character both = read(blob, folder);
  EXPECT_EQ(both.vertices.rows(), 7);
  EXPECT_EQ(both.output_triangles.rows(), 3);
  EXPECT_FALSE(mentions(both.notes, "no part of it"));

  std::vector<float> binds = identity_matrices(2);
  binds[16 + 13] = -1;
  std::rotate(binds.begin(), binds.begin() + 16, binds.end());
  blob.root["skins"][0] = {{"joints", {1, 0}}, {"inverseBindMatrices", blob.matrices(binds)}};
  const Character permuted = read(blob, folder);  // the same joints the other way round
  EXPECT_EQ(permuted.vertices.rows(), 7);
  EXPECT_EQ(permuted.weights[5][0].joint, 0u);
  EXPECT_NEAR(permuted.weights[5][0].weight, 0.75, 1e-12);

  binds[13] = -0.9f;
  blob.root["skins"][0]["inverseBindMatrices"] = blob.matrices(binds);
  const Character largest = read(blob, folder);
  EXPECT_EQ(largest.vertices.rows(), 4);
  EXPECT_TRUE(mentions(largest.notes, "no part of it: 'hat'"));
}

TEST(Character, OfSeveralScenesTheOneThatShowsItIsRead) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  blob.root["nodes"].push_back({{"mesh", 0}, {"skin", 0}, {"name", "coarse"}});
  const auto read_with = [&](const Json& scenes, const Json& own) {
    blob.root["scenes"] = scenes;
    blob.root["scene"] = own;
    return read(blob, folder);
  };
  const Json whole = {{"nodes", {0, 2}}}, coarse = {{"nodes", {0, 3}}}, none = {{"nodes", {0}}};
  const Character first = read_with({whole, coarse}, 0), second = read_with({whole, coarse}, 1);
  EXPECT_TRUE(first.name == "square" && second.name == "coarse") << first.name << second.name;
  EXPECT_TRUE(mentions(first.notes, "does not show are left out: 'coarse'"));
  const Character other = read_with({none, coarse}, 0);
  EXPECT_EQ(other.name, "coarse");
  EXPECT_TRUE(mentions(other.notes, "scene 1 is read"));
  const Character all = read_with({none, none}, 0);
  EXPECT_EQ(all.output_count(), 8u);
  EXPECT_TRUE(mentions(all.notes, "all of its nodes are read"));
  error_of(ErrorKind::file, [&] { read_with(Json::array({whole}), 1); });
}

// Half of the skin by a joint that turns it inside out.
TEST(Character, JointsThatTurnPartOfItInsideOutAreRefused) {
  const TemporaryFolder folder;
  GltfBlob blob = two_joint_square();
  blob.root["nodes"][1]["scale"] = {1, 1, -1};
  EXPECT_NE(error_of(ErrorKind::file, [&] { read(blob, folder); }).find("turn the skin inside out"), std::string::npos);
  blob.root["nodes"][0]["scale"] = {1, 1, -1};
  blob.root["nodes"][1].erase("scale");
  const Character mirrored = read(blob, folder);  // all of it: read with its outside outside
  EXPECT_EQ(mirrored.output_triangles.row(0), (Eigen::Matrix<std::uint32_t, 1, 3>(0, 2, 1)));
  EXPECT_TRUE(mentions(mirrored.notes, "mirror the whole skin"));
}

void expect_same(const Character& a, const Character& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.skeleton.size(), b.skeleton.size());
  for (std::size_t j = 0; j < a.skeleton.size(); ++j) {
    const Joint &x = a.skeleton.joints[j], &y = b.skeleton.joints[j];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.parent, y.parent);
    EXPECT_LT(difference(x.inverse_bind, y.inverse_bind), 1e-6);
    EXPECT_LT(difference(affine_from(x.bind), affine_from(y.bind)), 2e-6);
    EXPECT_LT(difference(affine_from(x.default_local), affine_from(y.default_local)), 1e-12);
  }
  ASSERT_EQ(a.vertices.rows(), b.vertices.rows());
  EXPECT_LT((a.vertices - b.vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.output_vertex, b.output_vertex);
  EXPECT_EQ(a.output_triangles, b.output_triangles);
  for (std::size_t v = 0; v < a.weights.size(); ++v) {
    std::map<std::uint32_t, double> weights;
    for (const JointWeight& w : a.weights[v]) weights[w.joint] += w.weight;
    for (const JointWeight& w : b.weights[v]) weights[w.joint] -= w.weight;
    for (const auto& [joint, rest] : weights) ASSERT_NEAR(rest, 0, 1e-6);
  }
}

TEST(Character, WrittenAndReadBackIsTheSame) {
  const TemporaryFolder folder;
  Character c = read(two_joint_square(), folder);
  c.skeleton.joints[1].default_local.rotation = normalized({0.1, 0.2, 0.3, 0.9});
  Joint third = c.skeleton.joints[1];  // a second root
  third.name = "loose";
  third.parent = -1;
  third.bind = decompose(inverse(third.inverse_bind));
  c.skeleton.joints.push_back(third);
  c.weights[3] = {{2, 0.7}, {0, 0.2}, {1, 0.1}};
  write_character(c, folder / "w.glb");
  expect_same(c, read_character(folder / "w.glb"));
  EXPECT_FALSE(std::filesystem::exists(folder / "w.glb.tmp"));
}

TEST(Character, WhatCannotBeWrittenLeavesNothing) {
  const TemporaryFolder folder;
  Character c = read(two_joint_square(), folder);
  error_of(ErrorKind::file, [&] { write_character(c, folder / "no/such/folder.glb"); });
  c.vertices(0, 0) = NAN;
  error_of(ErrorKind::file, [&] { write_character(c, folder / "w.glb"); });
  EXPECT_FALSE(std::filesystem::exists(folder / "w.glb"));
  EXPECT_FALSE(std::filesystem::exists(folder / "w.glb.tmp"));
  std::filesystem::create_directories(folder / "taken.glb/x");
  c.vertices(0, 0) = 0;
  error_of(ErrorKind::file, [&] { write_character(c, folder / "taken.glb"); });
  EXPECT_FALSE(std::filesystem::exists(folder / "taken.glb.tmp"));
}

// Every edge is used once in each direction.
bool is_closed(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{triangles(t, k), triangles(t, (k + 1) % 3)}];
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end();
  });
}

struct RealCharacter {
  const char* file;
  double unit;
  Eigen::Index welded;
  std::uint32_t output;
  std::size_t joints;
};

class RealCharacters : public ::testing::TestWithParam<RealCharacter> {};

void PrintTo(const RealCharacter& character, std::ostream* out) { *out << character.file; }

TEST_P(RealCharacters, ReadAndRoundTrip) {
  const auto path = shared_data(std::string("characters/") + GetParam().file);
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Character c = read_character(*path, GetParam().unit);
  expect_valid(c);
  EXPECT_LT(bind_error(c.skeleton), 1e-5);
  EXPECT_EQ(is_closed(c.triangles), path->stem() != "simple_skin");
  EXPECT_EQ(c.vertices.rows(), GetParam().welded);
  EXPECT_EQ(c.output_count(), GetParam().output);
  EXPECT_EQ(c.skeleton.size(), GetParam().joints);
  const TemporaryFolder folder;
  write_character(c, folder / "again.glb");
  const Character again = read_character(folder / "again.glb", 1);
  expect_same(c, again);
}

INSTANTIATE_TEST_SUITE_P(All, RealCharacters,
                         ::testing::Values(RealCharacter{"human_muscular.glb", 0, 13380, 13380, 31},
                                           RealCharacter{"human_average.glb", 0, 13380, 13380, 31},
                                           RealCharacter{"human_163_joints.glb", 0, 13380, 13380, 163},
                                           RealCharacter{"cesium_man.glb", 0, 2338, 3273, 19},
                                           RealCharacter{"fox.glb", 0.01, 290, 1728, 24},
                                           RealCharacter{"greenman.glb", 0, 180, 196, 12},
                                           RealCharacter{"quaternius_horse.glb", 0, 347, 1398, 39},
                                           RealCharacter{"quaternius_man.glb", 0, 791, 4492, 48},
                                           RealCharacter{"simple_skin.gltf", 0, 10, 10, 2}));

}  // namespace
}  // namespace bodyopt
