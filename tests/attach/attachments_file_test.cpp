#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <span>

#include "runtime/basis/safetensors.h"
#include "runtime/core/error.h"
#include "runtime/deformer/following_meshes.h"
#include "tests/support/attached_limb.h"
#include "tests/support/forged_word.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

Attachments small() { return attached_to_limb({sphere_at("button", {0.057, 0, 0.31}, 0.006), blade()}); }

Reader reader_of(const Basis& basis) {
  return [&](const std::filesystem::path& path) { load_attachments(path, basis); };
}

TEST(AttachmentsFile, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  const Attachments attachments = limb_outfit();
  save_attachments(attachments, folder / "a.safetensors");
  const Attachments loaded = load_attachments(folder / "a.safetensors", limb_basis());
  EXPECT_EQ(loaded.metadata, attachments.metadata);
  ASSERT_EQ(loaded.meshes.size(), attachments.meshes.size());
  for (std::size_t k = 0; k < loaded.meshes.size(); ++k) {
    EXPECT_EQ(loaded.meshes[k].name, attachments.meshes[k].name);
    EXPECT_EQ(loaded.meshes[k].bound, attachments.meshes[k].bound);
    EXPECT_EQ(loaded.meshes[k].rest, attachments.meshes[k].rest);
    EXPECT_EQ(loaded.meshes[k].triangles, attachments.meshes[k].triangles);
    EXPECT_EQ(loaded.meshes[k].vertex_anchor, attachments.meshes[k].vertex_anchor);
    EXPECT_EQ(loaded.meshes[k].point_begin, attachments.meshes[k].point_begin);
    const auto bytes = [&](const Attachments& of) { return std::as_bytes(std::span(of.meshes[k].points)); };
    EXPECT_TRUE(std::ranges::equal(bytes(loaded), bytes(attachments)));
  }
  save_attachments(loaded, folder / "b.safetensors");
  EXPECT_EQ(read_bytes(folder / "a.safetensors"), read_bytes(folder / "b.safetensors"));
}

TEST(AttachmentsFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  save_attachments(attached_to_limb({blade()}), folder / "a.safetensors");
  expect_every_truncation_refused(reader_of(limb_basis()), folder / "b.safetensors",
                                  read_bytes(folder / "a.safetensors"));
}

TEST(AttachmentsFile, DamagedBytesAreRefused) {
  const TemporaryFolder folder;
  save_attachments(small(), folder / "a.safetensors");
  EXPECT_EQ(damage_bytes(reader_of(limb_basis()), folder / "b.safetensors", read_bytes(folder / "a.safetensors"), 1000),
            1000u);
}

// Words of the tables replaced by the worst there are, under a checksum that fits: refused, or carried without harm.
TEST(AttachmentsFile, ForgedTablesAreRefusedOrCarried) {
  const TemporaryFolder folder;
  save_attachments(small(), folder / "a.safetensors");
  const Safetensors file = read_safetensors(folder / "a.safetensors");
  const Basis& basis = limb_basis();
  const Pose pose = bind_pose(basis.skeleton);
  std::vector<float> skin;
  for (const std::uint32_t v : basis.mesh.output_vertex) {
    skin.insert(skin.end(), {basis.mesh.rest[3 * v], basis.mesh.rest[3 * v + 1], basis.mesh.rest[3 * v + 2]});
  }
  std::mt19937 random(17);
  int accepted = 0, refused_words = 0;
  for (int k = 0; k < 300; ++k) {
    Safetensors forged = file;
    const std::string word = forge_word(forged, random);
    forged.metadata["checksum"] = content_checksum(forged);
    write_safetensors(forged, folder / "b.safetensors");
    const auto carry = [&](const auto& path) {
      const Attachments loaded = load_attachments(path, basis);
      for (const auto& mesh : FollowingMeshes(basis, loaded).carry(skin, pose.joints)) {
        for (const float x : mesh) ASSERT_TRUE(std::isfinite(x)) << word;
      }
    };
    const bool refused = refuses(carry, folder / "b.safetensors", word);
    accepted += refused ? 0 : 1;
    refused_words += refused && word.starts_with("U32") ? 1 : 0;
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused_words, 20);
}

TEST(AttachmentsFile, WhatIsWrongIsNamed) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<const char*, std::function<void(AttachedMesh&)>> cases[] = {
      {"its name is none that a file can have", [](AttachedMesh& m) { m.name = "../button"; }},
      {"its name is none that a file can have", [](AttachedMesh& m) { m.name = ""; }},
      {"two meshes called 'blade'", [](AttachedMesh& m) { m.name = "blade"; }},
      {"rest has 0 entries", [](AttachedMesh& m) { m.rest.clear(); }},
      {"rest has", [](AttachedMesh& m) { m.rest.pop_back(); }},
      {"rest[4] is nan", [](AttachedMesh& m) { m.rest[4] = kNan; }},
      {"triangles is not", [](AttachedMesh& m) { m.triangles.pop_back(); }},
      {"triangles[5] is 4294967295", [](AttachedMesh& m) { m.triangles[5] = ~0u; }},
      {"vertex_anchor has", [](AttachedMesh& m) { m.vertex_anchor.pop_back(); }},
      {"vertex_anchor[3] is 1", [](AttachedMesh& m) { m.vertex_anchor[3] = 1; }},
      {"anchors[0] is inf", [](AttachedMesh& m) { m.anchors[0].y = std::numeric_limits<float>::infinity(); }},
      {"anchors[0] is 3", [](AttachedMesh& m) { m.anchors[0].joint = 3; }},
      {"skin stands elsewhere", [](AttachedMesh& m) { m.anchors[0].z += 0.01f; }},
      {"point_begin has", [](AttachedMesh& m) { m.point_begin.push_back(0); }},
      {"point_begin ends", [](AttachedMesh& m) { m.point_begin[1] = 1; }},
      {"points[1] is 578", [](AttachedMesh& m) { m.points[0].b = 578; }},
      {"points[2] has weights", [](AttachedMesh& m) { m.points[2].wb += 0.5f; }},
      {"points[2] has a weight below 0", [](AttachedMesh& m) { m.points[2].wb = -1; }},
      {"points[2] is nan", [](AttachedMesh& m) { m.points[2].wc = kNan; }},
  };
  for (const auto& [named, change] : cases) {
    Attachments attachments = small();
    change(attachments.meshes[0]);
    try {
      validate(attachments, limb_basis(), "here.safetensors");
      ADD_FAILURE() << "accepted: " << named;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind("here.safetensors", 0), 0u) << text;
      EXPECT_NE(text.find(named), std::string::npos) << "expected '" << named << "' in: " << text;
    }
  }
}

TEST(AttachmentsFile, AnotherCharactersAreRefused) {
  const auto expect = [&](const char* named, const std::function<void(Basis&)>& change) {
    Basis other = limb_basis();
    change(other);
    try {
      validate(small(), other, "here");
      ADD_FAILURE() << "accepted: " << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::mismatch);
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  };
  expect("the mesh is another", [](Basis& b) { std::swap(b.mesh.triangles[0], b.mesh.triangles[1]); });
  expect("the skeleton is another", [](Basis& b) { b.skeleton.joints[1].name = "else"; });
  expect("skin stands elsewhere", [](Basis& b) {
    for (float& x : b.mesh.rest) x *= 1.01f;
  });
}

TEST(AttachmentsFile, NamesAreOnesThatFilesCanHave) {
  EXPECT_EQ(attachment_name("left eye.001"), "left eye.001");
  EXPECT_EQ(attachment_name("../a\\b:c\n"), ".._a_b_c_");
  EXPECT_EQ(attachment_name(""), "_");
  EXPECT_EQ(attachment_name(std::string(99, 'a') + "é"), std::string(99, 'a'));  // no half of a letter
  EXPECT_EQ(attachment_name(std::string(300, 'a')).size(), kLongestAttachedName);
}

}  // namespace
}  // namespace bodyopt::trainer
