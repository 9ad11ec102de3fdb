#include "assets/caches/nodes_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "assets/caches/shape_reader.h"
#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace nodes_cache_test {

using namespace testing;

// Two tets of five nodes, three points in them, two samples.
struct Draft {
  Tets tets{{0, 1, 2, 3}, {1, 2, 3, 4}};
  std::vector<EmbeddedPoint> skin{{0, {0.25, 0.25, 0.3, 0.2}}, {1, {0.1, 0.2, 0.3, 0.4}}, {1, {0, 0, 1.5, -0.5}}};
  std::vector<Positions> samples{Positions{{0, 0, 0}, {1, 0, 0}, {0, 1.8, 0}, {0, 0, 0.1}, {1, 1, 1}},
                                 Positions{{100, 0, 0}, {101, 0.25, 0}, {100, 1.3, 0}, {100, 0, -0.1}, {101, 1, 1}}};
};

void write_draft(const std::filesystem::path& path) {
  const Draft draft;
  NodesWriter writer(path, draft.tets, draft.skin, 42, {1001, 1003});
  for (const Positions& sample : draft.samples) writer.append(sample);
  writer.close();
}

void read(const std::filesystem::path& path) {
  const ShapeReader reader(path);
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) reader.sample(k);
}

TEST(NodesCache, RoundTripIsWithinHalfAStep) {
  const TemporaryFolder folder;
  write_draft(folder / "a.nodes");
  const Draft draft;
  const NodesReader reader(folder / "a.nodes");
  EXPECT_EQ(reader.point_count(), 3u);
  ASSERT_EQ(reader.sample_count(), 2u);
  EXPECT_EQ(reader.node_count(), 5);
  EXPECT_EQ(reader.sample_rate(), 2);
  EXPECT_EQ(reader.start_frame(), 1001.0f);
  EXPECT_EQ(reader.tets(), draft.tets);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Eigen::RowVector3d extent = draft.samples[k].colwise().maxCoeff() - draft.samples[k].colwise().minCoeff();
    const Positions error = reader.nodes(k) - draft.samples[k];
    for (int i = 0; i < 3; ++i) EXPECT_LE(error.col(i).cwiseAbs().maxCoeff(), extent[i] / 131070 + 1e-13);
    EXPECT_GT(error.cwiseAbs().maxCoeff(), 0);
  }
}

TEST(NodesCache, GivesTheSameSkinBitForBit) {
  const TemporaryFolder folder;
  write_draft(folder / "a.nodes");
  const Draft draft;
  const NodesReader reader(folder / "a.nodes");
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Positions skin = embed(draft.skin, draft.tets, reader.nodes(k));
    const std::vector<float> expected(skin.data(), skin.data() + skin.size());
    EXPECT_EQ(reader.sample(k), expected);
    EXPECT_EQ(ShapeReader(folder / "a.nodes").sample(k), expected);
  }
  // What was read, written again, is the same file.
  NodesWriter writer(folder / "b.nodes", draft.tets, draft.skin, 42, {1001, 1003});
  for (std::uint32_t k = 0; k < 2; ++k) writer.append(reader.nodes(k));
  writer.close();
  EXPECT_EQ(read_bytes(folder / "b.nodes"), read_bytes(folder / "a.nodes"));
}

TEST(NodesCache, ThreeThousandTwoHundredFramesFitInThirtyMegabytes) {
  const TemporaryFolder folder;
  const Draft draft;
  NodesWriter writer(folder / "a.nodes", draft.tets, std::vector<EmbeddedPoint>(13380, draft.skin[0]), 42, {1, 2});
  const Positions nodes = Positions::Random(1500, 3);
  for (int k = 0; k < 3200; ++k) writer.append(nodes);
  writer.close();
  EXPECT_LT(std::filesystem::file_size(folder / "a.nodes"), 30'000'000u);
}

TEST(NodesCache, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  write_draft(folder / "a.nodes");
  expect_every_truncation_refused(read, folder / "b.nodes", read_bytes(folder / "a.nodes"));
}

TEST(NodesCache, DamagedBytesAreRefused) {
  const TemporaryFolder folder;
  write_draft(folder / "a.nodes");
  EXPECT_GT(damage_bytes(read, folder / "b.nodes", read_bytes(folder / "a.nodes"), 3000), 2990u);  // but white space
}

// Files whose checksum is right and whose content is not.
TEST(NodesCache, HostileContentIsRefused) {
  const TemporaryFolder folder;
  write_draft(folder / "a.nodes");
  const auto expect = [&](const std::string& named, const std::function<void(Safetensors&)>& change) {
    Safetensors file = read_safetensors(folder / "a.nodes");
    change(file);
    if (file.metadata.contains("checksum")) file.metadata["checksum"] = content_checksum(file);
    write_safetensors(file, folder / "c.nodes");
    EXPECT_TRUE(refuses(read, folder / "c.nodes", named)) << named;
    expect_refused(read, folder / "b.nodes", read_bytes(folder / "c.nodes"), named);
  };
  const auto set = [](Tensor& tensor, std::size_t index, auto value) {
    std::memcpy(tensor.bytes.data() + index * sizeof(value), &value, sizeof(value));
  };
  expect("missing node", [&](Safetensors& f) { set(f.tensors["tets"], 3, std::uint32_t{5}); });
  expect("missing tet", [&](Safetensors& f) { set(f.tensors["skin.tet"], 1, std::uint32_t{2}); });
  expect("not a finite number", [&](Safetensors& f) { set(f.tensors["skin.weights"], 5, std::nan("")); });
  expect("not a finite number", [&](Safetensors& f) { set(f.tensors["bounds"], 4, 1e300); });
  expect("'nodes'", [&](Safetensors& f) { f.tensors["nodes"].shape = {2, 15, 1}; });
  expect("'nodes'", [&](Safetensors& f) { f.tensors["nodes"].shape = {1, 10, 3}; });
  expect("'bounds'", [&](Safetensors& f) { f.tensors["bounds"] = {"F64", {0, 6}, {}}; });
  expect("'skin.tet'", [&](Safetensors& f) { f.tensors["skin.tet"].dtype = "F32"; });
  expect("'tets'", [&](Safetensors& f) { f.tensors.erase("tets"); });
  expect("schema", [&](Safetensors& f) { f.metadata["schema"] = "bodyopt-nodes-2"; });
  expect("checksum", [&](Safetensors& f) { f.metadata.erase("checksum"); });
  expect("start_frame", [&](Safetensors& f) { f.metadata["start_frame"] = "1x"; });
}

TEST(NodesCache, RefusesNodesThatAreNotFinite) {
  const TemporaryFolder folder;
  Draft draft;
  draft.samples[0](2, 1) = std::nan("");
  NodesWriter writer(folder / "a.nodes", draft.tets, draft.skin, 42, {1, 2});
  EXPECT_THROW(writer.append(draft.samples[0]), Error);
}

}  // namespace nodes_cache_test
}  // namespace bodyopt
