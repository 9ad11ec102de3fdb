#include "draw/renderer.h"

#include <cmath>
#include <limits>

#include "draw/colours.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "tests/draw/sphere.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {
namespace {

using namespace draw;
using namespace report;

constexpr std::uint32_t kWidth = 96, kHeight = 64;
constexpr std::array<float, 3> kFront{0, 0, 1};

class RendererTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = std::make_unique<Renderer>(test_device().name, true); }

  static void TearDownTestSuite() {
    if (!renderer_) return;
    const auto log = renderer_->validation_log();
    renderer_.reset();
    EXPECT_EQ(log->messages(), std::vector<std::string>());
  }

  void TearDown() override { EXPECT_EQ(renderer_->validation_log()->messages(), std::vector<std::string>()); }

  static Image draw(const std::vector<DrawMesh>& meshes, std::uint32_t width = kWidth, std::uint32_t height = kHeight) {
    const Camera camera =
        frame_box({-1, -1, -1}, {1, 1, 1}, kFront, static_cast<float>(width) / static_cast<float>(height));
    return renderer_->draw(meshes, camera, width, height);
  }

  static inline std::unique_ptr<Renderer> renderer_;
};

std::array<int, 3> pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t at = 4 * (std::size_t{y} * image.width + x);
  return {image.rgba[at], image.rgba[at + 1], image.rgba[at + 2]};
}

int brightness(const std::array<int, 3>& p) { return p[0] + p[1] + p[2]; }

// Whether a pixel shows something: the backdrop is darker.
bool covered(const Image& image, std::uint32_t x, std::uint32_t y) { return brightness(pixel(image, x, y)) > 3 * 50; }

TEST_F(RendererTest, SphereIsClayOnADarkGround) {
  const Sphere sphere(1);
  const Image image = draw({sphere.mesh()});
  ASSERT_EQ(image.width, kWidth);
  ASSERT_EQ(image.height, kHeight);
  ASSERT_EQ(image.rgba.size(), std::size_t{kWidth} * kHeight * 4);
  const auto centre = pixel(image, kWidth / 2, kHeight / 2);
  EXPECT_GT(brightness(centre), 3 * 90);
  EXPECT_GT(centre[0], centre[2]);  // warm
  for (const std::uint32_t x : {0u, kWidth - 1}) {
    for (const std::uint32_t y : {0u, kHeight - 1}) EXPECT_LT(brightness(pixel(image, x, y)), 3 * 50);
  }
  for (std::size_t a = 3; a < image.rgba.size(); a += 4) ASSERT_EQ(image.rgba[a], 255);
}

TEST_F(RendererTest, LightComesFromTheUpperLeft) {
  const Sphere sphere(1);
  const Image image = draw({sphere.mesh()});
  const std::uint32_t x = kWidth / 2, y = kHeight / 2, d = kHeight / 4;
  EXPECT_GT(brightness(pixel(image, x - d, y - d)), brightness(pixel(image, x + d, y + d)) + 60);
}

TEST_F(RendererTest, SilhouetteOfASphereIsSymmetricAndOfTheRightSize) {
  Sphere sphere(1, 96, 64);
  sphere.colours.assign(sphere.positions.size(), 1.0f);  // bright all around
  const Image image = draw({sphere.mesh()}, 128, 128);
  int different = 0;
  std::size_t area = 0;
  for (std::uint32_t y = 0; y < 128; ++y) {
    for (std::uint32_t x = 0; x < 128; ++x) {
      area += covered(image, x, y);
      different += covered(image, x, y) != covered(image, 127 - x, y);
      different += covered(image, x, y) != covered(image, x, 127 - y);
    }
  }
  EXPECT_LT(different, 30);  // pixels on the very edge may fall either way with the light
  const Camera camera = frame_box({-1, -1, -1}, {1, 1, 1}, kFront, 1);
  const double distance = static_cast<double>(camera.eye[2]);
  const double tangent = 1 / std::sqrt(distance * distance - 1);  // of the angle from the axis to the edge
  const double radius = 64 * tangent / std::tan(0.5 * static_cast<double>(camera.vertical_angle));
  EXPECT_NEAR(static_cast<double>(area), 3.14159265 * radius * radius, 0.03 * 3.14159265 * radius * radius);
}

// Rows that a white sphere of radius 0.5 covers in the middle of the picture.
int sphere_rows(const Image& image) {
  int rows = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) rows += covered(image, image.width / 2, y) ? 1 : 0;
  return rows;
}

TEST_F(RendererTest, OrthographicCameraShowsTheSameSizeFromAnyDistance) {
  Sphere sphere(0.5f, 96, 64);
  sphere.colours.assign(sphere.positions.size(), 1.0f);
  const DrawMesh mesh = sphere.mesh();
  for (const float distance : {-3.0f, 0.2f, 4.0f, 1000.0f}) {  // also behind the eye, and around it
    Camera camera{{0, 0, distance}, {0, 0, distance - 1}, 0.45f, 2.0f};
    const Image image = renderer_->draw(std::span(&mesh, 1), camera, 128, 64);
    EXPECT_NEAR(sphere_rows(image), 32, 1) << distance;
    int columns = 0;
    for (std::uint32_t x = 0; x < image.width; ++x) columns += covered(image, x, 32) ? 1 : 0;
    EXPECT_NEAR(columns, 32, 1) << distance;
  }
}

TEST_F(RendererTest, OrthographicCameraKeepsTheNearerMeshBeforeTheOther) {
  Sphere red(0.5f), blue(0.5f);
  red.colours.assign(red.positions.size(), 0.0f);
  blue.colours = red.colours;
  for (std::size_t i = 0; i < red.colours.size(); i += 3) red.colours[i] = blue.colours[i + 2] = 1;
  for (std::size_t i = 2; i < red.positions.size(); i += 3) red.positions[i] += 0.01f;
  const DrawMesh meshes[] = {red.mesh(), blue.mesh()};
  const auto front = pixel(renderer_->draw(meshes, {{0, 0, 3}, {0, 0, 0}, 0.45f, 2.0f}, 64, 64), 32, 32);
  EXPECT_GT(front[0], front[2] + 100);
  const auto back = pixel(renderer_->draw(meshes, {{0, 0, -3}, {0, 0, 0}, 0.45f, 2.0f}, 64, 64), 32, 32);
  EXPECT_GT(back[2], back[0] + 100);
}

TEST_F(RendererTest, CutsAwayWhatStandsBeforeTheTarget) {
  Sphere red(0.5f), blue(0.5f);
  red.colours.assign(red.positions.size(), 0.0f);
  blue.colours = red.colours;
  for (std::size_t i = 0; i < red.colours.size(); i += 3) red.colours[i] = blue.colours[i + 2] = 1;
  for (std::size_t i = 2; i < red.positions.size(); i += 3) {
    red.positions[i] += 0.6f;
    blue.positions[i] -= 0.6f;
  }
  const DrawMesh meshes[] = {red.mesh(), blue.mesh()};
  for (const float height : {0.0f, 2.0f}) {
    Camera camera{{0, 0, 3}, {0, 0, 0}, 0.45f, height};
    const auto whole = pixel(renderer_->draw(meshes, camera, 64, 64), 32, 32);
    EXPECT_GT(whole[0], whole[2] + 100) << height;
    camera.cut_away = true;
    const auto cut = pixel(renderer_->draw(meshes, camera, 64, 64), 32, 32);
    EXPECT_GT(cut[2], cut[0] + 100) << height;
    camera.target[2] = -2;
    EXPECT_FALSE(covered(renderer_->draw(meshes, camera, 64, 64), 32, 32)) << height;
  }
}

TEST_F(RendererTest, SameInputGivesTheSameBits) {
  const Sphere sphere(1);
  EXPECT_EQ(draw({sphere.mesh()}).rgba, draw({sphere.mesh()}).rgba);
}

TEST_F(RendererTest, NearerMeshHidesTheOther) {
  Sphere near_sphere(0.4f), far_sphere(0.4f);
  for (std::size_t i = 2; i < near_sphere.positions.size(); i += 3) {
    near_sphere.positions[i] += 0.5f;
    far_sphere.positions[i] -= 0.5f;
  }
  near_sphere.colours.assign(near_sphere.positions.size(), 0.0f);
  far_sphere.colours.assign(far_sphere.positions.size(), 0.0f);
  for (std::size_t i = 0; i < near_sphere.colours.size(); i += 3)
    near_sphere.colours[i] = far_sphere.colours[i + 2] = 1;
  for (const auto& meshes :
       {std::vector{near_sphere.mesh(), far_sphere.mesh()}, std::vector{far_sphere.mesh(), near_sphere.mesh()}}) {
    const auto centre = pixel(draw(meshes), kWidth / 2, kHeight / 2);
    EXPECT_GT(centre[0], 150);
    EXPECT_LT(centre[2], 20);
  }
}

TEST_F(RendererTest, VertexColoursAreSeen) {
  Sphere sphere(1);
  for (std::size_t v = 0; v < sphere.positions.size(); v += 3) {
    const std::array<float, 3> colour = heat_colour(sphere.positions[v] > 0 ? 1.0f : 0.0f);
    sphere.colours.insert(sphere.colours.end(), colour.begin(), colour.end());
  }
  const Image image = draw({sphere.mesh()});
  const auto cool = pixel(image, kWidth / 2 - 12, kHeight / 2), hot = pixel(image, kWidth / 2 + 12, kHeight / 2);
  EXPECT_LT(std::abs(cool[0] - cool[2]), 50);  // nearly neutral
  EXPECT_GT(hot[0], hot[1] + 60);              // magenta
  EXPECT_GT(hot[2], hot[1] + 30);
}

TEST_F(RendererTest, CameraSeesTheWholeBoxFromEverySide) {
  Sphere sphere(1);
  sphere.colours.assign(sphere.positions.size(), 1.0f);
  for (const std::array<float, 3>& direction :
       {std::array<float, 3>{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {-1, 0.3f, -0.4f}, {0, 0, 0}}) {
    for (const auto& [width, height] : {std::pair{96u, 48u}, std::pair{48u, 96u}}) {
      const Camera camera =
          frame_box({-1, -1, -1}, {1, 1, 1}, direction, static_cast<float>(width) / static_cast<float>(height));
      const DrawMesh mesh = sphere.mesh();
      const Image image = renderer_->draw(std::span(&mesh, 1), camera, width, height);
      EXPECT_TRUE(covered(image, width / 2, height / 2));
      for (std::uint32_t x = 0; x < width; ++x) EXPECT_FALSE(covered(image, x, 0) || covered(image, x, height - 1));
      for (std::uint32_t y = 0; y < height; ++y) EXPECT_FALSE(covered(image, 0, y) || covered(image, width - 1, y));
    }
  }
}

TEST_F(RendererTest, FarFromTheOriginLooksTheSame) {
  Sphere sphere(1);
  const Image here = draw({sphere.mesh()});
  for (std::size_t i = 0; i < sphere.positions.size(); i += 3) sphere.positions[i] += 128;
  const Camera camera = frame_box({127, -1, -1}, {129, 1, 1}, kFront, static_cast<float>(kWidth) / kHeight);
  const DrawMesh mesh = sphere.mesh();
  const Image there = renderer_->draw(std::span(&mesh, 1), camera, kWidth, kHeight);
  int largest = 0;
  for (std::size_t i = 0; i < here.rgba.size(); ++i)
    largest = std::max(largest, std::abs(here.rgba[i] - there.rgba[i]));
  EXPECT_LE(largest, 8);
}

TEST_F(RendererTest, DrawsNothingAndDegenerateThings) {
  EXPECT_LT(brightness(pixel(draw({}), kWidth / 2, kHeight / 2)), 3 * 50);
  const std::vector<float> point(9, 0.25f), no_normals(9, 0.0f);
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  EXPECT_EQ(draw({{point, no_normals, triangle, {}}}).rgba, draw({}).rgba);
  const std::vector<float> flat{-1, -1, 0, 1, -1, 0, 0, 1, 0};
  EXPECT_TRUE(covered(draw({{flat, no_normals, triangle, {}}}), kWidth / 2, kHeight / 2));
  EXPECT_EQ(draw({}, 1, 1).rgba.size(), 4u);
}

TEST_F(RendererTest, RefusesWhatItCannotDraw) {
  const Sphere sphere(1);
  const std::vector<float> short_normals(6, 0.0f);
  const std::vector<std::uint32_t> beyond{0, 1, static_cast<std::uint32_t>(sphere.positions.size() / 3)}, two{0, 1};
  Sphere broken(1);
  broken.positions[5] = std::numeric_limits<float>::quiet_NaN();
  Sphere infinite(1);
  infinite.positions[5] = std::numeric_limits<float>::max();
  const std::vector<std::vector<DrawMesh>> refused = {
      {{sphere.positions, short_normals, sphere.triangles, {}}},
      {{sphere.positions, sphere.normals, sphere.triangles, short_normals}},
      {{sphere.positions, sphere.normals, beyond, {}}},
      {{sphere.positions, sphere.normals, two, {}}},
      {broken.mesh()},
      {infinite.mesh()}};
  for (const auto& meshes : refused) EXPECT_EQ(kind_of([&] { draw(meshes); }), ErrorKind::mismatch);
  EXPECT_EQ(kind_of([&] { draw({}, 0, 10); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { draw({}, 10, kMaxPictureSize + 1); }), ErrorKind::usage);
  Camera camera;
  camera.eye[0] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(kind_of([&] { renderer_->draw({}, camera, 8, 8); }), ErrorKind::usage);
  for (const float height : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Camera orthographic;
    orthographic.orthographic_height = height;
    EXPECT_EQ(kind_of([&] { renderer_->draw({}, orthographic, 8, 8); }), ErrorKind::usage);
  }
  EXPECT_EQ(kind_of([] { Renderer unknown("no such device"); }), ErrorKind::device);
}

TEST_F(RendererTest, ComparisonShowsTruthResultAndDistance) {
  const Sphere sphere(0.8f);
  std::vector<float> moved = sphere.positions;
  for (std::size_t v = 0; v < moved.size(); v += 3) {
    if (moved[v] > 0.05f) moved[v + 2] += 0.010f;  // the right half, by 10 mm
  }
  const PosePair pose{sphere.triangles, sphere.positions, moved};
  const Camera camera = frame_pose(pose, kFront, 1);
  const Image image = comparison(*renderer_, pose, 10, camera, 64, 64);
  ASSERT_EQ(image.width, 192u);
  ASSERT_EQ(image.height, 64u);
  const DrawMesh truth = sphere.mesh();
  const Image single = renderer_->draw(std::span(&truth, 1), camera, 64, 64);
  int largest = 0;  // normals from triangles differ a little from exact ones
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      largest = std::max(largest, std::abs(pixel(image, x, y)[0] - pixel(single, x, y)[0]));
    }
  }
  EXPECT_LE(largest, 24);
  const auto same = pixel(image, 128 + 32 - 12, 32), hot = pixel(image, 128 + 32 + 12, 32);
  EXPECT_LT(std::abs(same[0] - same[2]), 50);
  EXPECT_GT(hot[0], hot[1] + 60);
  EXPECT_EQ(kind_of([&] { comparison(*renderer_, pose, 0, camera, 8, 8); }), ErrorKind::usage);
  const PosePair unlike{sphere.triangles, sphere.positions, std::span(moved).first(3)};
  EXPECT_EQ(kind_of([&] { comparison(*renderer_, unlike, 1, camera, 8, 8); }), ErrorKind::mismatch);
}

TEST_F(RendererTest, ComparisonShowsSkinningBetweenTruthAndResult) {
  const Sphere sphere(0.8f), thin(0.4f);
  PosePair pose{sphere.triangles, sphere.positions, sphere.positions, thin.positions};
  const Camera camera = frame_pose(pose, kFront, 1);
  const Image image = comparison(*renderer_, pose, 10, camera, 64, 64);
  ASSERT_EQ(image.width, 256u);
  const auto rows_covered = [&](std::uint32_t panel) {
    int rows = 0;
    for (std::uint32_t y = 0; y < 64; ++y) rows += covered(image, 64 * panel + 32, y) ? 1 : 0;
    return rows;
  };
  EXPECT_NEAR(rows_covered(1), 0.5 * rows_covered(0), 3);
  EXPECT_EQ(rows_covered(2), rows_covered(0));
  EXPECT_EQ(rows_covered(3), rows_covered(0));
  pose.skinning = std::span(thin.positions).first(3);
  EXPECT_EQ(kind_of([&] { comparison(*renderer_, pose, 10, camera, 8, 8); }), ErrorKind::mismatch);
}

// A dent at the back is not to be seen from the front: the camera goes to its side.
TEST_F(RendererTest, ThePictureIsOfTheSideWhereTheShapesAreFurthestApart) {
  const Sphere sphere(0.8f);
  std::vector<float> dented = sphere.positions;
  for (std::size_t v = 0; v < dented.size(); v += 3) {
    const float depth = std::max(0.0f, -sphere.positions[v + 2] - 0.7f);
    dented[v + 2] += depth;
    dented[v] += 0.001f;
  }
  const PosePair pose{sphere.triangles, sphere.positions, dented};
  const std::array<float, 3> direction = towards_worst(pose);
  EXPECT_LT(direction[2], -0.95f);
  const auto hottest = [&](const std::array<float, 3>& from) {
    const Image image = comparison(*renderer_, pose, 100, frame_pose(pose, from, 1), 64, 64);
    int most = -255;
    for (std::uint32_t y = 0; y < 64; ++y) {
      for (std::uint32_t x = 128; x < 192; ++x) most = std::max(most, pixel(image, x, y)[0] - pixel(image, x, y)[2]);
    }
    return most;
  };
  EXPECT_GT(hottest(direction), hottest(kFront) + 60);
}

}  // namespace
}  // namespace bodyopt::testing
