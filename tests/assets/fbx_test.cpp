// FBX against its own formula, evaluated factor by factor in double precision.
#include <gtest/gtest.h>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "assets/gltf/gltf_animation.h"
#include "assets/gltf/gltf_nodes.h"
#include "assets/gltf/gltf_skin.h"
#include "assets/gltf/skin_surface.h"
#include "runtime/host/rig.h"
#include "tests/assets/gltf_blob.h"
#include "tests/assets/random_fbx.h"
#include "tests/support/hostile_bytes.h"

namespace bodyopt {
namespace {

using testing::FbxMaker;
using testing::Vector;
using testing::vector_of;
using testing::WrittenCluster;
using testing::WrittenCurve;
using testing::WrittenFbx;
using testing::WrittenMesh;
using testing::WrittenModel;

constexpr double kMetres = 2e-6;       // single precision of what is written to .glb on the way
constexpr double kBetweenKeys = 1e-4;  // a chain of joints adds up what each may be off

TEST(Fbx, NodesStandAsTheFormulaSays) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    FbxMaker maker(seed);
    WrittenFbx file = maker.frame();
    for (int k = 0; k < 12; ++k) file.models.push_back(maker.model(file, k == 0 ? -1 : maker.whole(-1, k - 1), true));
    const GltfFile read("tree.fbx", file.text());
    std::vector<std::string> notes;
    const NodeTree tree = read_nodes(read, 1, notes);
    ASSERT_EQ(tree.order.size(), file.models.size());
    std::vector<Affine> world(tree.order.size());
    for (const std::size_t n : tree.order) {
      const Affine local = affine_from(tree.local[n]);
      EXPECT_NEAR(tree.local[n].scale[0], 1, 1e-6);
      world[n] = tree.parent[n] < 0 ? local : world[static_cast<std::size_t>(tree.parent[n])] * local;
      const int model = std::stoi(read.model().nodes[n].name.substr(4));
      const Eigen::Affine3d expected = file.to_ours() * file.world(model, 0);
      double scale = 1;  // that is in what the node carries
      for (int at = model; at >= 0; at = file.models[static_cast<std::size_t>(at)].parent) {
        scale *= file.models[static_cast<std::size_t>(at)].scale[0];
      }
      for (const Vector& point : {Vector{0, 0, 0}, Vector{1, 2, 3}}) {
        const Vector in_metres = scale * file.unit / 100 * point;
        const Vector found = vector_of(world[n] * Vec3{in_metres[0], in_metres[1], in_metres[2]});
        EXPECT_LT((found - expected * point).norm(), kMetres * (1 + found.norm())) << "seed " << seed;
      }
    }
  }
}

// Corners of one point lie elsewhere in the image, polygons are of two materials; the points stay as they are.
TEST(Fbx, CornersKeepTheirPlacesInImages) {
  const TemporaryFolder folder;
  WrittenFbx file;
  file.models = {{.name = "sheet", .type = "Mesh"}};
  WrittenMesh sheet;
  sheet.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  sheet.polygons = {0, 1, 2, ~std::int64_t{3}, 1, 4, ~std::int64_t{2}};
  sheet.texture = {0, 0, 0.5, 0, 0.5, 1, 0, 1, 0.75, 0.25};
  sheet.texture_of = {0, 1, 2, 3, 4, 1, 4};
  sheet.material_of = {1, 0};
  file.meshes = {sheet};
  const std::string png = "\x89PNG\r\n\x1a\n of skin", jpeg = "\xff\xd8\xff of cloth";
  file.materials = {{.name = "cloth", .image = "no image", .file = "..\\elsewhere\\100%.jpg"},
                    {.name = "skin", .image = png},
                    {.name = "skin too", .shares = 1}};
  std::filesystem::create_directory(folder / "sheet.fbm");
  put_bytes(folder / "sheet.fbm" / "100%.jpg", jpeg);
  put_bytes(folder / "sheet.fbx", file.binary(7400, true));
  const GltfFile read(folder / "sheet.fbx");
  std::vector<std::string> unused;
  const SkinGeometry geometry = read_node_geometry(read, 0, unused);
  ASSERT_EQ(geometry.positions.size(), 5u);
  std::vector<std::uint32_t> corners, turned;
  for (const auto& [a, b, c] : geometry.triangles) {
    corners.insert(corners.end(), {a, b, c});
    turned.insert(turned.end(), {a, c, b});
  }
  MaterialReader reader(read);
  const SkinSurface surface = read_node_surface(reader, 0, corners);
  EXPECT_EQ(surface.notes, std::vector<std::string>());
  ASSERT_EQ(surface.material_of.size(), 3u);
  const auto image_of = [&](std::size_t triangle) {
    const SurfaceMaterial& material = surface.materials[surface.material_of[triangle]];
    return *surface.textures.at(material.texture()->at("index").get<std::size_t>()).bytes;
  };
  EXPECT_EQ(image_of(0), png);
  EXPECT_EQ(image_of(1), png);
  EXPECT_EQ(image_of(2), jpeg);
  const auto at = [&](std::size_t c) {
    const std::size_t row = surface.row(corners, c);
    return std::array{surface.texture[2 * row], surface.texture[2 * row + 1]};
  };
  const std::array<double, 2> first[] = {{0, 1}, {0.5, 1}, {0.5, 0}, {0, 0}}, torn{0.75, 0.75};  // v from above
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(at(c), first[corners[c]]) << c;
  EXPECT_EQ(at(6), torn);  // of point 1, which the other polygon has elsewhere
  const SkinSurface mirrored = read_node_surface(reader, 0, turned);
  for (std::size_t c = 0; c < 9; c += 3) {
    EXPECT_EQ(mirrored.texture_of[c + 1], surface.texture_of[c + 2]);
    EXPECT_EQ(mirrored.texture_of[c + 2], surface.texture_of[c + 1]);
  }
  const SplitSurface split = split_corners(surface, corners, 5);
  EXPECT_EQ(split.places.size(), 7u);
  EXPECT_EQ(split.surface.texture.size(), 14u);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    EXPECT_EQ(split.places[split.corners[c]], corners[c]);
    EXPECT_EQ(split.surface.texture[2 * split.corners[c]], at(c)[0]);
  }
  EXPECT_EQ(read.look().at("materials").size(), 3u);
  EXPECT_EQ(read.look().at("images").size(), 2u);
  // As text has them: base64, in pieces.
  file.materials[0].image = "/9j/IG9mIGNs\", \"b3Ro";
  file.materials[1].image = "iVBORw0KGgogb2Ygc2tpbg==";
  put_bytes(folder / "text.fbx", file.text());
  const GltfFile text(folder / "text.fbx");
  MaterialReader of_text(text);
  const SkinSurface same = read_node_surface(of_text, 0, corners);
  EXPECT_EQ(same.notes, std::vector<std::string>());
  ASSERT_EQ(same.textures.size(), 2u);
  EXPECT_EQ(*same.textures[0].bytes, jpeg);
  EXPECT_EQ(*same.textures[1].bytes, png);
  file.materials.clear();
  const GltfFile bare("bare.fbx", file.binary(7400, true));
  MaterialReader no_materials(bare);
  EXPECT_EQ(read_node_surface(no_materials, 0, corners).texture_of, surface.texture_of);
}

TEST(Fbx, SkinsAndClipsMoveAsTheFormulaSays) {
  const TemporaryFolder folder;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const WrittenFbx file = FbxMaker(seed).limb();
    put_bytes(folder / "limb.fbx",
              seed % 2 == 0 ? file.text() : file.binary(seed % 4 == 1 ? 7400 : 7700, seed % 3 == 0));
    const Character character = read_character(folder / "limb.fbx");
    ClipOptions options;
    options.fps = 24;
    const Clip clip = read_clip((folder / "limb.fbx").string() + "#take", character.skeleton, options);
    ASSERT_EQ(clip.poses.size(), 49u);
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      const double seconds = file.begin + static_cast<double>(k) / 24;
      EXPECT_LT(off(file, character, clip.poses[k], seconds), 2 * kBetweenKeys) << "seed " << seed << " frame " << k;
    }
  }
}

// As Blender exports them: centimetres below an armature that is a hundred times as large.
TEST(Fbx, BonesBelowAScaledArmatureAreAsLongAsOthers) {
  WrittenFbx plain = FbxMaker(5).limb();
  for (WrittenModel& m : plain.models) m.scale = {1, 1, 1};
  plain.models[5].parent = -1;
  WrittenFbx below = plain;
  for (WrittenModel& m : below.models) {
    if (m.type == "Mesh") continue;
    for (Vector* v : {&m.translation, &m.rotation_offset, &m.rotation_pivot, &m.scale_offset, &m.scale_pivot})
      *v /= 100;
  }
  for (WrittenCurve& curve : below.curves) {
    for (double& value : curve.values) value /= curve.property == "Lcl Translation" ? 100 : 1;
  }
  for (WrittenCluster& cluster : below.meshes[0].clusters) cluster.bone_then.scale(100);
  below.models.push_back({.name = "Armature", .type = "Null", .scale = {100, 100, 100}});
  below.models[0].parent = 6;
  const TemporaryFolder folder;
  put_bytes(folder / "plain.fbx", plain.text());
  put_bytes(folder / "below.fbx", below.text());
  const Skeleton skeleton = read_character(folder / "plain.fbx").skeleton;
  const Clip expected = read_clip((folder / "plain.fbx").string(), skeleton, {});
  const Clip clip = read_clip((folder / "below.fbx").string(), skeleton, {});
  ASSERT_EQ(clip.poses.size(), expected.poses.size());
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      const JointTransform &a = clip.poses[k].joints[j], &b = expected.poses[k].joints[j];
      EXPECT_LT(length(a.translation - b.translation), kBetweenKeys);
      EXPECT_LT(angle_between(a.rotation, b.rotation), kBetweenKeys);
    }
  }
}

// One joint that one curve moves; its channel of that path.
AnimationChannel channel_of(const WrittenCurve& curve, ChannelPath path) {
  WrittenFbx file;
  file.unit = 100;
  file.models.push_back({.name = "joint"});
  file.curves.push_back(curve);
  const GltfFile read("curve.fbx", file.text());
  std::vector<std::string> notes;
  for (const AnimationChannel& channel : read_channels(read, 0, notes)) {
    if (channel.path == path) return channel;
  }
  ADD_FAILURE() << "no channel";
  return {};
}

TEST(Fbx, CurvesFollowTheirTangents) {
  constexpr std::int64_t kCubic = 0x8, kUser = 0x400, kAuto = 0x100 | 0x2000;
  const WrittenCurve user{.property = "Lcl Translation",
                          .seconds = {0, 2},
                          .values = {0, 1},
                          .flags = kCubic | kUser,
                          .slope_out = 1.5,
                          .slope_in = -0.5};
  const AnimationChannel bent = channel_of(user, ChannelPath::translation);
  const WrittenCurve automatic{
      .property = "Lcl Translation", .seconds = {0, 1, 2}, .values = {0, 1, 0}, .flags = kCubic | kAuto};
  const AnimationChannel round = channel_of(automatic, ChannelPath::translation);
  for (double t = 0; t <= 2; t += 0.05) {
    const double x = t / 2, hermite = 2 * 1.5 * x * (1 - x) * (1 - x) + (3 - 2 * x) * x * x + 2 * 0.5 * x * x * (1 - x);
    EXPECT_NEAR(bent.sample(t)[0], hermite, kBetweenKeys) << t;
    const double u = t <= 1 ? t : 2 - t;  // level on top, straight from the ends
    EXPECT_NEAR(round.sample(t)[0], u * (1 - u) * (1 - u) + (3 - 2 * u) * u * u, kBetweenKeys) << t;
  }
}

TEST(Fbx, WholeTurnsBetweenKeysAreTurned) {
  const AnimationChannel spin = channel_of({.axis = 2, .seconds = {0, 1}, .values = {0, 1080}}, ChannelPath::rotation);
  for (double t = 0; t <= 1; t += 0.03) {
    const auto q = spin.sample(t);
    EXPECT_LT(angle_between({q[0], q[1], q[2], q[3]}, axis_angle({0, 0, 1}, t * 6 * M_PI)), 1e-3) << t;
  }
}

TEST(Fbx, AxesWithoutACurveKeepTheirRest) {
  WrittenFbx file;
  file.unit = 100;
  file.models.push_back({.name = "joint", .degrees = {10, 20, 30}});
  file.curves.push_back({.axis = 0, .seconds = {0, 1}, .values = {50, 60}});
  const GltfFile read("axes.fbx", file.text());
  std::vector<std::string> notes;
  for (const AnimationChannel& channel : read_channels(read, 0, notes)) {
    if (channel.path != ChannelPath::rotation) continue;
    const auto q = channel.sample(0.5);
    const Quat expected =
        axis_angle({0, 0, 1}, M_PI / 6) * axis_angle({0, 1, 0}, M_PI / 9) * axis_angle({1, 0, 0}, 55 * M_PI / 180);
    EXPECT_LT(angle_between({q[0], q[1], q[2], q[3]}, expected), 1e-4);
  }
}

TEST(Fbx, WhatCannotBeReadRightIsRefused) {
  struct Case {
    const char* says;
    std::function<void(WrittenFbx&)> change;
  };
  const Case cases[] = {
      {"rotation order", [](WrittenFbx& file) { file.models[1].order = 6; }},
      {"right-handed", [](WrittenFbx& file) { file.signs[0] = -file.signs[0]; }},
      {"right-handed", [](WrittenFbx& file) { file.axes[0] = file.axes[1]; }},
      {"UnitScaleFactor", [](WrittenFbx& file) { file.unit = 0; }},
      {"does not inherit",
       [](WrittenFbx& file) {
         file.models[0].scale = {1, 2, 1}, file.models[1].inherit = 2;
       }},
      {"does not inherit",
       [](WrittenFbx& file) {
         file.models[0].scale = {1, 2, 1}, file.models[3].inherit = 0;
       }},
      {"layers",
       [](WrittenFbx& file) {
         file.layers.push_back("over");
         file.curves.push_back({.model = 4, .property = "Lcl Scaling", .seconds = {0}, .values = {1}, .layer = 1});
       }},
      {"extrapolation",
       [](WrittenFbx& file) {
         file.curves = {{.model = 1, .seconds = {file.begin, file.begin + 1}, .values = {0, 9}, .beyond = "R"}};
       }},
      {"bone", [](WrittenFbx& file) { file.meshes[0].clusters[0].bone = 99; }},
      {"names point", [](WrittenFbx& file) { file.meshes[0].clusters[0].points[3] = 40; }},
      {"names point", [](WrittenFbx& file) { file.meshes[0].polygons[3] = ~std::int64_t{40}; }},
      {"weights", [](WrittenFbx& file) { file.meshes[0].clusters[0].weights.pop_back(); }},
      {"has no end", [](WrittenFbx& file) { file.meshes[0].polygons.pop_back(); }},
      {"finite", [](WrittenFbx& file) { file.meshes[0].points[2][1] = HUGE_VAL; }},
      {"finite", [](WrittenFbx& file) { file.models[2].translation[0] = HUGE_VAL; }},
      {"weight of", [](WrittenFbx& file) { file.meshes[0].clusters[0].weights[2] = NAN; }},
      {"beyond all numbers", [](WrittenFbx& file) { file.meshes[0].points[2][1] = 1e120; }},
      {"scaled to nothing", [](WrittenFbx& file) { file.meshes[0].clusters[0].mesh_then.linear().setZero(); }},
      {"times", [](WrittenFbx& file) { std::ranges::reverse(file.curves[0].seconds); }}};
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    WrittenFbx file = FbxMaker(3).limb();
    read_character(GltfFile("sound.fbx", file.binary(7500, true)));
    c.change(file);
    put_bytes(folder / "limb.fbx", file.binary(7500, true));
    const std::string said = error_of(ErrorKind::file, [&] { read_character(folder / "limb.fbx"); });
    EXPECT_NE(said.find(c.says), std::string::npos) << c.says << ": " << said;
    EXPECT_NE(said.find("limb.fbx"), std::string::npos) << said;
  }
  std::string old = FbxMaker(3).limb().text();
  old.replace(old.find("7400", 20), 4, "6100");
  put_bytes(folder / "limb.fbx", old);
  EXPECT_NE(error_of(ErrorKind::file, [&] { has_skin(folder / "limb.fbx"); }).find("6100"), std::string::npos);
}

TEST(FbxHostile, CutAndDamagedFilesAreRefusedOrFinite) {
  const TemporaryFolder folder;
  const WrittenFbx file = FbxMaker(1).limb();
  const Character sound = read_character(GltfFile("limb.fbx", file.text()));
  const auto read = [&](const std::filesystem::path& path) {
    const Character character = read_character(path, 1);
    EXPECT_TRUE(character.vertices.allFinite());
    for (const Pose& pose : read_clip(path.string(), sound.skeleton, {}).poses) {
      for (const JointTransform& joint : pose.joints) EXPECT_TRUE(is_finite(joint));
    }
  };
  for (const std::string& bytes : {file.binary(7400, false), file.binary(7700, true)}) {
    testing::damage_bytes(read, folder / "limb.fbx", bytes, 300);
    for (std::size_t size = 0; size + 30 < bytes.size(); size += 97) {
      testing::expect_refused(read, folder / "limb.fbx", bytes.substr(0, size), "limb.fbx");
    }
  }
  testing::damage_bytes(read, folder / "limb.fbx", file.text(), 300);
}

}  // namespace
}  // namespace bodyopt
