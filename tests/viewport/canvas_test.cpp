#include "draw/canvas.h"

#include <cmath>

#include "draw/colours.h"
#include "shaders/include/layout.h"
#include "tests/draw/sphere.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {
namespace {

using namespace draw;

constexpr std::uint32_t kWidth = 128, kHeight = 96;

using Colour = std::array<double, 3>;

Colour pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

Colour centre(const Image& image) { return pixel(image, image.width / 2, image.height / 2); }

double brightness(const Colour& c) { return (c[0] + c[1] + c[2]) / 3; }

// Mean over pixels and channels, and the largest, of 255.
struct Difference {
  double mean = 0, largest = 0;
};
Difference difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  Difference d;
  for (std::size_t k = 0; k < a.rgba.size(); ++k) {
    const double off = std::abs(static_cast<double>(a.rgba[k]) - static_cast<double>(b.rgba[k]));
    d.mean += off / static_cast<double>(a.rgba.size());
    d.largest = std::max(d.largest, off);
  }
  return d;
}

// A sphere of radius 0.5 on the ground, seen from the front.
class CanvasTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    device_ = std::make_shared<const vulkan::Device>(test_device(), vulkan::DeviceUse{.draws = true});
    canvas_ = std::make_unique<Canvas>(*device_);
    const Sphere sphere(0.5f);
    positions_ = vulkan::upload(*device_, sphere.positions, "positions");
    normals_ = vulkan::upload(*device_, sphere.normals, "normals");
    triangles_ = vulkan::upload(*device_, sphere.triangles, "triangles");
    sphere_ = sphere;
  }
  static void TearDownTestSuite() {
    canvas_.reset();
    for (vulkan::Buffer* buffer : {&positions_, &normals_, &triangles_}) *buffer = {};
    const auto log = device_->validation_log();
    device_.reset();
    EXPECT_EQ(log->messages(), std::vector<std::string>());
  }
  void TearDown() override { EXPECT_EQ(device_->validation_messages(), std::vector<std::string>()); }

  static SkinDraw skin() {
    SkinDraw draw;
    draw.triangles = &triangles_;
    draw.triangle_count = static_cast<std::uint32_t>(sphere_.triangles.size() / 3);
    draw.positions = &positions_;
    draw.normals = &normals_;
    return draw;
  }

  static vulkan::Buffer moved_sphere(const std::array<float, 3>& by) {
    std::vector<float> positions = sphere_.positions;
    for (std::size_t k = 0; k < positions.size(); ++k) positions[k] += by[k % 3];
    return vulkan::upload(*device_, positions, "moved");
  }

  static View view(std::vector<SkinDraw> skins) {
    View view;
    view.camera = {{0, 0.4f, 3}, {0, 0, 0}, 0.5f};
    view.area = view.part = {0, 0, kWidth, kHeight};
    view.radius = 2;
    view.ground = {.grid = false, .height = -0.5f};
    view.skins = std::move(skins);
    return view;
  }

  static Image draw(const std::vector<View>& views, Edges edges = Edges::smooth) {
    canvas_->draw(views, kWidth, kHeight, edges);
    return canvas_->picture();
  }
  static Image draw(const View& view) { return draw(std::vector<View>{view}); }

  static inline std::shared_ptr<const vulkan::Device> device_;
  static inline std::unique_ptr<Canvas> canvas_;
  static inline vulkan::Buffer positions_, normals_, triangles_;
  static inline Sphere sphere_{0.5f};
};

TEST_F(CanvasTest, SameViewGivesTheSameBits) {
  const View seen = view({skin()});
  const Image first = draw(seen);
  ASSERT_EQ(first.rgba.size(), std::size_t{kWidth} * kHeight * 4);
  EXPECT_GT(brightness(centre(first)), 90);
  EXPECT_LT(brightness(pixel(first, 2, 2)), 60);
  for (std::size_t a = 3; a < first.rgba.size(); a += 4) ASSERT_EQ(first.rgba[a], 255);
  const View small = view({});
  canvas_->draw({&small, 1}, 31, 17, Edges::quick);  // another size between
  EXPECT_EQ(draw(seen).rgba, first.rgba);
  EXPECT_EQ(Canvas(*device_).seconds(), 0);
}

TEST_F(CanvasTest, PicturesOfNoPixelAndOfTooManyAreRefused) {
  const View seen = view({skin()});
  const auto draw = [&](std::uint32_t width, std::uint32_t height) {
    canvas_->draw({&seen, 1}, width, height, Edges::smooth);
  };
  const std::uint32_t most = canvas_->most_pixels();
  EXPECT_GE(most, 4096u);  // as every device of Vulkan has
  EXPECT_EQ(kind_of([&] { draw(0, 10); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { draw(10, 0); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { draw(most + 1, 10); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { draw(10, most + 1); }), ErrorKind::usage);
  draw(most, 1);
  EXPECT_EQ(canvas_->picture().width, most);
  draw(1, most);
  EXPECT_EQ(canvas_->picture().height, most);
}

TEST_F(CanvasTest, ViewsWithoutAPixelAreLeftOut) {
  View outside = view({skin()});
  outside.part = {kWidth + 5, 0, 10, kHeight};
  View nothing = view({skin()});
  nothing.part.width = 0;
  const Image image = draw({view({}), outside, nothing});
  EXPECT_EQ(image.rgba, draw(view({})).rgba);
}

TEST_F(CanvasTest, WipeShowsEachViewInItsPart) {
  View left = view({skin()}), right = view({skin()});
  right.skins[0].style = SurfaceStyle::normals;
  const Image whole_left = draw(left), whole_right = draw(right);
  const std::uint32_t at = 50;
  left.part.width = at;
  right.part.x = at;
  right.part.width = kWidth - at;
  const Image image = draw({left, right});
  int different = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      if (x == at - 1) continue;  // lavapipe scissors samples half a pixel too far out
      different += pixel(image, x, y) != pixel(x < at ? whole_left : whole_right, x, y);
    }
  }
  EXPECT_EQ(different, 0);
  EXPECT_GT(difference(whole_left, whole_right).mean, 5);
}

// What is lit keeps the colour's proportions: the hue can be found on the bar.
TEST_F(CanvasTest, HeatHasTheColourOfItsDistanceOnTheBar) {
  const float range = 0.02f;
  for (const float t : {0.0f, 0.2f, 0.5f, 0.8f, 1.0f, 3.0f}) {
    const vulkan::Buffer reference = moved_sphere({0, 0, -t * range});
    View seen = view({skin()});
    seen.skins[0].reference = &reference;
    seen.skins[0].heat_range = range;
    const Colour shown = centre(draw(seen));
    const std::array<float, 3> bar = heat_colour(std::min(1.0f, t));
    double shown_sum = 0, bar_sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      shown_sum += double{linear(static_cast<std::uint8_t>(shown[i]))};
      bar_sum += double{bar[i]};
    }
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(double{linear(static_cast<std::uint8_t>(shown[i]))} / shown_sum, double{bar[i]} / bar_sum, 0.015)
          << t << ", channel " << i;
    }
  }
}

TEST_F(CanvasTest, DistancesThatAreGivenLookAsThoseThatAreMeasured) {
  const vulkan::Buffer moved = moved_sphere({0, 0, -0.02f});
  const std::size_t count = sphere_.positions.size() / 3;
  std::vector<float> metres(2 * count, 0.02f);
  std::fill_n(metres.begin(), count, 1.0f);  // of another frame
  const vulkan::Buffer given = vulkan::upload(*device_, metres, "distances");
  View one = view({skin()}), two = one;
  one.skins[0].reference = &moved;
  two.skins[0].distances = &given;
  two.skins[0].first_reference = static_cast<std::uint32_t>(count);
  one.skins[0].heat_range = two.skins[0].heat_range = 0.03f;
  EXPECT_LE(difference(draw(one), draw(two)).largest, 1);
}

TEST_F(CanvasTest, AVertexHasItsOwnColour) {
  const std::size_t count = sphere_.positions.size() / 3;
  const std::array<float, 3> hot = heat_colour(0.5f);
  std::vector<float> colours(3 * count, 1.0f);  // of another frame
  for (std::size_t v = 0; v < count; ++v) colours.insert(colours.end(), hot.begin(), hot.end());
  const vulkan::Buffer given = vulkan::upload(*device_, colours, "colours");
  const vulkan::Buffer metres = vulkan::upload(*device_, std::vector<float>(count, 0.015f), "distances");
  View one = view({skin()}), two = one;
  one.skins[0].distances = &metres;
  one.skins[0].heat_range = 0.03f;
  two.skins[0].colours = &given;
  two.skins[0].first_reference = static_cast<std::uint32_t>(count);
  EXPECT_LE(difference(draw(one), draw(two)).largest, 1);

  for (std::size_t v = 0; v < count; ++v) {  // red where x is negative, otherwise blue
    const bool red = sphere_.positions[3 * v] < 0;
    const std::array<float, 3> own{red ? 0.6f : 0.0f, 0, red ? 0.0f : 0.6f};
    std::copy(own.begin(), own.end(), colours.begin() + static_cast<std::ptrdiff_t>(3 * v));
  }
  const vulkan::Buffer halves = vulkan::upload(*device_, colours, "colours");
  two.skins[0].colours = &halves;
  two.skins[0].first_reference = 0;
  const Image picture = draw(two);
  const Colour left = pixel(picture, kWidth / 2 - 12, kHeight / 2),
               right = pixel(picture, kWidth / 2 + 12, kHeight / 2);
  EXPECT_GT(left[0], left[2] + 60);
  EXPECT_GT(right[2], right[0] + 60);
}

TEST_F(CanvasTest, HeatIsMeasuredFrameByFrame) {
  const vulkan::Buffer far = moved_sphere({0, 0, -0.02f});
  std::vector<float> both = sphere_.positions;
  for (std::size_t k = 0; k < sphere_.positions.size(); ++k) {
    both.push_back(sphere_.positions[k] - (k % 3 == 2 ? 0.02f : 0.0f));
  }
  const vulkan::Buffer batch = vulkan::upload(*device_, both, "two frames");
  View one = view({skin()}), two = one;
  one.skins[0].reference = &far;
  two.skins[0].reference = &batch;
  two.skins[0].first_reference = static_cast<std::uint32_t>(sphere_.positions.size() / 3);
  one.skins[0].heat_range = two.skins[0].heat_range = 0.03f;
  EXPECT_EQ(draw(one).rgba, draw(two).rgba);
}

TEST_F(CanvasTest, FrameOfABatchIsDrawnFromItsFirstVertex) {
  std::vector<float> both(sphere_.positions.size(), 0.0f), normals = both;
  both.insert(both.end(), sphere_.positions.begin(), sphere_.positions.end());
  normals.insert(normals.end(), sphere_.normals.begin(), sphere_.normals.end());
  const vulkan::Buffer positions = vulkan::upload(*device_, both, "frames"),
                       normal_buffer = vulkan::upload(*device_, normals, "normals");
  View second = view({skin()});
  second.skins[0].positions = &positions;
  second.skins[0].normals = &normal_buffer;
  second.skins[0].first_vertex = static_cast<std::uint32_t>(sphere_.positions.size() / 3);
  EXPECT_EQ(draw(second).rgba, draw(view({skin()})).rgba);
}

TEST_F(CanvasTest, OffsetMovesTheSkin) {
  const vulkan::Buffer moved = moved_sphere({0.3f, 0.25f, -0.1f});
  View by_offset = view({skin()}), by_positions = by_offset;
  by_offset.skins[0].offset = {0.3f, 0.25f, -0.1f};
  by_positions.skins[0].positions = &moved;
  const Difference d = difference(draw(by_offset), draw(by_positions));
  EXPECT_LT(d.mean, 0.02);
  EXPECT_GT(difference(draw(by_offset), draw(view({skin()}))).mean, 5);
}

TEST_F(CanvasTest, AsManySkinsAsThereAreAreDrawn) {
  View crowd = view({});
  SkinDraw hidden = skin();
  hidden.offset = {0, 0, -1.2f};
  for (int k = 0; k < 1500; ++k) crowd.skins.push_back(hidden);
  crowd.skins.push_back(skin());
  View few = crowd;
  few.skins = {hidden, skin()};
  EXPECT_EQ(draw(crowd).rgba, draw(few).rgba);
  EXPECT_EQ(draw(crowd).rgba, draw(few).rgba);  // the sets are used again
}

TEST_F(CanvasTest, GhostsAreSeenThrough) {
  View ghost = view({skin()});
  ghost.skins[0].alpha = 0.5f;
  ghost.skins[0].shadow = false;
  View opaque = view({skin()});
  opaque.skins[0].shadow = false;
  const Image seen = draw(ghost), solid = draw(opaque), nothing = draw(view({}));
  EXPECT_GT(brightness(centre(seen)), brightness(centre(nothing)) + 5);
  EXPECT_LT(brightness(centre(seen)), brightness(centre(solid)) - 20);
  // Behind the skin it hides nothing, before it, it is seen.
  View behind = opaque, before = opaque;
  SkinDraw other = ghost.skins[0];
  other.colour = {0, 0, 1};
  other.offset = {0, 0, -1.2f};
  behind.skins.push_back(other);
  EXPECT_EQ(centre(draw(behind)), centre(solid));
  other.offset = {0, 0, 0.6f};
  before.skins.push_back(other);
  const Colour blended = centre(draw(before));
  EXPECT_GT(centre(solid)[0] - blended[0], centre(solid)[2] - blended[2] + 5);
}

TEST_F(CanvasTest, QuickIsAlmostSmooth) {
  View seen = view({skin()});
  seen.ground.grid = true;
  const Image smooth = draw({seen}), quick = draw({seen}, Edges::quick);
  const Difference d = difference(smooth, quick);
  EXPECT_LT(d.mean, 1.5);
  EXPECT_GT(d.largest, 10);  // at edges
  EXPECT_EQ(centre(smooth), centre(quick));
}

TEST_F(CanvasTest, ShadowLiesOnTheGroundUnderTheSkin) {
  View lit = view({skin()});
  lit.camera.eye = {0, 2.5f, 2.5f};
  View bright = lit;
  bright.ground.shadow = 0;
  View without = lit;
  without.skins[0].shadow = false;
  const Image shaded = draw(lit), plain = draw(bright);
  EXPECT_EQ(draw(without).rgba, plain.rgba);
  EXPECT_EQ(centre(shaded), centre(plain));  // of the skin itself
  int darker = 0, brighter = 0;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double change = brightness(pixel(shaded, x, y)) - brightness(pixel(plain, x, y));
      darker += change < -3;
      brighter += change > 0;
    }
  }
  EXPECT_GT(darker, 100);
  EXPECT_EQ(brighter, 0);
  EXPECT_EQ(pixel(shaded, 0, 0), pixel(plain, 0, 0));
}

// In a wide view as in that of one caster: by the share of the ground's light that it takes.
TEST_F(CanvasTest, ShadowIsAsSharpInAWideView) {
  const auto shade = [&](float radius) {
    View shaded = view({skin()});
    shaded.camera.eye = {0, 2.5f, 2.5f};
    shaded.radius = radius;
    shaded.ground.caster = 2;
    View plain = shaded;
    plain.ground.shadow = 0;
    const Image with = draw(shaded), without = draw(plain);
    std::vector<double> share;
    for (std::size_t k = 0; k < with.rgba.size(); k += 4) {
      share.push_back(double{linear(with.rgba[k])} / std::max(1e-3, double{linear(without.rgba[k])}));
    }
    return share;
  };
  const std::vector<double> one = shade(2), wide = shade(4);
  EXPECT_LT(*std::ranges::min_element(one), 0.5);
  double largest = 0;
  for (std::size_t k = 0; k < one.size(); ++k) largest = std::max(largest, std::abs(one[k] - wide[k]));
  EXPECT_LT(largest, 0.06);
}

TEST_F(CanvasTest, EveryStyleIsAnother) {
  std::vector<Image> images;
  for (const SurfaceStyle style :
       {SurfaceStyle::clay, SurfaceStyle::matcap, SurfaceStyle::flat, SurfaceStyle::normals}) {
    View seen = view({skin()});
    seen.skins[0].style = style;
    images.push_back(draw(seen));
    for (std::size_t k = 0; k + 1 < images.size(); ++k) EXPECT_GT(difference(images.back(), images[k]).largest, 8) << k;
  }
  // Normals towards the camera are blue (z), those to the right red (x), those upwards green (y).
  const Image& normals = images.back();
  const Colour middle = centre(normals), right = pixel(normals, kWidth / 2 + 24, kHeight / 2),
               top = pixel(normals, kWidth / 2, kHeight / 2 - 24);
  EXPECT_GT(middle[2], middle[0] + 60);
  EXPECT_GT(right[0], middle[0] + 30);
  EXPECT_GT(top[1], middle[1] + 30);
}

TEST_F(CanvasTest, WireDarkensEdges) {
  View plain = view({skin()}), wire = plain;
  wire.skins[0].wire = true;
  const Image with = draw(wire), without = draw(plain);
  double sum_with = 0, sum_without = 0;
  for (std::uint32_t y = 38; y < 58; ++y) {
    for (std::uint32_t x = 54; x < 74; ++x) {
      sum_with += brightness(pixel(with, x, y));
      sum_without += brightness(pixel(without, x, y));
    }
  }
  EXPECT_LT(sum_with, 0.95 * sum_without);
}

TEST_F(CanvasTest, LinesAreHiddenBySkinsUnlessOnTop) {
  const std::uint32_t red = 0xff0000ff;
  const std::vector<LinePoint> line = {{-0.9f, 0, 0, red}, {0.9f, 0, 0, red}};
  for (const bool on_top : {false, true}) {
    View seen = view({skin()});
    seen.lines.push_back({line, {}, 3, on_top});
    const Image image = draw(seen);
    const Colour middle = centre(image), beside = pixel(image, kWidth / 2 + 42, kHeight / 2);
    EXPECT_EQ(middle[0] > middle[1] + 100, on_top);
    EXPECT_GT(beside[0], beside[1] + 100);
  }
}

TEST_F(CanvasTest, FibresLieOnTheSkin) {
  // A fibre around the equator, its points in triangles of the sphere's middle row.
  std::vector<FibrePoint> points;
  std::vector<FibreSegment> segments;
  for (std::uint32_t k = 0; k <= 48; ++k) {
    const std::uint32_t vertex = 12 * 49 + k;
    points.push_back({vertex, vertex, vertex, 0.25f, 0.25f, 0.5f});
    if (k > 0) segments.push_back({k - 1, k, 0});
  }
  const vulkan::Buffer point_buffer = vulkan::upload(*device_, points, "points"),
                       segment_buffer = vulkan::upload(*device_, segments, "segments");
  const std::vector<std::uint32_t> colours = {0xff00ff00};
  FibreDraw fibres;
  fibres.segments = &segment_buffer;
  fibres.segment_count = 48;
  fibres.points = &point_buffer;
  fibres.positions = &positions_;
  fibres.normals = &normals_;
  fibres.colours = colours;
  fibres.lift = 0.002f;
  fibres.width = 4;
  View seen = view({skin()});
  seen.camera = {{0, 0, 3}, {0, 0, 0}, 0.5f};
  seen.fibres = {fibres};
  const Image image = draw(seen);
  const Colour on = centre(image), off = pixel(image, kWidth / 2, kHeight / 2 - 15);
  EXPECT_GT(on[1], on[0] + 100);
  EXPECT_LT(off[1], off[0] + 20);
}

TEST_F(CanvasTest, PanelsAreDrawnOverTheScene) {
  bool called = false;
  const View seen = view({skin()});
  canvas_->draw({&seen, 1}, kWidth, kHeight, Edges::smooth, [&](VkCommandBuffer commands) {
    called = true;
    VkClearAttachment clear{};
    clear.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    clear.clearValue.color = {{0.5f, 0.25f, 1, 1}};
    const VkClearRect part{{{0, 0}, {10, kHeight}}, 0, 1};
    const auto clear_attachments = reinterpret_cast<PFN_vkCmdClearAttachments>(
        vkGetInstanceProcAddr(device_->instance(), "vkCmdClearAttachments"));
    clear_attachments(commands, 1, &clear, 1, &part);
  });
  EXPECT_TRUE(called);
  const Image image = canvas_->picture(), plain = draw(seen);
  EXPECT_EQ(pixel(image, 5, 50), (Colour{128, 64, 255}));  // its bytes, as they are
  EXPECT_EQ(pixel(image, 11, 50), pixel(plain, 11, 50));
}

}  // namespace
}  // namespace bodyopt::testing
