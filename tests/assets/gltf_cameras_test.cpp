// Cameras of glTF files, moved by nodes, against what the nodes say.
#include <gtest/gtest.h>

#include <cmath>

#include "assets/clips/clip.h"
#include "tests/assets/gltf_blob.h"

namespace bodyopt::testing {
namespace gltf_cameras_test {

// A square that nods, a crane that goes from x = 1 to x = 3 in a second, and a camera on it 2 above.
GltfBlob filmed_square() {
  GltfBlob blob = two_joint_square();
  blob.root["nodes"].push_back({{"name", "crane"}, {"children", {4}}});
  blob.root["nodes"].push_back({{"name", "close"}, {"translation", {0, 2, 0}}, {"camera", 0}});
  blob.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  blob.root["animations"] = {{{"name", "nod"}, {"samplers", Json::array()}, {"channels", Json::array()}}};
  animate(blob, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0.6f, 0, 0, 0.8f});
  animate(blob, 3, "translation", {0, 1}, {1, 0, 0, 3, 0, 0});
  return blob;
}

class GltfCamerasTest : public ::testing::Test {
 protected:
  Clip read(const GltfBlob& blob, double fps = 4) {
    put_bytes(folder_ / "filmed.glb", blob.glb());
    Skeleton skeleton;
    skeleton.joints.resize(2);
    skeleton.joints[0].name = "root";
    skeleton.joints[1].name = "tip";
    skeleton.joints[1].parent = 0;
    for (JointTransform* t : {&skeleton.joints[1].bind, &skeleton.joints[1].default_local}) t->translation = {0, 1, 0};
    skeleton.joints[1].inverse_bind.m[1][3] = -1;
    return read_clip((folder_ / "filmed.glb").string(), skeleton, {.fps = fps, .unit = 1});
  }

  TemporaryFolder folder_;
};

TEST_F(GltfCamerasTest, GoWithTheirNodesFrameByFrame) {
  const Clip clip = read(filmed_square());
  ASSERT_EQ(clip.cameras.size(), 1u);
  const ClipCamera& camera = clip.cameras[0];
  EXPECT_EQ(camera.name, "close");
  EXPECT_DOUBLE_EQ(camera.vertical_angle, 0.7);
  ASSERT_EQ(camera.places.size(), clip.poses.size());
  ASSERT_EQ(camera.places.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(length(camera.places[k] * Vec3{0, 0, 0} - Vec3{1 + 0.5 * static_cast<double>(k), 2, 0}), 0, 1e-6) << k;
  }
}

TEST_F(GltfCamerasTest, CutWhereTheirNodesStep) {
  GltfBlob blob = filmed_square();
  blob.root["animations"][0]["samplers"][1]["interpolation"] = "STEP";
  const Clip clip = read(blob);
  EXPECT_NEAR((clip.cameras.at(0).places.at(3) * Vec3{0, 0, 0})[0], 1, 1e-6);
  EXPECT_NEAR((clip.cameras.at(0).places.at(4) * Vec3{0, 0, 0})[0], 3, 1e-6);
}

TEST_F(GltfCamerasTest, StandStillInACharactersFileAndMayLackPerspective) {
  GltfBlob blob = filmed_square();
  blob.root["nodes"].push_back({{"camera", 1}});
  blob.root["nodes"].push_back({{"name", "close"}, {"camera", 1}});
  blob.root["cameras"].push_back({{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}}}});
  put_bytes(folder_ / "filmed.glb", blob.glb());
  const std::vector<ClipCamera> cameras = read_still_cameras(folder_ / "filmed.glb", 0.5);
  ASSERT_EQ(cameras.size(), 3u);
  EXPECT_NEAR(length(cameras[0].places.at(0) * Vec3{0, 0, 0} - Vec3{0, 1, 0}), 0, 1e-6) << "as the node stands";
  EXPECT_EQ(cameras[1].name, "camera");
  EXPECT_EQ(cameras[1].vertical_angle, 0);
  EXPECT_DOUBLE_EQ(cameras[1].height, 2) << "twice ymag, in metres";
  EXPECT_EQ(cameras[2].name, "close 2");
  put_bytes(folder_ / "a.bvh", "HIERARCHY");
  EXPECT_TRUE(read_still_cameras(folder_ / "a.bvh", 1).empty());
}

TEST_F(GltfCamerasTest, WhatIsNoCameraIsLeftOutByName) {
  const std::pair<Json, const char*> wrong[] = {
      {Json{{{"type", "perspective"}, {"perspective", {{"yfov", 0}}}}}, "yfov"},
      {Json{{{"type", "perspective"}, {"perspective", {{"yfov", "wide"}}}}}, "yfov"},
      {Json{{{"type", "perspective"}}}, "has no 'perspective'"},
      {Json{{{"type", "perspective"}, {"perspective", 3}}}, "perspective"},
      {Json{{{"type", "orthographic"}, {"orthographic", {{"ymag", -1}}}}}, "ymag"},
      {Json{{{"type", 7}}}, "type"},
      {Json{{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}, {"name", 5}}}, "name"},
      {Json::array(), "has no camera 0"},
      {Json{{"a", 1}}, "cameras"}};
  for (const auto& [cameras, named] : wrong) {
    GltfBlob blob = filmed_square();
    blob.root["cameras"] = cameras;
    for (Json& node : blob.root["nodes"]) {
      if (node.contains("camera")) node.erase("name");  // it is called as the camera is
    }
    const Clip clip = read(blob);
    EXPECT_TRUE(clip.cameras.empty()) << cameras;
    EXPECT_FALSE(clip.poses.empty());
    EXPECT_TRUE(mentions(clip.notes, named)) << named << (clip.notes.empty() ? "" : clip.notes.back());
    EXPECT_TRUE(mentions(clip.notes, "filmed.glb")) << named;
  }
}

}  // namespace gltf_cameras_test
}  // namespace bodyopt::testing
