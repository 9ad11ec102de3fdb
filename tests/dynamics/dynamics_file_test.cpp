#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "runtime/basis/table_file.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "tests/support/forged_word.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/small_dynamics.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

Reader reader_of(const Basis& basis) {
  return [&](const std::filesystem::path& path) { load_dynamics(path, basis); };
}

TEST(DynamicsFile, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  const SmallDynamics& small = small_dynamics();
  Dynamics dynamics = small.dynamics;
  dynamics.jiggle.step = {29.97f, 3, true, dynamics.jiggle.step.stiffness_damping};
  save_dynamics(dynamics, folder / "a.safetensors");
  const Dynamics loaded = load_dynamics(folder / "a.safetensors", small.basis);
  EXPECT_EQ(loaded.jiggle.step.frames_per_second, 29.97f);
  EXPECT_EQ(loaded.jiggle.step.substeps, 3u);
  EXPECT_TRUE(loaded.jiggle.step.implicit_euler);
  EXPECT_GT(loaded.jiggle.step.stiffness_damping, 0);
  EXPECT_EQ(loaded.metadata, dynamics.metadata);
  EXPECT_EQ(loaded.diffuse.inverse.unknown_count, dynamics.diffuse.inverse.unknown_count);
  EXPECT_EQ(loaded.jiggle.inverse.unknown_count, dynamics.jiggle.inverse.unknown_count);
  save_dynamics(loaded, folder / "b.safetensors");
  EXPECT_EQ(read_bytes(folder / "a.safetensors"), read_bytes(folder / "b.safetensors"));
  EXPECT_EQ(loaded.jiggle.springs, dynamics.jiggle.springs);
  EXPECT_EQ(loaded.tets.nodes, dynamics.tets.nodes);
}

// Rows of earlier versions: of node 0 its own inertia and spring and one it shares, times 1 + beta / d; of the others
// inertia alone.
Safetensors with_rows(Safetensors file, const JiggleTable& jiggle) {
  const double damped = 1 + static_cast<double>(jiggle.step.stiffness_damping / jiggle.step.stage());
  std::vector<std::uint32_t> begin = {0, 2}, columns = {0, 1};
  std::vector<float> values = {jiggle.nodes[0].inertia + static_cast<float>(3e4 * damped),
                               static_cast<float>(1e4 * damped)};
  for (std::uint32_t n = 1; n < jiggle.nodes.size(); ++n) {
    columns.push_back(n);
    values.push_back(jiggle.nodes[n].inertia);
    begin.push_back(static_cast<std::uint32_t>(values.size()));
  }
  file.tensors.erase("jiggle.springs");
  file.tensors["jiggle.held_begin"] = tensor_from(begin, 1);
  file.tensors["jiggle.held_columns"] = tensor_from(columns, 1);
  file.tensors["jiggle.held_values"] = tensor_from(values, 1);
  file.tensors["jiggle.elasticity"] = tensor_from(std::vector<float>{1, 2}, 2);
  file.metadata["checksum"] = content_checksum(file);
  return file;
}

// Their springs are the rows' sums, and a state that belongs to the file still does.
TEST(DynamicsFile, ReadsTheRowsOfEarlierVersions) {
  const TemporaryFolder folder;
  const OneTet one;
  save_dynamics(one.dynamics, folder / "new.safetensors");
  const Safetensors old = with_rows(read_safetensors(folder / "new.safetensors"), one.dynamics.jiggle);
  write_safetensors(old, folder / "old.safetensors");
  const Dynamics loaded = load_dynamics(folder / "old.safetensors", one.basis);
  EXPECT_NEAR(loaded.jiggle.springs[0], 4e4, 1);
  EXPECT_EQ(std::vector(loaded.jiggle.springs.begin() + 1, loaded.jiggle.springs.end()), std::vector<float>(3));
  EXPECT_EQ(checksum(loaded), old.metadata.at("checksum"));
  EXPECT_EQ(loaded.jiggle.inverse.values, one.dynamics.jiggle.inverse.values);

  save_dynamics(loaded, folder / "again.safetensors");
  const Safetensors again = read_safetensors(folder / "again.safetensors");
  EXPECT_FALSE(again.tensors.contains("jiggle.elasticity"));
  EXPECT_EQ(load_dynamics(folder / "again.safetensors", one.basis).jiggle.springs, loaded.jiggle.springs);
  EXPECT_NE(again.metadata.at("checksum"), checksum(loaded));
}

TEST(DynamicsFile, ForgedRowsOfEarlierVersionsAreRefused) {
  const TemporaryFolder folder;
  const OneTet one;
  save_dynamics(one.dynamics, folder / "new.safetensors");
  const Safetensors old = with_rows(read_safetensors(folder / "new.safetensors"), one.dynamics.jiggle);
  const auto expect = [&](const char* named, std::vector<std::uint32_t> begin) {
    Safetensors forged = old;
    forged.tensors["jiggle.held_begin"] = tensor_from(begin, 1);
    forged.metadata["checksum"] = content_checksum(forged);
    write_safetensors(forged, folder / "b.safetensors");
    expect_refused(reader_of(one.basis), folder / "b.safetensors", read_bytes(folder / "b.safetensors"), named);
  };
  for (const auto& begin : {std::vector{0u, 2u, 3u, 4u}, {0u, 2u, 1u, 4u, 5u}, {0u, 2u, 3u, 4u, ~0u}}) {
    expect("jiggle.held_begin does not fit", begin);
  }
}

TEST(DynamicsFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  const OneTet one;
  save_dynamics(one.dynamics, folder / "a.safetensors");
  EXPECT_NO_THROW(load_dynamics(folder / "a.safetensors", one.basis));
  expect_every_truncation_refused(reader_of(one.basis), folder / "b.safetensors", read_bytes(folder / "a.safetensors"));
}

TEST(DynamicsFile, DamagedBytesAreRefused) {
  const TemporaryFolder folder;
  const OneTet one;
  save_dynamics(one.dynamics, folder / "a.safetensors");
  EXPECT_EQ(damage_bytes(reader_of(one.basis), folder / "b.safetensors", read_bytes(folder / "a.safetensors"), 1000),
            1000u);
}

TEST(DynamicsFile, AnotherCharactersAreRefused) {
  const TemporaryFolder folder;
  const SmallDynamics& small = small_dynamics();
  save_dynamics(small.dynamics, folder / "a.safetensors");
  const std::string bytes = read_bytes(folder / "a.safetensors");
  const auto expect = [&](const char* named, const std::function<void(Basis&)>& change) {
    Basis other = small.basis;
    change(other);
    expect_refused(reader_of(other), folder / "b.safetensors", bytes, named);
    EXPECT_THROW(validate(small.dynamics, other, "here"), Error);
  };
  expect("the mesh is another", [](Basis& b) { std::swap(b.mesh.triangles[0], b.mesh.triangles[1]); });
  expect("the skeleton is another", [](Basis& b) { b.skeleton.joints[1].name = "else"; });
  expect("its skin stands elsewhere at rest", [](Basis& b) {
    for (float& x : b.mesh.rest) x *= 1.01f;
  });
  expect("is of fibres that its strain table does not have", [](Basis& b) {
    b.strain.rest_length.pop_back();
    b.strain.names.pop_back();
  });
}

// Words of the tables replaced by the worst there are, under a checksum that fits: refused, or harmless to a solve.
TEST(DynamicsFile, ForgedTablesAreRefusedOrSolved) {
  const TemporaryFolder folder;
  const SmallDynamics& small = small_dynamics();
  save_dynamics(small.dynamics, folder / "a.safetensors");
  const Safetensors file = read_safetensors(folder / "a.safetensors");
  std::mt19937 random(13);
  int accepted = 0, refused_indices = 0;
  for (int k = 0; k < 150; ++k) {
    Safetensors forged = file;
    const std::string word = forge_word(forged, random);
    forged.metadata["checksum"] = content_checksum(forged);
    write_safetensors(forged, folder / "b.safetensors");
    const auto solve = [&](const auto& path) {
      const Dynamics loaded = load_dynamics(path, small.basis);
      std::vector<float> scratch;
      for (const auto* inverse : {&loaded.diffuse.inverse, &loaded.jiggle.inverse}) {
        const std::vector<float> right(inverse->unknown_count, 1e-20f);
        std::vector<float> solution(right.size());
        cpu::block_solve(*inverse, right, 1, 1, scratch, solution);
        for (const float value : solution) ASSERT_TRUE(std::isfinite(value)) << word;
      }
    };
    const bool refused = refuses(solve, folder / "b.safetensors", word);
    accepted += refused ? 0 : 1;
    refused_indices += refused && word.starts_with("U32") ? 1 : 0;
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused_indices, 20);
}

TEST(DynamicsFile, ForgedPartsAreRefusedByName) {
  const TemporaryFolder folder;
  const OneTet one;
  save_dynamics(one.dynamics, folder / "a.safetensors");
  const Safetensors file = read_safetensors(folder / "a.safetensors");
  const auto expect = [&](const std::string& named, const std::function<void(Safetensors&)>& change) {
    Safetensors forged = file;
    change(forged);
    if (forged.metadata.contains("checksum")) forged.metadata["checksum"] = content_checksum(forged);
    write_safetensors(forged, folder / "b.safetensors");
    expect_refused(reader_of(one.basis), folder / "b.safetensors", read_bytes(folder / "b.safetensors"), named);
  };
  const auto set_step = [](std::size_t k, float value) {
    return [k, value](Safetensors& f) { std::memcpy(f.tensors["jiggle.step"].bytes.data() + 4 * k, &value, 4); };
  };
  expect("schema is 'bodyopt-dynamics-2', expected 'bodyopt-dynamics-1'",
         [](Safetensors& f) { f.metadata["schema"] = "bodyopt-dynamics-2"; });
  expect("lacks 'checksum'", [](Safetensors& f) { f.metadata.erase("checksum"); });
  expect("lack 'topology_hash'", [](Safetensors& f) { f.metadata.erase("topology_hash"); });
  expect("'tets.nodes' is missing", [](Safetensors& f) { f.tensors.erase("tets.nodes"); });
  expect("'mesh.rest' is not one of dynamics",
         [](Safetensors& f) { f.tensors["mesh.rest"] = f.tensors["tets.nodes"]; });
  expect("'jiggle.springs' has type U32", [](Safetensors& f) { f.tensors["jiggle.springs"].dtype = "U32"; });
  expect("'jiggle.springs' is missing", [](Safetensors& f) { f.tensors.erase("jiggle.springs"); });
  expect("jiggle.step", set_step(0, 0));
  expect("jiggle.step", set_step(0, std::nanf("")));
  expect("jiggle.step", set_step(1, 0));
  expect("jiggle.step", set_step(1, 1.5f));
  expect("jiggle.step", set_step(2, 2));
  expect("jiggle.step", set_step(3, -1));
  expect("jiggle.step has 2 rows", [](Safetensors& f) {
    Tensor& step = f.tensors["jiggle.step"];
    step.bytes.insert(step.bytes.end(), step.bytes.begin(), step.bytes.end());
    step.shape = {2, 4};
  });
}

TEST(DynamicsFile, BytesAreCountedByStage) {
  const Dynamics& dynamics = small_dynamics().dynamics;
  const auto of_inverse = [](const BlockInverse& inverse) {
    return 28 * inverse.levels.size() + 12 * std::size_t{inverse.slot_count()} + 20 * inverse.up.size() +
           24 * inverse.down.size() + 4 * inverse.values.size();
  };
  const std::size_t nodes = dynamics.tets.node_count(), tets = dynamics.tets.tet_count();
  const std::map<std::string, std::size_t> bytes = table_bytes(dynamics);
  ASSERT_EQ(bytes.size(), 2u);
  EXPECT_EQ(bytes.at("diffuse"), 12 * nodes + (16 + 40 + 16) * tets + 4 * (nodes + 1) +
                                     24 * dynamics.tets.surface.size() + 28 * dynamics.tets.skin.size() +
                                     4 * (nodes + 1) + 8 * dynamics.diffuse.values.size() +
                                     of_inverse(dynamics.diffuse.inverse));
  EXPECT_EQ(bytes.at("jiggle"), 28 * nodes + of_inverse(dynamics.jiggle.inverse));
}

}  // namespace
}  // namespace bodyopt::trainer
