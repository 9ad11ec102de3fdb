// train, attach, eval and info with geometry that rides on the skin.
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "runtime/core/json.h"
#include "runtime/host/rig.h"
#include "tests/support/limb_glb.h"
#include "tests/support/run_verb.h"

namespace bodyopt::trainer {
namespace {

// A limb whose file has an eye below its last joint, a basis trained from it, and a clip that bends it.
class Attach : public ::testing::Test {
 protected:
  void SetUp() override {
    LimbGlb blob(path("limb.glb"));
    blob.add_node("eye", blob.add_mesh(sphere_at("", {0, 0, 0.02}, 0.008)), 2);
    put_bytes(path("limb.glb"), blob.glb());
    Clip clip;
    clip.name = "bend";
    for (int f = 0; f < 5; ++f) clip.poses.push_back(limb_pose(limb_character().skeleton, 0.3 * f, 0.1 * f, -0.1 * f));
    write_clip(clip, limb_character().skeleton, path("bend.glb"));
    trained_ = run_verb("train --ddm-only " + path("limb.glb") + " --out " + path("limb.safetensors"));
    ASSERT_EQ(trained_.exit_code, 0) << trained_.output;
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // A file with one mesh of that name.
  std::string prop(const LooseMesh& mesh, double units_per_metre = 1) const {
    LimbGlb blob(path("scratch.glb"));
    blob.root["nodes"].clear();
    blob.root.erase("skins");
    blob.add_node(mesh.name, blob.add_mesh(mesh, units_per_metre), -1);
    put_bytes(path(mesh.name + ".glb"), blob.glb());
    return path(mesh.name + ".glb");
  }
  ProgramResult attach(const std::string& arguments) const { return run_verb("attach " + arguments); }
  ProgramResult eval(const std::string& options = "") const {
    return run_verb("eval " + path("limb.safetensors") + " --clip " + path("bend.glb") + " --frames 2-5 --device cpu " +
                    "--out " + path("shot.pc2") + " " + options);
  }
  void expect(const ProgramResult& result, int exit_code, const std::string& named) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << "expected '" << named << "' in:\n" << result.output;
  }

  TemporaryFolder folder_;
  ProgramResult trained_;
};

TEST_F(Attach, TrainAttachesWhatHangsOnTheCharactersJointsAndEvalCarriesIt) {
  expect(trained_, 0, "attached eye, 56 vertices: 1 piece fixed to joint 'joint2'");
  expect(eval(), 0, "wrote " + path("shot.eye.pc2"));
  const Pc2Reader reader(path("shot.eye.pc2"));
  ASSERT_EQ(reader.point_count(), 56u);
  ASSERT_EQ(reader.sample_count(), 4u);
  EXPECT_EQ(reader.start_frame(), 2.0f);
  const LooseMesh eye = sphere_at("", {0, 0, 0.52}, 0.008);  // joint2 rests at 0.5
  const Skeleton skeleton = limb_character().skeleton;
  for (std::uint32_t f = 0; f < 4; ++f) {
    const Pose pose = limb_pose(skeleton, 0.3 * (f + 1), 0.1 * (f + 1), -0.1 * (f + 1));
    const Affine joint = skinning_matrices(skeleton, pose.joints)[2];
    for (std::size_t v = 0; v < eye.vertices.size(); ++v) {
      const Vec3 expected = joint * eye.vertices[v];
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(static_cast<double>(reader.sample(f)[3 * v + i]), expected[i], 1e-5);
      }
    }
  }
}

// From shapes: the whole way of a character with an eye.
TEST_F(Attach, TrainAndProxyOfADatasetAttachThemToo) {
  const SampleSet set = limb_samples(40, 0);
  Clip motion;
  motion.name = "motion";
  Pc2Writer writer(path("shapes.pc2"), set.character.output_count(), 40);
  for (const Sample& sample : set.train) {
    motion.poses.push_back(sample.pose);
    writer.append(output_from_welded(set.character, sample.shape.read()));
  }
  writer.close();
  write_clip(motion, set.character.skeleton, path("motion.glb"));
  const std::string data = path("data"), clip = " --clip " + path("motion.glb");
  expect(
      run_verb("dataset add " + data + clip + " --shapes " + path("shapes.pc2") + " --character " + path("limb.glb")),
      0, "");
  const std::string attached = "attached eye, 56 vertices: 1 piece fixed to joint 'joint2'";
  expect(run_verb("train " + data + " --out " + path("full.safetensors")), 0, attached);
  expect(run_verb("proxy " + data + " --error 1 --out " + path("light.safetensors")), 0, attached);
  expect(run_verb("proxy " + path("full.safetensors") + clip + " --character " + path("limb.glb") +
                  " --error 1 --out " + path("taught.safetensors")),
         0, attached);
  std::vector<std::vector<float>> eyes;
  for (const char* name : {"full", "light", "taught"}) {
    expect(run_verb("eval " + path(std::string(name) + ".safetensors") + clip + " --device cpu --out " +
                    path(std::string(name) + ".pc2")),
           0, path(std::string(name) + ".eye.pc2"));
    eyes.push_back(Pc2Reader(path(std::string(name) + ".eye.pc2")).sample(9));
    // The eye, not the skin that a proxy replaces.
    EXPECT_EQ(load_attachments(path(std::string(name) + ".attached.safetensors")).meshes.size(), 1u) << name;
  }
  const LooseMesh eye = sphere_at("", {0, 0, 0.52}, 0.008);
  const Affine joint = skinning_matrices(set.character.skeleton, set.train[9].pose.joints)[2];
  ASSERT_EQ(eyes[0].size(), 3 * eye.vertices.size());
  for (std::size_t v = 0; v < eye.vertices.size(); ++v) {
    const Vec3 expected = joint * eye.vertices[v];
    for (std::size_t i = 0; i < 3; ++i) {
      for (const std::vector<float>& found : eyes) {
        EXPECT_NEAR(static_cast<double>(found[3 * v + i]), expected[i], 1e-5);
      }
    }
  }
}

TEST_F(Attach, MeshesAreAddedReplacedAndListed) {
  const std::string basis = path("limb.safetensors");
  expect(attach(prop(sleeve(0.008)) + " " + basis), 0, "1 piece following the skin, 8 to 8.8");
  expect(attach(prop(blade()) + " " + basis), 0, ": 3 meshes");
  expect(attach(path("blade.glb") + " " + basis + " --joint joint0"), 0, ": 3 meshes");
  const ProgramResult info = run_verb("info " + path("limb.attached.safetensors") + " --json -");
  const Json meshes = Json::parse(info.output).at("meshes");
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].at("name"), "eye");
  EXPECT_EQ(meshes[1].at("name"), "sleeve");
  EXPECT_EQ(meshes[1].at("vertices"), 31 * 24);
  EXPECT_EQ(meshes[2].at("bound").get<std::string>().rfind("1 piece fixed to joint 'joint0'", 0), 0u) << meshes;
  const ProgramResult of_basis = run_verb("info " + basis + " --json -");
  EXPECT_EQ(Json::parse(of_basis.output).at("attached"), meshes);
  expect(eval(), 0, "shot.sleeve.pc2");
  EXPECT_TRUE(std::filesystem::exists(path("shot.blade.pc2")));
  expect(run_verb("train --ddm-only " + path("limb.glb") + " --out " + basis), 0, "attached eye");
  expect(eval(), 0, "shot.sleeve.pc2");  // a new training keeps what was attached
}

TEST_F(Attach, AnotherFileOfAttachmentsIsTakenByName) {
  const std::string basis = path("limb.safetensors");
  expect(attach(prop(blade()) + " " + basis + " --out " + path("sword.safetensors")), 0, ": 1 mesh");
  expect(eval("--attached " + path("sword.safetensors")), 0, "shot.blade.pc2");
  EXPECT_FALSE(std::filesystem::exists(path("shot.eye.pc2")));
  expect(eval("--attached " + path("none.safetensors")), 4, "none.safetensors");
}

TEST_F(Attach, WhatDoesNotFitIsRefused) {
  const std::string basis = " " + path("limb.safetensors");
  expect(attach(prop(sleeve(0.008), 100) + basis), 3, "With --unit 0.01 it is");
  expect(attach(path("sleeve.glb") + basis + " --unit 0.01"), 0, "following the skin");
  expect(attach(path("sleeve.glb") + basis + " --joint Joint1x"), 64, "the nearest names are 'joint1', ");
  expect(attach(path("sleeve.glb") + basis + " --joint joint1 --mode skin"), 64, "does not go with --mode skin");
  expect(attach(path("sleeve.glb") + basis + " --only cuff"), 4, "has no mesh 'cuff' to attach; it has 'sleeve'");
  expect(attach(path("bend.glb") + basis), 4, "has no mesh to attach");
  expect(attach(path("none.glb") + basis), 4, "no such file");
  expect(attach(path("sleeve.glb") + basis + " --out" + basis), 64, "would write over the input");

  Character longer = limb_character();
  longer.vertices *= 1.1;
  write_character(longer, path("longer.glb"));
  expect(run_verb("train --ddm-only " + path("longer.glb") + " --out " + path("longer.safetensors")), 0, "wrote");
  expect(run_verb("eval " + path("longer.safetensors") + " --clip " + path("bend.glb") + " --device cpu --out " +
                  path("x.pc2") + " --attached " + path("limb.attached.safetensors")),
         3, "is not attached to");
  EXPECT_FALSE(std::filesystem::exists(path("x.pc2")));
}

// What an earlier character of that name left beside its basis.
TEST_F(Attach, StaleAttachmentsBesideABasisAreRefusedByName) {
  Character other = limb_character();
  other.triangles.row(0).swap(other.triangles.row(1));
  other.output_triangles = other.triangles;
  write_character(other, path("other.glb"));
  expect(attach(prop(sleeve(0.008)) + " " + path("limb.safetensors")), 0, "wrote");
  expect(run_verb("train --ddm-only " + path("other.glb") + " --out " + path("limb.safetensors")), 0, "wrote");
  const std::string both =
      path("limb.attached.safetensors") + ": is not attached to " + path("limb.safetensors") + ": the mesh is another";
  expect(eval(), 3, both);
  expect(attach(prop(blade()) + " " + path("limb.safetensors")), 3, both);
  expect(run_verb("info " + path("limb.safetensors")), 3, both);
  EXPECT_FALSE(std::filesystem::exists(path("shot.pc2")));
}

}  // namespace
}  // namespace bodyopt::trainer
