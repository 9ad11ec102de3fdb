// Characters in their own colours, from the file to the pixels.
#include <gtest/gtest.h>

#include "assets/gltf/gltf_file.h"
#include "draw/canvas.h"
#include "draw/colours.h"
#include "shots/shot_files.h"
#include "tests/assets/gltf_blob.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "viewport/application.h"
#include "viewport/scene/scene.h"

namespace bodyopt::testing {
namespace materials_test {

using namespace shots;
using namespace draw;
using namespace viewport;

using Colour = std::array<std::uint8_t, 4>;
constexpr Colour kRed{200, 0, 0, 255}, kGreen{0, 200, 0, 255}, kBlue{0, 0, 200, 255}, kGrey{188, 188, 188, 255};
constexpr std::uint32_t kWide = 160, kHigh = 120;

// A square whose material has an image of 2 x 2 pixels, from the upper left.
GltfBlob pictured_square(const std::array<Colour, 4>& pixels) {
  GltfBlob blob = two_joint_square();
  Image image{2, 2, {}};
  for (const Colour& pixel : pixels) image.rgba.insert(image.rgba.end(), pixel.begin(), pixel.end());
  const std::vector<std::uint8_t> png = encode_png(image);
  blob.add(png, 5121, "SCALAR", 1);
  blob.root["accessors"].erase(blob.root["accessors"].size() - 1);
  blob.root["images"] = {{{"name", "square"}, {"bufferView", blob.root["bufferViews"].size() - 1}}};
  blob.root["samplers"] = {{{"magFilter", 9728}}};
  blob.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  blob.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  Json& primitive = blob.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = blob.add(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, 5126, "VEC2", 2);
  primitive["material"] = 0;
  return blob;
}

GltfBlob plain_square(double grey) {
  GltfBlob blob = pictured_square({kRed, kRed, kRed, kRed});
  blob.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, 1}}}}}};
  return blob;
}

class Materials : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    device_ = std::make_shared<const vulkan::Device>(test_device(), vulkan::DeviceUse{.draws = true});
    canvas_ = std::make_unique<Canvas>(*device_);
  }
  static void TearDownTestSuite() {
    canvas_.reset();
    device_.reset();
  }
  void TearDown() override { EXPECT_EQ(device_->validation_messages(), std::vector<std::string>()); }

  // From the front, without perspective: 40 pixels a metre, the square in the middle.
  Image picture(const GltfBlob& blob, LookStyle style = LookStyle::material, bool wire = false) {
    put_bytes(folder_ / "square.glb", blob.glb());
    Scene scene(device_);
    scene.add({(folder_ / "square.glb").string()}, {});
    notes_ = scene.lead().notes();
    Controls controls;
    controls.settings.look.style = style;
    controls.settings.look.wire = wire;
    controls.settings.look.shadow = false;
    std::vector<View> views = scene.look(controls, {0, 0, kWide, kHigh});
    views.at(0).camera = {{0.5f, 1, 5}, {0.5f, 1, 0}, 0.5f, 3};
    views[0].ground.grid = views[0].ground.axes = false;
    canvas_->draw(views, kWide, kHigh, Edges::smooth);
    return canvas_->picture();
  }

  // Beside the middle, right and up, a fraction of the square's sides.
  static Colour at(const Image& image, int right, int up) {
    const std::size_t pixel =
        (kHigh / 2 - static_cast<std::size_t>(20 * up)) * kWide + kWide / 2 + static_cast<std::size_t>(8 * right);
    return {image.rgba[4 * pixel], image.rgba[4 * pixel + 1], image.rgba[4 * pixel + 2], image.rgba[4 * pixel + 3]};
  }
  static void expect_mostly(std::size_t channel, const Colour& colour) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (c != channel) {
        EXPECT_GT(colour[channel], colour[c] + 60) << "channel " << channel << " against " << c;
      }
    }
  }
  static void expect_alike(const Colour& a, const Colour& b) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 2) << "channel " << c;
  }

  static inline std::shared_ptr<const vulkan::Device> device_;
  static inline std::unique_ptr<Canvas> canvas_;
  TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

TEST_F(Materials, AnImageStandsUprightOnTheSkin) {
  const Image image = picture(pictured_square({kRed, kGreen, kBlue, kGrey}));
  expect_mostly(0, at(image, -1, 1));
  expect_mostly(1, at(image, 1, 1));
  expect_mostly(2, at(image, -1, -1));
  for (const int right : {-1, 1}) EXPECT_EQ(at(image, right, 1)[3], 255);
  const Image edges = picture(pictured_square({kRed, kGreen, kBlue, kGrey}), LookStyle::material, true);
  expect_mostly(1, at(edges, 1, 1));
  EXPECT_GT(spot_difference(image, edges).mean, 0.1);
}

// Those who take the bytes of an image for light show 0.5 where 0.74 belongs.
TEST_F(Materials, AnImageIsInSrgbAndAFactorIsLight) {
  const Image factor = picture(plain_square(double{linear(188)}));
  expect_alike(at(factor, 1, 1), at(picture(pictured_square({kGrey, kGrey, kGrey, kGrey})), 1, 1));
  GltfBlob own = plain_square(1);
  const float light = linear(188);
  own.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = own.vectors(std::vector<float>(12, light));
  expect_alike(at(factor, 1, 1), at(picture(own), 1, 1));
}

// The key light is at the upper left of the picture; of an image the bottom is where v is 1.
TEST_F(Materials, ANormalMapLeansAsItsPixelsSay) {
  const auto light = [&](const Colour& normal, double scale) {
    GltfBlob blob = pictured_square({normal, normal, normal, normal});
    Json& material = blob.root["materials"][0];
    Json texture = material["pbrMetallicRoughness"].at("baseColorTexture");
    material["pbrMetallicRoughness"] = {{"baseColorFactor", {0.2, 0.2, 0.2, 1}}};
    texture["scale"] = scale;
    material["normalTexture"] = texture;
    const Colour shown = at(picture(blob), 1, 1);
    return int{shown[0]};
  };
  const int plain = light({128, 128, 255, 255}, 1), left = light({64, 128, 240, 255}, 1);
  EXPECT_NEAR(plain, at(picture(plain_square(0.2)), 1, 1)[0], 1);
  EXPECT_GT(left, plain + 10);
  EXPECT_LT(light({192, 128, 240, 255}, 1), plain - 10);
  EXPECT_GT(light({128, 192, 240, 255}, 1), plain + 10);
  EXPECT_LT(light({128, 64, 240, 255}, 1), plain - 10);
  EXPECT_NEAR(light({64, 128, 240, 255}, 0), plain, 1);
  EXPECT_LT(light({64, 128, 240, 255}, 0.5), left - 3);
}

// Seen along the light that it reflects. Of a map it is green, times the material's number.
TEST_F(Materials, WhatIsSmoothShines) {
  const Colour leaning{78, 178, 233, 255};
  const auto light = [&](double factor, bool is_mapped) {
    GltfBlob blob = pictured_square({leaning, leaning, leaning, leaning});
    Json& own = blob.root["materials"][0]["pbrMetallicRoughness"];
    const Json texture = own.at("baseColorTexture");
    own = {{"baseColorFactor", {0.1, 0.1, 0.1, 1}}, {"roughnessFactor", factor}};
    if (is_mapped) own["metallicRoughnessTexture"] = texture;
    blob.root["materials"][0]["normalTexture"] = texture;
    return int{at(picture(blob), 1, 1)[0]};
  };
  EXPECT_GT(light(0.2, false), light(1, false) + 30);
  EXPECT_GT(light(178.0 / 255, false), light(1, false) + 3);
  EXPECT_NEAR(light(1, true), light(178.0 / 255, false), 1);
}

TEST_F(Materials, EachTriangleHasItsOwn) {
  GltfBlob blob = pictured_square({kRed, kRed, kRed, kRed});
  blob.root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0.6, 1}}}}});
  Json& primitives = blob.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 1;
  primitives[0]["indices"] = blob.add(std::vector<std::uint16_t>{0, 1, 2}, 5123, "SCALAR", 1);
  primitives[1]["indices"] = blob.add(std::vector<std::uint16_t>{0, 2, 3}, 5123, "SCALAR", 1);
  const Image image = picture(blob);
  expect_mostly(0, at(image, 1, -1));
  expect_mostly(2, at(image, -1, 1));
}

TEST_F(Materials, AnImageIsTurnedAsItsMaterialSays) {
  GltfBlob blob = pictured_square({kRed, kGreen, kBlue, kGrey});
  blob.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0}}};
  const Image moved = picture(blob);
  expect_mostly(1, at(moved, -1, 1));
  expect_mostly(0, at(moved, 1, 1));  // round again
  blob.root["samplers"][0]["wrapS"] = 33071;
  expect_mostly(1, at(picture(blob), 1, 1));
}

TEST_F(Materials, WhereAnImageHasNoAlphaIsAHole) {
  GltfBlob blob = pictured_square({kRed, {0, 200, 0, 0}, kRed, {0, 200, 0, 0}});
  const Image opaque = picture(blob);
  expect_mostly(1, at(opaque, 1, 1));
  for (const char* mode : {"MASK", "BLEND"}) {
    blob.root["materials"][0]["alphaMode"] = mode;
    const Image holed = picture(blob);
    expect_mostly(0, at(holed, -1, 1));
    EXPECT_LT(at(holed, 1, 1)[1], 60) << mode;
    EXPECT_EQ(at(holed, 1, 1)[3], 255) << mode;
  }
}

TEST_F(Materials, OtherLooksTakeTheirPlace) {
  const GltfBlob blob = pictured_square({kGreen, kGreen, kGreen, kGreen});
  const Colour clay = at(picture(blob, LookStyle::clay), 1, 1);
  EXPECT_LT(clay[1], clay[0]);
  const Image black = picture(blob, LookStyle::silhouette);
  EXPECT_EQ(at(black, 1, 1), (Colour{0, 0, 0, 255}));
  EXPECT_GT(black.rgba[0], 180);
  EXPECT_TRUE(picture(two_joint_square()).rgba == picture(two_joint_square(), LookStyle::clay).rgba);
}

TEST_F(Materials, WhatIsWornHasItsOwn) {
  GltfBlob blob = pictured_square({kRed, kRed, kRed, kRed});
  const std::size_t patch = blob.vectors({0.5f, 1, 0.05f, 1, 1, 0.05f, 1, 2, 0.05f, 0.5f, 2, 0.05f});
  blob.root["materials"].push_back(
      {{"name", "cloth"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0.6, 1}}}}});
  blob.root["meshes"].push_back({{"primitives",
                                  {{{"attributes", {{"POSITION", patch}}},
                                    {"indices", blob.root["meshes"][0]["primitives"][0]["indices"]},
                                    {"material", 1}}}}});
  blob.root["nodes"].push_back({{"name", "patch"}, {"mesh", 1}, {"translation", {0, -1, 0}}});
  blob.root["nodes"][1]["children"] = {3};
  const Image image = picture(blob);
  expect_mostly(2, at(image, 1, 1));
  expect_mostly(0, at(image, -1, 1));
  const std::string file = (folder_ / "square.glb").string();
  const OpenedCharacter opened = open_character(file, {});
  const std::vector<SkinSurface> worn = attached_surfaces(file, opened.levels.at(0).basis, opened.attached, {});
  ASSERT_EQ(worn.size(), 1u);
  EXPECT_EQ(worn[0].materials.at(0).name, "cloth");
}

TEST_F(Materials, OfAnImageThatChangesTheyAreMadeAnew) {
  const std::filesystem::path image = folder_ / "beside.png";
  put_bytes(image, "none");
  GltfBlob blob = pictured_square({kRed, kRed, kRed, kRed});
  blob.root["images"] = {{{"uri", "beside.png"}}};
  put_bytes(folder_ / "square.glb", blob.glb());
  Scene scene(device_);
  scene.add({(folder_ / "square.glb").string()}, {});
  const std::vector<std::filesystem::path> paths = scene.lead().paths();
  EXPECT_NE(std::ranges::find(paths, std::filesystem::weakly_canonical(image)), paths.end());
  LevelPool pool;
  const auto make = [&] {
    auto made = std::make_shared<CharacterMaterials>();
    made->files = {image};
    return made;
  };
  const LevelPool::Materials first = pool.materials({}, make);
  EXPECT_EQ(pool.materials({}, make), first);
  put_bytes(image, "another");
  EXPECT_NE(pool.materials({}, make), first);
}

// Of a basis whose character is not beside it: where the clip's file has the same skin, and only there.
TEST_F(Materials, AreTheClipsWhereItHasTheSkin) {
  const std::filesystem::path shots = folder_ / "shots";
  std::filesystem::create_directory(shots);
  GltfBlob blob = pictured_square({kGreen, kGreen, kGreen, kGreen});
  blob.root["animations"] = Json::array({{{"samplers", Json::array()}, {"channels", Json::array()}}});
  animate(blob, 1, "translation", {0, 1}, {0, 1, 0, 0, 1.1f, 0});
  put_bytes(shots / "walk.glb", blob.glb());
  const std::string file = (shots / "walk.glb").string(), basis = (folder_ / "square.safetensors").string();
  save_basis(open_character(file, {}).levels.at(0).basis, basis);
  Scene scene(device_);
  scene.add({basis}, {});
  EXPECT_EQ(scene.lead().materials(), nullptr);
  const Skeleton skeleton = scene.lead().basis().skeleton;
  write_clip(still_clip(skeleton, {}), skeleton, shots / "still.glb");
  scene.lead().open_clip((shots / "still.glb").string());
  EXPECT_EQ(scene.lead().materials(), nullptr);
  EXPECT_TRUE(scene.lead().notes().empty());
  scene.add({.basis = basis, .clip = file}, {});
  ASSERT_NE(scene.cast().back()->materials(), nullptr);
  EXPECT_FALSE(scene.cast().back()->materials()->parts.empty());
  EXPECT_TRUE(scene.cast().back()->notes().empty()) << "it is guessed";
}

// So does what is exported of it, by the viewport and of its session.
TEST_F(Materials, OfTheClipAreExported) {
  GltfBlob blob = pictured_square({kGreen, kGreen, kGreen, kGreen});
  blob.root["animations"] = Json::array({{{"samplers", Json::array()}, {"channels", Json::array()}}});
  animate(blob, 1, "translation", {0, 1}, {0, 1, 0, 0, 1.1f, 0});
  const std::string clip = (folder_ / "walk.glb").string(), basis = (folder_ / "square.safetensors").string();
  put_bytes(clip, blob.glb());
  save_basis(open_character(clip, {}).levels.at(0).basis, basis);
  const std::string seen = (folder_ / "seen.glb").string(), session = (folder_ / "s.json").string(),
                    evaluated = (folder_ / "evaluated.glb").string();
  ViewerOptions options;
  options.files = {basis, clip};
  options.headless = true;
  options.commands = "export-skin " + seen + "; save " + session + "; quit";
  Application(options, device_, nullptr).make_pictures();
  const ProgramResult result = run_verb("eval --session " + session + " --device cpu --out " + evaluated);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(result.output.find("no texture coordinates"), std::string::npos) << result.output;
  const std::vector<std::uint32_t> corners = load_basis(basis).mesh.output_triangles;
  for (const std::string& file : {seen, evaluated}) {
    const GltfFile exported(file);
    const auto skin = std::ranges::find_if(exported.model().nodes, [](const auto& node) { return node.mesh >= 0; });
    MaterialReader reader(exported);
    const SkinSurface surface =
        read_node_surface(reader, static_cast<std::size_t>(skin - exported.model().nodes.begin()), corners);
    EXPECT_EQ(surface.materials.size(), 1u) << file;
    EXPECT_EQ(surface.textures.size(), 1u) << file;
    EXPECT_EQ(surface.texture.size(), 8u) << file;
  }
}

// Which has no coordinates: it shows what the skin that it stands for has there.
TEST_F(Materials, ACoarserLevelHasTheColoursOfTheFinest) {
  GltfBlob blob = pictured_square({kRed, kGreen, kRed, kGreen});
  blob.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      blob.add(std::vector<float>{0.2f, 0.8f, 0.8f, 0.8f, 0.8f, 0.2f, 0.2f, 0.2f}, 5126, "VEC2", 2);
  put_bytes(folder_ / "square.glb", blob.glb());
  const std::string file = (folder_ / "square.glb").string();
  const Basis basis = open_character(file, {}).levels.at(0).basis;
  const auto materials = make_character_materials(*device_, file, {&basis, &basis}, {});
  Scene scene(device_);
  scene.add({file}, {});
  Controls controls;
  std::vector<View> views = scene.look(controls, {0, 0, kWide, kHigh});
  ASSERT_EQ(materials->skin.size(), 2u);
  views.at(0).camera = {{0.5f, 1, 5}, {0.5f, 1, 0}, 0.5f, 3};
  views[0].skins.at(0).materials = &materials->skin[1];
  canvas_->draw(views, kWide, kHigh, Edges::smooth);
  const Image image = canvas_->picture();
  EXPECT_GT(at(image, -1, 1)[0], at(image, 1, 1)[0] + 20);
  EXPECT_GT(at(image, 1, 1)[1], at(image, -1, 1)[1] + 20);
}

// Images that are none, cut off, or not there.
TEST_F(Materials, WhatCannotBeReadShowsTheMaterialsColourAndIsTold) {
  GltfBlob blob = pictured_square({kRed, kRed, kRed, kRed});
  blob.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0.6, 1};
  const std::size_t view = blob.root["images"][0]["bufferView"];
  const auto expect_blue = [&](const std::string& why) {
    expect_mostly(2, at(picture(blob), 1, 1));
    const auto is_told = [&](const std::string& note) {
      return note.find("square.glb: image 'square'") != std::string::npos && note.find(why) != std::string::npos;
    };
    EXPECT_EQ(std::ranges::count_if(notes_, is_told), 1) << why;
  };
  Json& length = blob.root["bufferViews"][view]["byteLength"];
  length = length.get<std::size_t>() - 20;
  expect_blue("is a damaged PNG, or cut off");
  length = 4;
  expect_blue("is neither PNG, JPEG nor WebP");
  length = 4000000;
  expect_blue("reaches beyond the buffer");
  blob.root["images"][0] = {{"name", "square"}, {"uri", "not_there.png"}};
  expect_blue("not_there.png");
  blob.root["images"][0]["uri"] = "../outside.png";
  expect_blue("lies outside the file's folder");
}

}  // namespace materials_test
}  // namespace bodyopt::testing
