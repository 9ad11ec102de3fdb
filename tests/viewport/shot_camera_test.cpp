// The camera of the shot: keyed by hand, cut, looked through, saved and drawn again without a window.
#include <numbers>

#include "draw/camera.h"
#include "shots/session/between_keys.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/limb_glb.h"
#include "tests/support/random_tables.h"
#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace shot_camera_test {

using namespace trainer;
using namespace shots;
using namespace draw;
using namespace viewport;

constexpr double kPi = std::numbers::pi;

TEST(CameraKeys, BlendTheShortWayAndCutWhereTheyStep) {
  std::map<int, CameraKey> keys;
  keys[10] = {{.target = {1, 0, 0}, .distance = 2, .azimuth = 3}, KeyEase::linear};
  keys[20] = {{.target = {3, 2, 0}, .distance = 4, .azimuth = -3, .elevation = 1}, KeyEase::step};
  keys[30] = {{.distance = 9, .azimuth = 1}};
  EXPECT_EQ(between_keys(keys, 3), keys[10]);
  EXPECT_EQ(between_keys(keys, 99), keys[30]);
  const CameraKey middle = between_keys(keys, 15);
  EXPECT_NEAR(length(middle.target - Vec3{2, 1, 0}), 0, 1e-12);
  EXPECT_NEAR(middle.distance, 3, 1e-12);
  EXPECT_NEAR(std::abs(std::remainder(middle.azimuth, 2 * kPi)), kPi, 1e-12) << "over the back, not round the front";
  EXPECT_NEAR(middle.elevation, 0.5, 1e-12);
  EXPECT_EQ(between_keys(keys, 29), keys[20]);
  keys[10].ease = KeyEase::smooth;
  EXPECT_LT(between_keys(keys, 12).distance - 2, 0.2 * 2) << "slow at the key";
}

TEST(CameraKeys, OfASplineGoOnOverTheBackWithoutAStop) {
  std::map<int, CameraKey> keys;
  for (int k = 0; k < 4; ++k) {
    keys[10 * k] = {{.target = {1.0 * k, 0, 0}, .azimuth = std::remainder(2.5 + 0.5 * k, 2 * kPi)}, KeyEase::spline};
  }
  for (int frame = 11; frame < 20; ++frame) {
    const CameraKey key = between_keys(keys, frame);
    EXPECT_NEAR(key.target[0], 0.1 * frame, 1e-9);
    EXPECT_NEAR(std::remainder(key.azimuth - 2.5 - 0.05 * frame, 2 * kPi), 0, 1e-9);
    EXPECT_LE(std::abs(key.azimuth), kPi);
  }
}

// Of the picture, from -1 to 1, right and up; as glTF 2.0 projects (3.10.3), but for depth.
std::array<double, 2> projected(const ClipCamera& camera, std::size_t place, double aspect, const Vec3& point) {
  const Vec3 p = inverse(camera.places[place]) * point;
  const double half = camera.vertical_angle > 0 ? -p[2] * std::tan(0.5 * camera.vertical_angle) : 0.5 * camera.height;
  return {p[0] / (aspect * half), p[1] / half};
}

std::array<double, 2> seen(const Camera& camera, double aspect, const Vec3& point) {
  const auto rows = view_matrix(camera);
  const auto scale = projection(camera, {0.1, 10}, aspect);
  std::array<double, 3> p{};
  for (std::size_t r = 0; r < 3; ++r) {
    p[r] = static_cast<double>(rows[r][3]);
    for (std::size_t i = 0; i < 3; ++i) p[r] += static_cast<double>(rows[r][i]) * point[i];
  }
  const double w = camera.orthographic_height > 0 ? 1 : -p[2];
  return {static_cast<double>(scale[0]) * p[0] / w, static_cast<double>(scale[1]) * p[1] / w};
}

// However it is turned: rolled, by the poles, upside down.
TEST(FileCamera, SeesAsTheFileSays) {
  Random random(5);
  std::vector<Quat> turns;
  for (int k = 0; k < 60; ++k) turns.push_back(random.turn(kPi));
  for (const double steep : {0.5 * kPi, -0.5 * kPi, 1.53, -1.54}) {
    turns.push_back(axis_angle({0, 1, 0}, 0.7) * axis_angle({1, 0, 0}, steep));
  }
  for (const Quat& turn : turns) {
    for (const double angle : {0.7, 0.0}) {
      const Vec3 eye{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
      const ClipCamera camera{"a", angle, 1.5, {affine_from({eye, turn, {1, 1, 1}})}};
      OrbitCamera orbit;
      orbit.look(view_of(camera, 0));
      for (int k = 0; k < 5; ++k) {
        const Vec3 before = rotate(turn, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-4, -2)});
        const auto expected = projected(camera, 0, 1.5, eye + before), found = seen(orbit.camera(), 1.5, eye + before);
        EXPECT_NEAR(found[0], expected[0], 1e-5);
        EXPECT_NEAR(found[1], expected[1], 1e-5);
      }
    }
  }
}

class ShotCameraTest : public PlayedTest {
 protected:
  // A key from the right at frame 1, from the left at 9, and, after a cut, from behind at 10.
  std::unique_ptr<PlayedViewport> open_keyed(const std::string& more = "") const {
    return open(small(), kBarePicture + "; front; orbit 30 10; camera-key; frame 9; orbit -60 0; camera-key; " +
                             "camera-ease step; frame 10; back; camera-key; frame 1" + more);
  }
  static double azimuth(const PlayedViewport& viewport) { return viewport.controls().camera.view().azimuth; }
};

TEST_F(ShotCameraTest, LookingThroughNoCameraSaysSo) {
  const auto viewport = open(small(), kBarePicture);
  viewport->prompt("look-through on");
  ASSERT_FALSE(viewport->controls().messages.empty());
  EXPECT_NE(viewport->controls().messages.back().text.find("no camera yet"), std::string::npos);
  viewport->prompt("camera-key");
  const std::size_t said = viewport->controls().messages.size();
  viewport->prompt("look-through on");
  EXPECT_EQ(viewport->controls().messages.size(), said);
}

TEST_F(ShotCameraTest, PlayingLooksThroughIt) {
  const auto viewport = open_keyed();
  EXPECT_NEAR(azimuth(*viewport), kPi / 6, 1e-9);
  viewport->prompt("frame 5");
  EXPECT_NEAR(azimuth(*viewport), 0, 1e-9);
  viewport->prompt("frame 9");
  EXPECT_NEAR(azimuth(*viewport), -kPi / 6, 1e-9);
  const Image before = still(*viewport);
  viewport->key("Right");
  EXPECT_NEAR(std::abs(azimuth(*viewport)), kPi, 1e-9);
  EXPECT_GT(spot_difference(still(*viewport), before).largest, 10) << "a cut";
  viewport->keys({"Home", "Space"});
  double turned = 0;
  for (int k = 0; k < 16; ++k) {
    viewport->turn({}, 1.0 / 64);
    turned = std::max(turned, kPi / 6 - azimuth(*viewport));
  }
  EXPECT_GT(turned, 0.1);
}

TEST_F(ShotCameraTest, AViewThatIsMovedByHandIsFreeUntilTheFrameChanges) {
  const auto viewport = open_keyed("; frame 5");
  const auto keys = viewport->controls().settings.shot_camera.keys;
  ASSERT_EQ(keys.size(), 3u);
  viewport->drag(0, {160, 60}, {{205, 60}});
  EXPECT_NEAR(azimuth(*viewport), -0.8, 0.01);
  viewport->let_pass(0.5);
  EXPECT_NEAR(azimuth(*viewport), -0.8, 0.01) << "it stays where the hand left it";
  EXPECT_EQ(viewport->controls().settings.shot_camera.keys, keys);
  viewport->keys({"Right", "Left"});
  EXPECT_NEAR(azimuth(*viewport), 0, 1e-9);
  viewport->key("0");
  viewport->drag(0, {160, 60}, {{205, 60}});
  viewport->keys({"Right", "Right"});
  EXPECT_NEAR(azimuth(*viewport), -0.8, 0.01) << "it is not looked through";
  viewport->key("0");
  EXPECT_LT(azimuth(*viewport), -0.1);
  EXPECT_GT(azimuth(*viewport), -kPi / 6);
}

TEST_F(ShotCameraTest, KeysAreUndoneAndRedone) {
  const auto viewport = open_keyed("; frame 5");
  viewport->drag(0, {160, 60}, {{205, 60}});
  viewport->key("Alt+C");
  EXPECT_EQ(viewport->controls().settings.shot_camera.keys.size(), 4u);
  viewport->key("Ctrl+Z");
  EXPECT_FALSE(viewport->controls().settings.shot_camera.keys.contains(5));
  EXPECT_NEAR(azimuth(*viewport), 0, 1e-9) << "it is seen as the keys have it";
  viewport->key("Ctrl+Shift+Z");
  EXPECT_TRUE(viewport->controls().settings.shot_camera.keys.contains(5));
  EXPECT_NEAR(azimuth(*viewport), -0.8, 0.01);
  viewport->prompt("camera-unkey");
  viewport->prompt("camera-unkey");
  ASSERT_FALSE(viewport->controls().messages.empty());
  EXPECT_NE(viewport->controls().messages.back().text.find("frame 5 has no key of the camera"), std::string::npos);
}

TEST_F(ShotCameraTest, ASessionKeepsItAndASequenceIsSeenByIt) {
  const auto viewport = open_keyed();
  std::vector<Image> seen;
  for (const char* frame : {"frame 4", "frame 9", "frame 10"}) {
    viewport->prompt(frame);
    seen.push_back(still(*viewport));
  }
  viewport->prompt("front");
  viewport->prompt("save shot.json");
  EXPECT_FALSE(viewport->session().controls.has_unsaved_work());
  ViewerOptions options = small();
  options.files = {"shot.json"};
  options.headless = true;
  options.out = "seq.##.png";
  options.commands = kBarePicture;
  Application(options, device_, nullptr).make_pictures();
  EXPECT_TRUE(read_png("seq.04.png").rgba == seen[0].rgba);
  EXPECT_TRUE(read_png("seq.09.png").rgba == seen[1].rgba);
  EXPECT_TRUE(read_png("seq.10.png").rgba == seen[2].rgba);
}

// It goes along with a character that walks, as kept cameras do.
TEST_F(ShotCameraTest, FollowsTheCharacterWhereViewsDo) {
  const auto viewport = open(small(), kBarePicture + "; follow on; front; camera-key");
  const Vec3 before = viewport->controls().camera.view().target - viewport->controls().travelled;
  viewport->prompt("frame 7");
  EXPECT_NEAR(length(viewport->controls().camera.view().target - viewport->controls().travelled - before), 0, 1e-9);
}

// A limb that nods, filmed by a camera that goes along and rolls.
TEST_F(ShotCameraTest, ACameraOfTheClipsFileIsLookedThrough) {
  LimbGlb limb(folder_ / "limb.glb");
  limb.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.6}}}}};
  const std::size_t node = limb.root["nodes"].size();
  limb.root["nodes"].push_back({{"name", "crane shot"}, {"camera", 0}, {"translation", {0, 0.2, 1.5}}});
  limb.root["scenes"][0]["nodes"].push_back(node);
  limb.root["animations"] = {{{"name", "nod"}, {"samplers", Json::array()}, {"channels", Json::array()}}};
  animate(limb, 1, "rotation", {0, 1}, {0, 0, 0, 1, 0.6f, 0, 0, 0.8f});
  animate(limb, static_cast<int>(node), "translation", {0, 1}, {0, 0.2f, 1.5f, 0.6f, 0.4f, 1.2f});
  animate(limb, static_cast<int>(node), "rotation", {0, 1}, {0, 0, 0, 1, 0, 0.1f, 0.3f, 0.9486833f});
  put_bytes(folder_ / "limb.glb", limb.glb());
  ViewerOptions options = small();
  options.files = {"limb.glb", "limb.glb"};
  const auto viewport = open(options);
  const ClipCamera camera = viewport->session().scene.lead().clip().cameras.at(0);
  viewport->prompt("camera crane shot");
  Image at_12;
  for (const int frame : {1, 12, 25}) {
    viewport->prompt("frame " + std::to_string(frame));
    if (frame == 12) at_12 = still(*viewport);
    for (const Vec3& joint : viewport->session().scene.joint_centres(viewport->controls())) {
      const auto expected = projected(camera, static_cast<std::size_t>(frame - 1), 16.0 / 9, joint),
                 found = seen(viewport->controls().camera.camera(), 16.0 / 9, joint);
      EXPECT_NEAR(found[0], expected[0], 1e-4) << frame;
      EXPECT_NEAR(found[1], expected[1], 1e-4) << frame;
    }
  }
  viewport->prompt("frame 12");
  viewport->prompt("save shot.json");
  options.files = {"shot.json"};
  EXPECT_TRUE(headless(options, "legend on").rgba == at_12.rgba);
  viewport->prompt("front");
  EXPECT_EQ(viewport->controls().camera.view().roll, 0);
  viewport->prompt("camera crane");
  ASSERT_FALSE(viewport->controls().messages.empty());
  EXPECT_NE(viewport->controls().messages.back().text.find("'crane shot'"), std::string::npos);
}

TEST_F(ShotCameraTest, TheTimelineMarksItsKeys) {
  const auto viewport = open_keyed("; panels on");
  viewport->resize(1280, 800);
  viewport->click_messages_away();
  const auto marked = [&] {
    const std::vector<std::uint8_t>& rgba = viewport->screen.picture.rgba;
    std::size_t pixels = 0;
    for (std::size_t k = 0; k < rgba.size(); k += 4) {
      pixels += rgba[k] == 110 && rgba[k + 1] == 200 && rgba[k + 2] == 150;
    }
    return pixels;
  };
  const std::size_t of_three = marked();
  EXPECT_GT(of_three, 30u);
  viewport->prompt("frame 9");
  viewport->prompt("camera-unkey");
  viewport->prompt("frame 1");
  EXPECT_LT(marked(), of_three);
}

// A file in metres, as most are, says nothing of its unit.
TEST_F(ShotCameraTest, OfACharactersOwnFileStandsWhereItsNodeDoes) {
  GltfBlob blob = two_joint_square();
  blob.root["nodes"].push_back({{"name", "close"}, {"translation", {0, 1, 5}}, {"camera", 0}});
  blob.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  put_bytes("filmed.glb", blob.glb());
  ViewerOptions options = small();
  options.files = {"filmed.glb"};
  const auto viewport = open(options);
  const std::vector<ClipCamera>& cameras = viewport->controls().file_cameras;
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_NEAR(length(cameras[0].places.at(0) * Vec3{0, 0, 0} - Vec3{0, 1, 5}), 0, 1e-6);
}

}  // namespace shot_camera_test
}  // namespace bodyopt::testing
