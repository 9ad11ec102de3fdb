// Shapes of a clip as morph targets of a .glb, read by another reader of glTF.
#include "assets/caches/gltf_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/assets/written_gltf.h"
#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace gltf_shapes_test {

// Two triangles that meet in a seam: 0 and 3, 1 and 4 lie on one another.
const std::vector<std::uint32_t> kCorners = {0, 1, 2, 3, 5, 4};
const std::vector<float> kFirst = {0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0};

std::vector<float> folded(float by) {
  std::vector<float> shape = kFirst;
  shape[3 * 5 + 2] = by;
  shape[3 * 2 + 2] = by;
  return shape;
}

CacheLayout layout() { return {"paper", 6, kCorners, {11, 12, 14}, 24}; }

void write_folding(const std::filesystem::path& path) {
  GltfShapesWriter writer(path, layout());
  for (const float by : {0.0f, 0.5f, -0.25f}) writer.append(folded(by), {});
  writer.close();
}

TEST(GltfShapes, EveryFrameIsTheFirstAndItsTarget) {
  const TemporaryFolder folder;
  write_folding(folder / "paper.glb");
  const GltfFile file(folder / "paper.glb");
  const tinygltf::Model& model = file.model();
  ASSERT_EQ(model.meshes.size(), 1u);
  const tinygltf::Primitive& drawn = model.meshes[0].primitives.at(0);
  const std::vector<float> first = numbers(model, drawn.attributes.at("POSITION"));
  EXPECT_EQ(first, kFirst);
  ASSERT_EQ(drawn.targets.size(), 2u);
  const tinygltf::Animation& animation = model.animations.at(0);
  EXPECT_EQ(animation.channels.at(0).target_path, "weights");
  const std::vector<float> times = numbers(model, animation.samplers.at(0).input),
                           weights = numbers(model, animation.samplers.at(0).output);
  ASSERT_EQ(times.size(), 3u);
  EXPECT_FLOAT_EQ(times[1], 1.0f / 24);
  EXPECT_FLOAT_EQ(times[2], 3.0f / 24);
  ASSERT_EQ(weights.size(), 6u);
  for (std::size_t f = 0; f < 3; ++f) {
    std::vector<float> shown = first;
    for (std::size_t t = 0; t < 2; ++t) {
      const std::vector<float> target = numbers(model, drawn.targets[t].at("POSITION"));
      for (std::size_t k = 0; k < shown.size(); ++k) shown[k] += weights[2 * f + t] * target[k];
    }
    EXPECT_EQ(shown, folded(f == 0 ? 0.0f : f == 1 ? 0.5f : -0.25f)) << f;
  }
}

// Three points that the image has at six places.
TEST(GltfShapes, SeamsCountAgainstTheRoom) {
  const TemporaryFolder folder;
  const std::vector<std::uint32_t> corners = {0, 1, 2, 0, 2, 1};
  CacheLayout layout{"paper", 3, corners, std::vector<int>(32751), 24};
  EXPECT_NO_THROW(GltfShapesWriter(folder / "paper.glb", layout));
  layout.surface.texture.resize(12);
  layout.surface.texture_of = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(kind_of([&] { GltfShapesWriter(folder / "paper.glb", layout); }), ErrorKind::usage);
}

TEST(GltfShapes, NormalsAreSmoothOverSeams) {
  const TemporaryFolder folder;
  write_folding(folder / "paper.glb");
  const GltfFile file(folder / "paper.glb");
  const tinygltf::Primitive& drawn = file.model().meshes.at(0).primitives.at(0);
  std::vector<float> normals = numbers(file.model(), drawn.attributes.at("NORMAL"));
  const std::vector<float> change = numbers(file.model(), drawn.targets.at(0).at("NORMAL"));
  for (std::size_t k = 0; k < normals.size(); ++k) normals[k] += change[k];
  for (const std::size_t seam : {0, 1, 3, 4}) {  // the fold is the same to both sides: it looks straight ahead
    EXPECT_NEAR(normals[3 * seam], 0, 1e-6) << seam;
    EXPECT_NEAR(std::abs(normals[3 * seam + 2]), 1, 1e-6) << seam;
  }
  EXPECT_GT(std::abs(normals[3 * 2]), 0.3f);
}

TEST(GltfShapes, GoesOnFromWhatWasPutAside) {
  const TemporaryFolder folder;
  write_folding(folder / "whole.glb");
  {
    GltfShapesWriter begun(folder / "parts.glb", layout());
    begun.append(folded(0), {});
    begun.append(folded(0.5f), {});
    ASSERT_EQ(begun.put_aside(folder / "skin").size(), 1u);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "parts.glb"));
  GltfShapesWriter rest(folder / "parts.glb", layout());
  rest.take_up(folder / "skin", 2);
  rest.append(folded(-0.25f), {});
  rest.close();
  EXPECT_EQ(read_bytes(folder / "parts.glb"), read_bytes(folder / "whole.glb"));
  GltfShapesWriter other(folder / "parts.glb", layout());
  EXPECT_EQ(kind_of([&] { other.take_up(folder / "skin", 1); }), ErrorKind::file);
}

TEST(GltfShapes, WritesNothingOfWhatIsNotWholeOrSound) {
  const TemporaryFolder folder;
  {
    GltfShapesWriter writer(folder / "no.glb", layout());
    writer.append(kFirst, {});
    EXPECT_EQ(kind_of([&] { writer.close(); }), ErrorKind::file);
    std::vector<float> blown = kFirst;
    blown[4] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(kind_of([&] { writer.append(blown, {}); }), ErrorKind::file);
    EXPECT_EQ(kind_of([&] { writer.append(std::vector<float>(3), {}); }), ErrorKind::mismatch);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "no.glb"));
  CacheLayout huge = layout();
  huge.points = 1u << 24;
  huge.frames.resize(20);
  EXPECT_EQ(kind_of([&] { GltfShapesWriter(folder / "huge.glb", huge); }), ErrorKind::usage);
}

}  // namespace gltf_shapes_test
}  // namespace bodyopt::testing
