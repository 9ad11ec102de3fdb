// Where meshes of a glTF file come to stand in a character's rest space.
#include "trainer/attach/loose_meshes.h"

#include <cmath>
#include <random>

#include "tests/support/limb_glb.h"

namespace bodyopt::trainer {
namespace {

class LooseMeshes : public ::testing::Test {
 protected:
  std::vector<LooseMesh> read(const GltfBlob& blob, double unit = 1) {
    put_bytes(folder_ / "c.glb", blob.glb());
    notes_.clear();
    return read_loose_meshes(GltfFile(folder_ / "c.glb"), limb_basis().skeleton, limb_basis().mesh.output_count(), unit,
                             notes_);
  }
  LimbGlb limb() const { return LimbGlb(folder_ / "limb.glb"); }

  TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

void expect_near(const Vec3& found, const Vec3& expected) { EXPECT_LT(length(found - expected), 1e-6) << found[0]; }

TEST_F(LooseMeshes, BelowAJointTheyStandWhereTheBindPoseHasTheJoint) {
  LimbGlb blob = limb();
  // The file's default pose is another than the bind pose: it must not matter.
  blob.root["nodes"][1]["rotation"] = {0.6, 0, 0, 0.8};
  const LooseMesh eye = sphere_at("", {0, 0, 0}, 1);
  blob.add_node("eye", blob.add_mesh(eye), 2).update({{"translation", {0.01, 0.02, 0.03}}, {"scale", {0.5, 0.5, 2}}});
  const std::vector<LooseMesh> meshes = read(blob);
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].name, "eye");
  EXPECT_EQ(meshes[0].joint, 2);
  ASSERT_EQ(meshes[0].vertices.size(), eye.vertices.size());
  for (std::size_t v = 0; v < eye.vertices.size(); ++v) {
    const Vec3& p = eye.vertices[v];
    expect_near(meshes[0].vertices[v], {0.01 + 0.5 * p[0], 0.02 + 0.5 * p[1], 0.5 + 0.03 + 2 * p[2]});
  }
  EXPECT_EQ(meshes[0].triangles, eye.triangles);
}

TEST_F(LooseMeshes, MirroredOnesKeepTheirOutside) {
  LimbGlb blob = limb();
  const LooseMesh eye = sphere_at("", {0, 0, 0}, 1);
  const std::size_t mesh = blob.add_mesh(eye);
  blob.add_node("left", mesh, 2);
  blob.add_node("right", mesh, 2)["scale"] = {-1, 1, 1};
  const std::vector<LooseMesh> meshes = read(blob);
  ASSERT_EQ(meshes.size(), 2u);
  const auto volume = [](const LooseMesh& m) {
    double sum = 0;
    for (const auto& [a, b, c] : m.triangles) sum += dot(m.vertices[a], cross(m.vertices[b], m.vertices[c])) / 6;
    return sum;
  };
  EXPECT_GT(volume(meshes[0]), 3);
  EXPECT_NEAR(volume(meshes[0]), volume(meshes[1]), 1e-6);
}

TEST_F(LooseMeshes, AFurtherSkinIsBroughtToTheRestSpaceByItsOwnBinds) {
  LimbGlb blob = limb();
  const LooseMesh cloth = sleeve(0.008);
  const std::size_t mesh = blob.add_mesh(cloth, 100);  // modelled in centimetres
  // Its skin lists the joints the other way round.
  std::vector<float> binds = identity_matrices(2);
  for (std::size_t k = 0; k < 2; ++k) {
    for (const std::size_t i : {0, 5, 10}) binds[16 * k + i] = 0.01f;
    binds[16 * k + 14] = k == 0 ? -0.3f : 0.0f;
  }
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const Vec3& p : cloth.vertices) {
    joints.insert(joints.end(), {0, 1, 0, 0});
    const float elbow = p[2] > 0.3 ? 0.75f : 0.25f;
    weights.insert(weights.end(), {elbow, 1 - elbow, 0, 0});
  }
  const std::size_t joint_set = blob.joints(joints), weight_set = blob.quads(weights);
  blob.root["meshes"][mesh]["primitives"][0]["attributes"]["JOINTS_0"] = joint_set;
  blob.root["meshes"][mesh]["primitives"][0]["attributes"]["WEIGHTS_0"] = weight_set;
  const std::size_t inverse_binds = blob.matrices(binds);
  blob.root["skins"].push_back({{"joints", {1, 0}}, {"inverseBindMatrices", inverse_binds}});
  blob.add_node("shirt", mesh, -1)["skin"] = 1;
  const std::vector<LooseMesh> meshes = read(blob);
  ASSERT_EQ(meshes.size(), 1u) << (notes_.empty() ? "" : notes_[0]);
  EXPECT_EQ(meshes[0].joint, -1);
  for (std::size_t v = 0; v < cloth.vertices.size(); ++v) {
    expect_near(meshes[0].vertices[v], cloth.vertices[v]);
    ASSERT_EQ(meshes[0].weights[v].size(), 2u);
    EXPECT_EQ(meshes[0].weights[v][0].joint, 1u);
    EXPECT_NEAR(meshes[0].weights[v][0].weight, cloth.vertices[v][2] > 0.3 ? 0.75 : 0.25, 1e-6);
  }
}

TEST_F(LooseMeshes, OfTheCharacterWhatHangsOnNoJointOrIsNoSurfaceIsLeftOut) {
  LimbGlb blob = limb();
  const std::size_t mesh = blob.add_mesh(blade());
  blob.add_node("floor", mesh, -1);
  blob.add_node("eye", mesh, 1);
  blob.root["meshes"].push_back(blob.root["meshes"][mesh]);
  blob.root["meshes"].back()["primitives"][0]["mode"] = 1;
  blob.add_node("wire", mesh + 1, 1);
  const std::vector<LooseMesh> meshes = read(blob);
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].name, "eye");
  EXPECT_TRUE(mentions(notes_, "Mesh 'floor' hangs on no joint"));
  EXPECT_TRUE(mentions(notes_, "Mesh 'wire' is not attached"));
}

TEST_F(LooseMeshes, OfAnotherFileAllIsTaken) {
  GltfBlob blob;  // no skin: nodes with the names of joints came along from the character
  blob.root["nodes"] = {{{"name", "joint1"}, {"translation", {5, 5, 5}}, {"children", {1, 3}}},
                        {{"name", "pommel"}, {"mesh", 0}, {"translation", {0, 0, 10}}},
                        {{"name", "pommel"}, {"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}},
                        {{"name", "joint2"}, {"mesh", 0}}};
  const std::size_t position = blob.vectors({0, 0, 0, 10, 0, 0, 0, 10, 0});
  blob.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}}}}}};
  const std::vector<LooseMesh> meshes = read(blob, 0.01);
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].joint, 1);
  expect_near(meshes[0].vertices[1], {0.1, 0, 0.3 + 0.1});
  EXPECT_EQ(meshes[1].name, "pommel_2");
  EXPECT_EQ(meshes[1].joint, -1);
  expect_near(meshes[1].vertices[1], {0.05, 0, 0});
  EXPECT_EQ(meshes[2].joint, 1);  // a mesh called like a joint is none
}

TEST_F(LooseMeshes, SkinsOnUnknownJointsAreRefusedWithTheNearestNames) {
  GltfBlob blob = two_joint_square();
  blob.root["nodes"][1]["name"] = "Joint_2";
  const std::string text = error_of(ErrorKind::mismatch, [&] { read(blob); });
  EXPECT_NE(text.find("skinned to joint 'root', which the character does not have"), std::string::npos) << text;
  blob.root["nodes"][0]["name"] = "jiont1";
  const std::string misspelt = error_of(ErrorKind::mismatch, [&] { read(blob); });
  EXPECT_NE(misspelt.find("the nearest names are 'joint1', "), std::string::npos) << misspelt;
}

TEST_F(LooseMeshes, BadGeometryIsRefused) {
  const auto expect = [&](const std::string& named, const std::function<void(GltfBlob&)>& change) {
    GltfBlob blob;
    blob.root["nodes"] = {{{"name", "prop"}, {"mesh", 0}}};
    const std::size_t position = blob.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::size_t indices = blob.add(std::vector<std::uint32_t>{0, 1, 2}, 5125, "SCALAR", 1);
    blob.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
    change(blob);
    const std::string text = error_of(ErrorKind::file, [&] { read(blob); });
    EXPECT_NE(text.find(named), std::string::npos) << text;
  };
  const std::uint32_t huge = 0xffffffff;
  const float nan = std::nanf("");
  expect("index 4294967295 of 3 vertices", [&](GltfBlob& b) { std::memcpy(b.binary.data() + 36, &huge, 4); });
  expect("is not a finite number", [&](GltfBlob& b) { std::memcpy(b.binary.data() + 8, &nan, 4); });
  expect("made of points or lines", [](GltfBlob& b) { b.root["meshes"][0]["primitives"][0]["mode"] = 0; });
  expect("mesh 'prop' has no triangles", [](GltfBlob& b) {
    b.root["accessors"][1]["count"] = 2;
    b.root["meshes"][0]["primitives"][0]["mode"] = 5;
  });
  expect("a node uses mesh 7 of 1", [](GltfBlob& b) { b.root["nodes"][0]["mesh"] = 7; });
  expect("a node uses skin 3 of 0", [](GltfBlob& b) { b.root["nodes"][0]["skin"] = 3; });
}

TEST_F(LooseMeshes, DamagedFilesAreReadOrRefused) {
  LimbGlb blob = limb();
  blob.add_node("eye", blob.add_mesh(blade()), 1);
  const std::string bytes = blob.glb();
  std::mt19937 random(5);
  for (int k = 0; k < 300; ++k) {
    std::string damaged = bytes;
    for (int n = 0; n < 3; ++n) damaged[20 + random() % 3000] ^= static_cast<char>(1 + random() % 255);
    put_bytes(folder_ / "d.glb", damaged);
    std::vector<std::string> notes;
    try {
      for (const LooseMesh& mesh : read_loose_meshes(GltfFile(folder_ / "d.glb"), limb_basis().skeleton,
                                                     limb_basis().mesh.output_count(), 1, notes)) {
        for (const auto& [a, b, c] : mesh.triangles) ASSERT_LT(std::max({a, b, c}), mesh.vertices.size());
      }
    } catch (const Error& error) {
      EXPECT_GT(std::string(error.what()).size(), 20u);
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
