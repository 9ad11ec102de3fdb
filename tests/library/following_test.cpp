// What follows the skin as further outputs: attached meshes and the full skin of a level of detail, with the bits of
// the rooms; and poses that are given as skinning matrices.
#include <algorithm>
#include <fstream>
#include <numeric>

#include "runtime/basis/levels.h"
#include "runtime/deformer/following_meshes.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/rig.h"
#include "tests/library/c_api.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace following_test {

constexpr std::size_t kFrames = 3;

std::string hero_attached() { return kept_file("hero.attached.safetensors"); }

// Outputs of all attached meshes, and of the skin.
struct Dressed {
  Dressed(const Basis& basis, const Attachments& attached, std::size_t frames) : skin(basis, frames) {
    for (const AttachedMesh& mesh : attached.meshes) meshes.emplace_back(frames * mesh.rest.size());
    for (std::vector<float>& mesh : meshes) outputs.push_back(floats_in(mesh));
    skin.all.attached = outputs.data();
    skin.all.attached_count = static_cast<std::uint32_t>(outputs.size());
  }

  Arrays skin;
  std::vector<std::vector<float>> meshes;
  std::vector<bodyopt_floats> outputs;
};

class LibraryFollowing : public GpuTest {
 protected:
  // What the meshes do on a skin of these poses: of each mesh all frames.
  std::vector<std::vector<float>> carried(const std::vector<float>& skin, const std::vector<Pose>& poses) const {
    const FollowingMeshes carrier(basis_, attached_);
    const std::size_t stride = skin.size() / poses.size();
    std::vector<std::vector<float>> all(attached_.meshes.size());
    for (std::size_t f = 0; f < poses.size(); ++f) {
      const auto frame = carrier.carry(std::span(skin).subspan(f * stride, stride), poses[f].joints);
      for (std::size_t m = 0; m < all.size(); ++m) all[m].insert(all[m].end(), frame[m].begin(), frame[m].end());
    }
    return all;
  }

  void refuses(const bodyopt_poses& poses, const bodyopt_skin& skin, bodyopt_result expected, const std::string& said,
               const api::Instance& instance) {
    EXPECT_EQ(bodyopt_evaluate(instance.get(), &poses, &skin), expected) << said;
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
  }

  const Basis basis_ = load_basis(hero());
  const Attachments attached_ = load_attachments(hero_attached(), basis_);
  const api::Model model_ = api::load_model(hero(), hero_dynamics(), hero_attached());
  const std::vector<Pose> poses_ = turning_poses(basis_, kFrames);
  PoseArrays given_{poses_};
};

TEST_F(LibraryFollowing, AttachedMeshesAreDescribed) {
  ASSERT_EQ(api::describe(model_).attached_count, attached_.meshes.size());
  ASSERT_FALSE(attached_.meshes.empty());
  auto found = api::make<bodyopt_attached>();
  for (std::uint32_t m = 0; m < attached_.meshes.size(); ++m) {
    const AttachedMesh& mesh = attached_.meshes[m];
    api::check(bodyopt_describe_attached(model_.get(), m, &found));
    EXPECT_EQ(found.name, mesh.name);
    EXPECT_EQ(found.vertex_count, mesh.vertex_count());
    EXPECT_EQ(found.triangle_count, mesh.triangle_count());
    std::vector<std::uint32_t> triangles(mesh.triangles.size());
    const std::size_t bytes = triangles.size() * sizeof(std::uint32_t);
    EXPECT_EQ(bodyopt_get_attached_triangles(model_.get(), m, triangles.data(), bytes - 1), BODYOPT_USAGE);
    api::check(bodyopt_get_attached_triangles(model_.get(), m, triangles.data(), bytes));
    EXPECT_EQ(triangles, mesh.triangles);
  }
  EXPECT_EQ(bodyopt_describe_attached(model_.get(), found.struct_size, &found), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_get_attached_triangles(model_.get(), 99, nullptr, 0), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_describe_attached(nullptr, 0, &found), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_describe_attached(model_.get(), 0, nullptr), BODYOPT_USAGE);
  found.struct_size = 8;
  EXPECT_EQ(bodyopt_describe_attached(model_.get(), 0, &found), BODYOPT_USAGE);
}

TEST_F(LibraryFollowing, AttachedMeshesHaveTheBitsOfTheCarrier) {
  const api::Device device = api::open_device();
  for (const api::Device* on : {static_cast<const api::Device*>(nullptr), &device}) {
    for (const bool jiggles : {false, true}) {
      SCOPED_TRACE(jiggles ? "jiggle" : "still");
      const api::Device none;
      const api::Instance instance = make_instance(model_, jiggles, on != nullptr ? *on : none);
      const auto run = jiggles ? bodyopt_jiggle : bodyopt_evaluate;
      Dressed found(basis_, attached_, kFrames);
      ASSERT_EQ(run(instance.get(), &given_.all, &found.skin.all), BODYOPT_OK) << bodyopt_last_error();
      EXPECT_EQ(found.meshes, carried(found.skin.positions, poses_));
      // The skin beside them is that without them.
      Arrays alone(basis_, kFrames);
      const api::Instance other = make_instance(model_, jiggles, on != nullptr ? *on : none);
      ASSERT_EQ(run(other.get(), &given_.all, &alone.all), BODYOPT_OK) << bodyopt_last_error();
      EXPECT_EQ(found.skin.positions, alone.positions);
      EXPECT_EQ(found.skin.normals, alone.normals);
    }
  }
}

// One mesh of several, with gaps, without a skin, in more frames than a batch has.
TEST_F(LibraryFollowing, AttachedMeshesAreWrittenWhereTheyAreWanted) {
  constexpr std::size_t kMany = 150;
  const std::vector<Pose> poses = turning_poses(basis_, kMany);
  const PoseArrays given(poses);
  Dressed all(basis_, attached_, kMany);
  const api::Instance instance = make_instance(model_);
  api::check(bodyopt_evaluate(instance.get(), &given.all, &all.skin.all));
  const std::size_t vertices = attached_.meshes.back().vertex_count(), stride = 5;
  std::vector<float> wide(kMany * vertices * stride, -7.0f);
  std::vector<bodyopt_floats> outputs(attached_.meshes.size());
  outputs.back() = {wide.data(), wide.size() * sizeof(float), stride * sizeof(float), 0};
  outputs.back().frame_stride = vertices * stride * sizeof(float);
  auto skin = api::make<bodyopt_skin>();
  skin.attached = outputs.data();
  skin.attached_count = static_cast<std::uint32_t>(outputs.size());
  api::check(bodyopt_evaluate(instance.get(), &given.all, &skin));
  for (std::size_t k = 0; k < kMany * vertices; ++k) {
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(wide[stride * k + i], all.meshes.back()[3 * k + i]) << k;
    ASSERT_EQ(wide[stride * k + 3], -7.0f);
    ASSERT_EQ(wide[stride * k + 4], -7.0f);
  }
}

TEST_F(LibraryFollowing, AttachedMeshesOfMemoryAreThoseOfTheirFile) {
  const std::string basis = read_bytes(hero()), attached = read_bytes(hero_attached());
  auto options = api::make<bodyopt_load_options>();
  options.attached_data = attached.data();
  options.attached_size = attached.size();
  bodyopt_model* loaded = nullptr;
  api::check(bodyopt_load_model_from_memory(basis.data(), basis.size(), &options, &loaded));
  const api::Model model(loaded);
  Dressed found(basis_, attached_, kFrames), expected(basis_, attached_, kFrames);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given_.all, &found.skin.all));
  api::check(bodyopt_evaluate(make_instance(model_).get(), &given_.all, &expected.skin.all));
  EXPECT_EQ(found.meshes, expected.meshes);
}

TEST_F(LibraryFollowing, FilesThatAreNotAttachedAreRefused) {
  const auto refuses_options = [&](const bodyopt_load_options& options, bodyopt_result expected,
                                   const std::string& said) {
    bodyopt_model* loaded = nullptr;
    EXPECT_EQ(bodyopt_load_model(hero().c_str(), &options, &loaded), expected) << said;
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
    EXPECT_EQ(loaded, nullptr);
  };
  const TemporaryFolder folder;
  const std::string bytes = read_bytes(hero_attached()), dynamics = hero_dynamics(), attached = hero_attached();
  auto options = api::make<bodyopt_load_options>();
  options.attached = "/no/such.safetensors";
  refuses_options(options, BODYOPT_FILE, "/no/such.safetensors");
  options.attached = dynamics.c_str();
  refuses_options(options, BODYOPT_FILE, "not attached geometry");
  options.attached = attached.c_str();
  options.attached_data = bytes.data();
  options.attached_size = bytes.size();
  refuses_options(options, BODYOPT_USAGE, "both 'options.attached' and 'options.attached_data'");
  options.attached = nullptr;
  options.attached_size = bytes.size() / 2;
  refuses_options(options, BODYOPT_FILE, "'options.attached_data' in memory");
  Attachments others = attached_;
  others.metadata["topology_hash"] = "00";
  save_attachments(others, folder / "others.safetensors");
  const std::string other = folder / "others.safetensors";
  options.attached_data = nullptr;
  options.attached = other.c_str();
  refuses_options(options, BODYOPT_MISMATCH, "is not attached to this basis");
}

TEST_F(LibraryFollowing, WrongOutputsAreRefused) {
  const api::Instance instance = make_instance(model_);
  Dressed found(basis_, attached_, kFrames);
  bodyopt_skin skin = found.skin.all;
  skin.attached_count += 1;
  refuses(given_.all, skin, BODYOPT_USAGE, "attached meshes", instance);
  skin = found.skin.all;
  skin.attached = nullptr;
  refuses(given_.all, skin, BODYOPT_USAGE, "'skin.attached' is a null pointer", instance);
  found.outputs[0].size -= 4;
  refuses(given_.all, found.skin.all, BODYOPT_USAGE, "'skin.attached[0]' has", instance);
  found.outputs[0].element_stride = 8;
  refuses(given_.all, found.skin.all, BODYOPT_USAGE, "skin.attached[0].element_stride is 8", instance);
  const api::Model bare = api::load_model(hero());
  refuses(given_.all, found.skin.all, BODYOPT_USAGE, "the model has 0 attached meshes", make_instance(bare));
  Arrays full(basis_, kFrames);
  full.all.full_positions = floats_in(full.normals);
  refuses(given_.all, full.all, BODYOPT_USAGE, "carries no full skin", instance);
}

// Of a level that is carried at random, two of whose points it has for each of its own vertices.
TEST_F(LibraryFollowing, TheFullSkinHasTheBitsOfTheLevels) {
  Level level{basis_, {}};
  level.carried.step = 1e-5f;
  const auto triangles = static_cast<std::uint32_t>(basis_.mesh.output_triangles.size() / 3);
  for (std::uint32_t k = 0; k < basis_.mesh.output_count(); ++k) {
    level.carried.points.push_back({7 * k % triangles, static_cast<std::uint8_t>(k % 100),
                                    static_cast<std::uint8_t>(k % 130), static_cast<std::int16_t>(k % 50), 3, -4});
  }
  const TemporaryFolder folder;
  save_levels({{level.basis, level.carried}}, folder / "proxy.safetensors");
  const api::Model proxy = api::load_model(folder / "proxy.safetensors");
  ASSERT_EQ(api::describe(proxy).full_vertex_count, level.carried.size());
  Arrays found(basis_, kFrames);
  std::vector<float> full(3 * level.carried.size() * kFrames);
  found.all.full_positions = floats_in(full);
  api::check(bodyopt_evaluate(make_instance(proxy).get(), &given_.all, &found.all));
  EXPECT_EQ(full, carry_skin(basis_.mesh, level.carried, found.positions, found.normals));
  // Neither positions nor normals are wanted beside it.
  std::vector<float> alone(full.size());
  auto skin = api::make<bodyopt_skin>();
  skin.full_positions = floats_in(alone);
  api::check(bodyopt_evaluate(make_instance(proxy).get(), &given_.all, &skin));
  EXPECT_EQ(alone, full);
}

// Skinning matrices of these poses, with gaps of `gap` numbers after each.
std::vector<float> matrices_of(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t gap) {
  std::vector<float> all;
  for (const Pose& pose : poses) {
    for (const Affine& matrix : skinning_matrices(skeleton, pose.joints)) {
      for (const auto& row : matrix.m) {
        for (const double x : row) all.push_back(static_cast<float>(x));
      }
      all.insert(all.end(), gap, std::nanf(""));
    }
  }
  return all;
}

bodyopt_poses by_matrices(const PoseArrays& given, const std::vector<float>& matrices, std::size_t gap) {
  bodyopt_poses poses = given.all;
  poses.joints = nullptr;
  poses.joint_stride = 0;
  poses.skinning = matrices.data();
  poses.skinning_stride = (12 + gap) * sizeof(float);
  return poses;
}

// What was learned reads the same rotations of them, and attached meshes follow: at most what rounding the matrices to
// single precision moves.
TEST_F(LibraryFollowing, SkinningMatricesGiveTheSkinOfTheirJoints) {
  std::vector<Pose> poses = poses_;
  poses[1].joints[1].scale = {1.25, 0.8, 1.1};
  poses[2].joints[0].scale = {-1, 1, 1};
  poses[2].joints[0].rotation = axis_angle({1, 2, 3}, 2.5);
  const PoseArrays given(poses);
  for (const std::size_t gap : {0u, 4u}) {
    const std::vector<float> matrices = matrices_of(basis_.skeleton, poses, gap);
    const bodyopt_poses asked = by_matrices(given, matrices, gap);
    Dressed found(basis_, attached_, kFrames), expected(basis_, attached_, kFrames);
    ASSERT_EQ(bodyopt_evaluate(make_instance(model_).get(), &asked, &found.skin.all), BODYOPT_OK)
        << bodyopt_last_error();
    api::check(bodyopt_evaluate(make_instance(model_).get(), &given.all, &expected.skin.all));
    for (std::size_t k = 0; k < found.skin.positions.size(); ++k) {
      ASSERT_NEAR(found.skin.positions[k], expected.skin.positions[k], 2e-6) << k;
    }
    for (std::size_t k = 0; k < found.meshes[0].size(); ++k) {
      ASSERT_NEAR(found.meshes[0][k], expected.meshes[0][k], 5e-6) << k;
    }
    for (std::size_t f = 0; f < kFrames; ++f) {
      EXPECT_NEAR(found.skin.outside[f], expected.skin.outside[f], 1e-3f * (1 + expected.skin.outside[f]));
    }
  }
}

TEST_F(LibraryFollowing, MatricesOfNoPoseAreRefused) {
  const api::Instance instance = make_instance(model_);
  const std::vector<float> sound = matrices_of(basis_.skeleton, poses_, 0);
  const auto refuses_matrix = [&](const std::vector<float>& joint, const std::string& said) {
    std::vector<float> spoilt = sound;
    std::ranges::copy(joint, spoilt.begin() + 12);
    refuses(by_matrices(given_, spoilt, 0), Arrays(basis_, kFrames).all, BODYOPT_MISMATCH, said, instance);
  };
  refuses_matrix({std::nanf("")}, "is not of finite numbers");
  refuses_matrix({HUGE_VALF}, "is not of finite numbers");
  refuses_matrix(std::vector<float>(12, 0.0f), "scaled by 0");
  refuses_matrix({1, 0.3f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, "it is sheared");
  Arrays skin(basis_, kFrames);
  bodyopt_poses poses = by_matrices(given_, sound, 0);
  poses.joints = given_.all.joints;
  refuses(poses, skin.all, BODYOPT_USAGE, "both 'poses.joints' and 'poses.skinning'", instance);
  poses = by_matrices(given_, sound, 0);
  poses.skinning_stride = 44;
  refuses(poses, skin.all, BODYOPT_USAGE, "poses.skinning_stride is 44", instance);
  poses.skinning_stride = 50;
  refuses(poses, skin.all, BODYOPT_USAGE, "no multiple of 4", instance);
  poses.skinning_stride = 0;
  poses.skinning = reinterpret_cast<const float*>(1 + reinterpret_cast<std::uintptr_t>(poses.skinning));
  refuses(poses, skin.all, BODYOPT_USAGE, "'poses.skinning' is not aligned", instance);
}

}  // namespace following_test
}  // namespace bodyopt::testing
