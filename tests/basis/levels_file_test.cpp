#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "runtime/basis/levels.h"
#include "runtime/basis/safetensors.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "tests/support/forged_word.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/same_basis.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace levels_file_test {

using namespace testing;

// Two levels of the small basis, the second without a residual, that carry a few points.
std::vector<Level> small_levels() {
  std::vector<Level> levels(2);
  levels[0].basis = levels[1].basis = small_basis();
  levels[1].basis.strain = {};
  ResidualTable bare;
  bare.controls = levels[0].basis.residual.controls;
  const auto features = static_cast<std::size_t>(levels[0].basis.residual.feature_count());
  const std::size_t fibres = levels[0].basis.strain.fibre_count();
  bare.features.assign(features - fibres, levels[0].basis.residual.features.front());
  bare.blend_begin.assign(levels[1].basis.mesh.block_count() + 1, 0);
  levels[1].basis.residual = bare;
  levels[0].basis.metadata["levels"] = "{}";
  levels[1].basis.metadata["note"] = "the second";
  levels[0].carried = {{{0, 64, 127, 10000, 0, -20000}, {17, 0, 0, 0, 0, 0}, {5, 255, 0, 0, 1000, 0}}, 1e-6f};
  levels[1].carried = {{{3, 0, 255, 0, 0, 0}, {2, 128, 127, -32768, 0, 0}, {9, 0, 0, 0, 0, 32767}}, 2e-6f};
  return levels;
}

bool same(const CarriedSkin& a, const CarriedSkin& b) { return same_bits(a.points, b.points) && a.step == b.step; }

void read(const std::filesystem::path& path) { load_levels(path); }

TEST(LevelsFile, RoundTripIsBitExactAndTheFirstLevelIsAnOrdinaryBasis) {
  const TemporaryFolder folder;
  const std::vector<Level> levels = small_levels();
  save_levels(levels, folder / "a.safetensors");
  const std::vector<Level> loaded = load_levels(folder / "a.safetensors");
  ASSERT_EQ(loaded.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(difference(levels[k].basis, loaded[k].basis), "") << k;
    EXPECT_TRUE(same(levels[k].carried, loaded[k].carried)) << k;
  }
  save_levels(loaded, folder / "b.safetensors");
  EXPECT_EQ(read_bytes(folder / "a.safetensors"), read_bytes(folder / "b.safetensors"));

  Basis first = levels[0].basis;
  first.metadata.erase("levels");
  EXPECT_EQ(difference(first, load_basis(folder / "a.safetensors")), "");
}

TEST(LevelsFile, AnOrdinaryBasisIsOneLevelThatCarriesNothing) {
  const TemporaryFolder folder;
  save_basis(small_basis(), folder / "a.safetensors");
  const std::vector<Level> levels = load_levels(folder / "a.safetensors");
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_TRUE(levels[0].carried.empty());
  EXPECT_EQ(difference(small_basis(), levels[0].basis), "");
}

TEST(LevelsFile, WhatDoesNotBelongTogetherIsNotWritten) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& named, const auto& spoil) {
    std::vector<Level> levels = small_levels();
    spoil(levels);
    try {
      save_levels(levels, folder / "a.safetensors");
      ADD_FAILURE() << "written, expected '" << named << "'";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  };
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  expect("0 levels", [](auto& levels) { levels.clear(); });
  expect("17 levels", [](auto& levels) { levels.resize(17, levels[1]); });
  expect("level 1: carried.points has 2 entries, expected 3",
         [](auto& levels) { levels[1].carried.points.pop_back(); });
  expect("does not say where", [](auto& levels) { levels[0].carried = {}; });
  expect("carried.points[1] lies on triangle 400", [](auto& levels) { levels[0].carried.points[1].triangle = 400; });
  expect("level 1: carried.points[0] has the barycentric", [](auto& levels) { levels[1].carried.points[0].b = 1; });
  expect("carried.step", [](auto& levels) { levels[0].carried.step = kNaN; });
  expect("carried.step", [](auto& levels) { levels[0].carried.step = -1e-6f; });
  expect("level 1: carried.step", [](auto& levels) { levels[1].carried.step = 1e30f; });
  expect("its skeleton or its controls", [](auto& levels) { levels[1].basis.skeleton.joints[1].name = "other"; });
  expect("its skeleton or its controls", [](auto& levels) { levels[1].basis.residual.controls[0] = "other"; });
  expect("level 1: mesh.rest", [](auto& levels) { levels[1].basis.mesh.rest[4] = kNaN; });
}

TEST(LevelsFile, MissingAndForeignTensorsAreRefused) {
  const TemporaryFolder folder;
  save_levels(small_levels(), folder / "a.safetensors");
  const auto expect = [&](const std::string& named, const auto& spoil) {
    Safetensors file = read_safetensors(folder / "a.safetensors");
    spoil(file);
    file.metadata["checksum"] = content_checksum(file);
    write_safetensors(file, folder / "b.safetensors");
    for (const Reader& reader : {Reader(read), Reader([](const auto& path) { load_basis(path); })}) {
      expect_refused(reader, folder / "c.safetensors", read_bytes(folder / "b.safetensors"), named);
    }
  };
  expect("'level1.ddm.moments' is missing", [](Safetensors& f) { f.tensors.erase("level1.ddm.moments"); });
  expect("'level1.", [](Safetensors& f) { f.tensors.erase("level1.mesh.rest"); });
  expect("'level3.mesh.rest' is not one",
         [](Safetensors& f) { f.tensors["level3.mesh.rest"] = f.tensors["mesh.rest"]; });
  expect("'level1.skeleton.parents' is not one",
         [](Safetensors& f) { f.tensors["level1.skeleton.parents"] = f.tensors["skeleton.parents"]; });
  expect("does not say where", [](Safetensors& f) {
    f.tensors.erase("carried.points");
    f.tensors.erase("carried.step");
  });
  expect("level 1: carried.points has 0", [](Safetensors& f) {
    f.tensors.erase("level1.carried.points");
    f.tensors.erase("level1.carried.step");
  });
  expect("'carried.points' is missing", [](Safetensors& f) { f.tensors.erase("carried.points"); });
  expect("'level1.carried.points' has a shape", [](Safetensors& f) { f.tensors["level1.carried.points"].shape = {9}; });
  expect("'level1.carried.step' is missing", [](Safetensors& f) { f.tensors.erase("level1.carried.step"); });
  expect("'carried.step' is not of one number", [](Safetensors& f) {
    f.tensors["carried.step"].shape = {2};
    f.tensors["carried.step"].bytes.resize(8);
  });
  expect("'carried.points' has type F32", [](Safetensors& f) { f.tensors["carried.points"].dtype = "F32"; });
  expect("'level1.controls'", [](Safetensors& f) { f.metadata.erase("level1.controls"); });
  expect("'level1.fibre_names'", [](Safetensors& f) { f.metadata["level1.fibre_names"] = "{}"; });
}

// What is not refused runs: nothing is read outside a table, and no point is carried to a number that is none.
TEST(LevelsFile, ForgedWordsAreRefusedOrHarmless) {
  const TemporaryFolder folder;
  save_levels(small_levels(), folder / "a.safetensors");
  std::mt19937 random(11);
  int refused = 0, accepted = 0;
  for (int k = 0; k < 300; ++k) {
    Safetensors file = read_safetensors(folder / "a.safetensors");
    std::erase_if(file.tensors, [](const auto& tensor) { return tensor.first.find("carried") == std::string::npos; });
    const std::string what = forge_word(file, random);
    Safetensors whole = read_safetensors(folder / "a.safetensors");
    for (auto& [name, tensor] : file.tensors) whole.tensors[name] = tensor;
    whole.metadata["checksum"] = content_checksum(whole);
    write_safetensors(whole, folder / "b.safetensors");
    if (refuses(read, folder / "b.safetensors", what)) {
      ++refused;
      continue;
    }
    ++accepted;
    for (const Level& level : load_levels(folder / "b.safetensors")) {
      Deformer deformer(level.basis, {.name = "cpu"});
      const Pose pose = bind_pose(level.basis.skeleton);
      const Evaluation frame = deformer.evaluate({&pose, 1});
      for (const float x : carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals)) {
        EXPECT_TRUE(std::isfinite(x)) << what;
      }
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(accepted, 20);
}

}  // namespace levels_file_test
}  // namespace bodyopt
