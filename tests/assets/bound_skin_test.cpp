// Shapes of a clip as a skin bound to its joints: linear blend skinning of the rest shape and a frame's blend shape, by
// a textbook version in double precision over what the files hold, is the shape again.
#include "assets/caches/bound_skin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "assets/caches/cache_writer.h"
#include "runtime/host/rig.h"
#include "tests/assets/written_gltf.h"
#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace bound_skin_test {

constexpr std::array kFrames{1001, 1003};

// A root, a joint that bends above it and one that leans away from that, stretched.
Skeleton leaning() {
  Skeleton skeleton;
  for (int j = 0; j < 3; ++j) {
    Joint joint;
    joint.name = std::array{"root", "spine", "arm.L"}[static_cast<std::size_t>(j)];
    joint.parent = j - 1;
    joint.bind.translation = {0.1 * j, 0.4, 0};
    joint.bind.rotation = axis_angle({0, 0, 1}, 0.2 * j);
    joint.default_local = joint.bind;
    skeleton.joints.push_back(joint);
  }
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  for (std::size_t j = 0; j < bind.size(); ++j) skeleton.joints[j].inverse_bind = inverse(bind[j]);
  return skeleton;
}

// A strip of four triangles whose first vertex is output twice, as at a seam.
Character strip() {
  Character character;
  character.name = "strip";
  character.skeleton = leaning();
  character.vertices.resize(6, 3);
  for (Eigen::Index v = 0; v < 6; ++v) character.vertices.row(v) << 0.2 * (v % 2), 0.5 * (v / 2), 0.01 * v;
  character.triangles.resize(4, 3);
  character.triangles << 0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4;
  character.weights = {{{0, 1.0}}, {{0, 0.75}, {1, 0.25}}, {{1, 0.5}, {0, 0.25}, {2, 0.25}}, {{1, 0.6}, {2, 0.4}},
                       {{2, 1.0}}, {{2, 0.9}, {1, 0.1}}};
  character.output_vertex = {0, 1, 2, 3, 4, 5, 0};
  character.output_triangles = character.triangles;
  character.output_triangles(0, 0) = 6;
  return character;
}

Clip bending(const Skeleton& skeleton) {
  Clip clip;
  clip.name = "bend";
  clip.fps = 25;
  clip.first_frame = 1001;
  for (int k = 0; k < 3; ++k) {
    Pose pose = bind_pose(skeleton);
    pose.joints[0].translation = {3, 0.125 * k, -2};
    pose.joints[1].rotation = axis_angle({1, 0, 0}, 0.6 * k);
    pose.joints[2].rotation = axis_angle({0, 1, 1}, -0.4 * k);
    pose.joints[2].scale = {1.1, 1, 1};
    clip.poses.push_back(pose);
  }
  return clip;
}

BoundSkin bound_strip() {
  Character character = strip();
  Clip clip = bending(character.skeleton);
  return {std::move(character), std::move(clip)};
}

// Of any skin: what was learned need not be near linear blending.
std::vector<float> shape_of(int frame) {
  std::mt19937 random(static_cast<unsigned>(frame));
  std::uniform_real_distribution<float> away(-0.3f, 0.3f);
  std::vector<float> shape;
  for (int k = 0; k < 21; ++k)
    shape.push_back(std::array{3.0f, 0.5f, -2.0f}[static_cast<std::size_t>(k % 3)] + away(random));
  return shape;
}

void write_strip(const std::filesystem::path& path, const BoundSkin& bound) {
  const std::vector<std::uint32_t> corners(bound.character.output_triangles.data(),
                                           bound.character.output_triangles.data() + 12);
  const auto writer = write_cache(path, {"strip", 7, corners, {kFrames.begin(), kFrames.end()}, 25, {}, {}, &bound});
  for (const int frame : kFrames) writer->append(shape_of(frame), {});
  writer->close();
}

// The points of output vertices moved by linear blend skinning, from the definition.
Vec3 skinned(const Character& character, const Pose& pose, std::size_t output, const Vec3& offset) {
  const std::vector<Affine> joints = posed_joints(character.skeleton, pose.joints);
  const std::uint32_t vertex = character.output_vertex[output];
  Vec3 sum{};
  for (const JointWeight& weight : character.weights[vertex]) {
    const auto j = static_cast<std::size_t>(weight.joint);
    Vec3 point = offset;
    for (std::size_t i = 0; i < 3; ++i) point[i] += character.vertices(vertex, static_cast<Eigen::Index>(i));
    sum = sum + weight.weight * (joints[j] * (character.skeleton.joints[j].inverse_bind * point));
  }
  return sum;
}

void expect_shape(const Character& character, const Pose& pose, std::span<const float> offsets, int frame) {
  const std::vector<float> wanted = shape_of(frame);
  ASSERT_EQ(offsets.size(), wanted.size());
  for (std::size_t o = 0; o < 7; ++o) {
    const Vec3 point = skinned(character, pose, o, {offsets[3 * o], offsets[3 * o + 1], offsets[3 * o + 2]});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(point[i], wanted[3 * o + i], 2e-6) << frame << " " << o;
  }
}

TEST(BoundSkin, ABlendShapeBelowTheJointsIsTheShape) {
  const BoundSkin bound = bound_strip();
  for (const int frame : kFrames) {
    const Pose& pose = bound.clip.poses[static_cast<std::size_t>(frame - 1001)];
    expect_shape(bound.character, pose, blend_shape(bound, frame, shape_of(frame)), frame);
  }
}

TEST(BoundSkin, AJointThatIsScaledToLittleIsUndone) {
  BoundSkin bound = bound_strip();
  for (Pose& pose : bound.clip.poses) pose.joints[1].scale = {0.02, 0.02, 0.02};
  expect_shape(bound.character, bound.clip.poses[0], blend_shape(bound, 1001, shape_of(1001)), 1001);
}

// Half of a vertex turns by 180 degrees against the other half: it lies on the axis, whatever is added to it.
TEST(BoundSkin, OfAFlattenedVertexTheOffsetIsShortAndDoesNotHarm) {
  BoundSkin bound = bound_strip();
  const Vec3 kAxis = rotate(axis_angle({0, 0, 1}, 0.2), {1, 0, 0});  // of the joint that turns
  bound.character.weights.assign(6, {{0, 0.5}, {1, 0.5}});
  for (Pose& pose : bound.clip.poses) {
    pose = bind_pose(bound.character.skeleton);
    pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({1, 0, 0}, 3.14159265358979);
  }
  std::vector<float> wanted = shape_of(1001);
  for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] -= std::array{3.0f, 0.0f, -2.0f}[k % 3];
  const std::vector<float> offsets = blend_shape(bound, 1001, wanted);
  for (std::size_t o = 0; o < 7; ++o) {
    const Vec3 offset{offsets[3 * o], offsets[3 * o + 1], offsets[3 * o + 2]},
        aim{wanted[3 * o], wanted[3 * o + 1], wanted[3 * o + 2]};
    EXPECT_LT(length(offset), 2) << o;
    const Vec3 found = skinned(bound.character, bound.clip.poses[0], o, offset),
               before = skinned(bound.character, bound.clip.poses[0], o, {});
    EXPECT_LT(length(found - aim), length(before - aim)) << o;
    EXPECT_NEAR(dot(found - aim, kAxis), 0, 1e-5) << o;  // where it can be reached
  }
}

TEST(BoundSkin, GltfHasTheJointsTheirMotionAndATargetForEveryFrame) {
  const TemporaryFolder folder;
  const BoundSkin bound = bound_strip();
  write_strip(folder / "strip.glb", bound);
  const GltfFile file(folder / "strip.glb");
  const Character character = read_character(file);
  ASSERT_EQ(character.output_count(), 7u);
  const Clip clip = read_clip(folder / "strip.glb", character.skeleton, {.fps = 25});
  ASSERT_EQ(clip.poses.size(), 3u);
  const tinygltf::Model& model = file.model();
  const tinygltf::Primitive& drawn = model.meshes.at(0).primitives.at(0);
  ASSERT_EQ(drawn.targets.size(), 2u);
  const tinygltf::Animation& animation = model.animations.at(0);
  const tinygltf::AnimationChannel& channel = animation.channels.back();
  EXPECT_EQ(channel.target_path, "weights");
  EXPECT_EQ(model.nodes.at(static_cast<std::size_t>(channel.target_node)).skin, 0);
  const tinygltf::AnimationSampler& sampler = animation.samplers.at(static_cast<std::size_t>(channel.sampler));
  EXPECT_EQ(numbers(model, sampler.output), (std::vector<float>{1, 0, 0, 1}));
  EXPECT_EQ(numbers(model, sampler.input), (std::vector<float>{0, 2.0f / 25}));
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<float> offsets = numbers(model, drawn.targets[k].at("POSITION"));
    expect_shape(character, clip.poses[static_cast<std::size_t>(kFrames[k] - 1001)], offsets, kFrames[k]);
  }
}

// The numbers after the first `what`, to the end of the line.
std::vector<float> numbers_after(const std::string& text, const std::string& what) {
  const std::size_t found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  std::vector<float> numbers;
  if (found == std::string::npos) return numbers;
  for (std::size_t at = found + what.size(); (at = text.find_first_of("-0123456789\n", at)) != std::string::npos;) {
    if (text[at] == '\n') break;
    char* end = nullptr;
    numbers.push_back(std::strtof(text.c_str() + at, &end));
    at = static_cast<std::size_t>(end - text.c_str());
  }
  return numbers;
}

TEST(BoundSkin, UsdHasTheWeightsAndABlendShapeForEveryFrame) {
  const TemporaryFolder folder;
  const BoundSkin bound = bound_strip();
  write_strip(folder / "strip.usda", bound);
  const std::string text = read_bytes(folder / "strip.usda");
  for (const char* part :
       {"def SkelRoot \"strip\"", "rel skel:animationSource = </strip/motion>", "rel skel:skeleton = </strip/skeleton>",
        "uniform token[] blendShapes = [\"frame_1001\", \"frame_1003\"]", "            1003: [0, 1],\n",
        "rel skel:blendShapeTargets = [</strip/skin/frame_1001>, </strip/skin/frame_1003>]", "elementSize = 3\n"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  Character character = bound.character;  // as the file has it
  const std::vector<float> points = numbers_after(text, "point3f[] points = "),
                           joints = numbers_after(text, "primvars:skel:jointIndices = "),
                           weights = numbers_after(text, "primvars:skel:jointWeights = ");
  ASSERT_EQ(points.size(), 21u);
  ASSERT_EQ(joints.size(), 21u);
  ASSERT_EQ(weights.size(), 21u);
  for (std::size_t o = 0; o < 7; ++o) {
    const std::uint32_t vertex = character.output_vertex[o];
    character.weights[vertex].clear();
    for (std::size_t k = 0; k < 3; ++k) {
      character.vertices(vertex, static_cast<Eigen::Index>(k)) = points[3 * o + k];
      character.weights[vertex].push_back({static_cast<std::uint32_t>(joints[3 * o + k]), weights[3 * o + k]});
    }
  }
  for (const int frame : kFrames) {
    const std::string time = "            " + std::to_string(frame) + ": ";
    const auto sampled = [&](const std::string& what) {
      return numbers_after(text.substr(text.find(what + ".timeSamples")), time);
    };
    const std::vector<float> places = sampled("translations"), turns = sampled("rotations"), scales = sampled("scales"),
                             shares = sampled("blendShapeWeights");
    ASSERT_EQ(shares.size(), kFrames.size());
    Pose pose;
    for (std::size_t j = 0; j < 3; ++j) {
      pose.joints.push_back(
          {{places[3 * j], places[3 * j + 1], places[3 * j + 2]},
           {turns[4 * j + 1], turns[4 * j + 2], turns[4 * j + 3], turns[4 * j]},  // the real part first
           {}});
      for (std::size_t i = 0; i < 3; ++i) {  // USD's half3
        pose.joints[j].scale[i] = static_cast<double>(static_cast<float>(Eigen::half(scales[3 * j + i])));
      }
    }
    std::vector<float> offsets(21);
    for (std::size_t k = 0; k < kFrames.size(); ++k) {
      const std::string shape = text.substr(text.find("def BlendShape \"frame_" + std::to_string(kFrames[k])));
      const std::vector<float> own = numbers_after(shape, "offsets = ");
      ASSERT_EQ(own.size(), offsets.size());
      for (std::size_t i = 0; i < own.size(); ++i) offsets[i] += shares[k] * own[i];
    }
    expect_shape(character, pose, offsets, frame);
  }
}

TEST(BoundSkin, GoesOnFromWhatWasPutAside) {
  const TemporaryFolder folder;
  const BoundSkin bound = bound_strip();
  const std::vector<std::uint32_t> corners(bound.character.output_triangles.data(),
                                           bound.character.output_triangles.data() + 12);
  for (const char* name : {"strip.glb", "strip.usda"}) {
    write_strip(folder / name, bound);
    const std::string whole = read_bytes(folder / name);
    std::filesystem::remove(folder / name);
    const CacheLayout layout{"strip", 7, corners, {kFrames.begin(), kFrames.end()}, 25, {}, {}, &bound};
    {
      const auto begun = write_cache(folder / name, layout);
      begun->append(shape_of(kFrames[0]), {});
      EXPECT_EQ(kind_of([&] { begun->close(); }), ErrorKind::file);
      begun->put_aside(folder / "aside");
    }
    EXPECT_FALSE(std::filesystem::exists(folder / name));
    const auto rest = write_cache(folder / name, layout);
    rest->take_up(folder / "aside", 1);
    rest->append(shape_of(kFrames[1]), {});
    rest->close();
    EXPECT_EQ(read_bytes(folder / name), whole) << name;
  }
}

TEST(BoundSkin, GltfOfFramesThatFallIsRefused) {
  const TemporaryFolder folder;
  const std::vector<std::uint32_t> corners = {0, 1, 2};
  EXPECT_EQ(kind_of([&] { write_cache(folder / "strip.glb", {"strip", 3, corners, {4, 2}, 24}); }), ErrorKind::usage);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace bound_skin_test
}  // namespace bodyopt::testing
