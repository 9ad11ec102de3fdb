// Tangents by bodyopt.h: those of the kernel, bit for bit, wherever they are written; on a device, too.
#include <cstddef>

#include "runtime/basis/output_order.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/skin_tables.h"
#include "tests/library/c_api.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {
namespace tangents_test {

constexpr std::size_t kFrames = 3;

// Tangents of frames, alone or with the rest of the skin.
struct Frames {
  Frames(const api::Instance& instance, const Basis& basis, const std::vector<Pose>& poses, bool with_skin = true)
      : skin(basis, poses.size()), tangents(4 * basis.mesh.output_count() * poses.size()) {
    if (!with_skin) skin.all = api::make<bodyopt_skin>();
    skin.all.tangents = floats_in(tangents);
    const PoseArrays given(poses);
    api::check(bodyopt_evaluate(instance.get(), &given.all, &skin.all));
  }

  Arrays skin;
  std::vector<float> tangents;
};

std::vector<float> kernels_tangents(const Basis& basis, const Arrays& skin, std::size_t frames) {
  const TangentTables tables = tangent_tables(basis.mesh, texture_of(basis));
  const std::size_t outputs = basis.mesh.output_count(), numbers = 3 * outputs;
  std::vector<float> tangents(4 * outputs * frames);
  for (std::size_t f = 0; f < frames; ++f) {
    const auto frame = [&](const std::vector<float>& values) {
      return vertices_of(basis.mesh, std::span(values).subspan(f * numbers, numbers));
    };
    cpu::output_tangents(tables, frame(skin.positions), frame(skin.normals), 0,
                         std::span(tangents).subspan(4 * outputs * f, 4 * outputs));
  }
  return tangents;
}

TEST(LibraryTangents, AreThoseOfTheKernelAlsoAlone) {
  const Basis basis = load_basis(hero());
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const api::Model model = load_textured();
  EXPECT_EQ(api::describe(model).has_tangents, 1u);
  const api::Instance instance = make_instance(model);
  const Frames found(instance, basis, poses);
  EXPECT_EQ(found.tangents, kernels_tangents(basis, found.skin, kFrames));
  EXPECT_EQ(Frames(instance, basis, poses, false).tangents, found.tangents);
  std::size_t units = 0;
  for (std::size_t k = 0; k < found.tangents.size(); k += 4) {
    const float* t = &found.tangents[k];
    units += std::abs(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] - 1) < 1e-5f && std::abs(t[3]) == 1;
  }
  EXPECT_GT(units, kFrames * basis.mesh.output_count() * 9 / 10);
}

TEST(LibraryTangents, TurnWithTheCharacter) {
  const Basis basis = load_basis(hero());
  Pose turned = bind_pose(basis.skeleton);
  turned.joints[0].rotation = axis_angle({0, 0, 1}, 0.5 * M_PI) * turned.joints[0].rotation;
  const api::Instance instance = make_instance(load_textured());
  const Frames rest(instance, basis, {bind_pose(basis.skeleton)}), after(instance, basis, {turned});
  for (std::size_t k = 0; k < rest.tangents.size(); k += 4) {
    const float *before = &rest.tangents[k], *now = &after.tangents[k];
    ASSERT_NEAR(now[0], -before[1], 2e-3) << k / 4;
    ASSERT_NEAR(now[1], before[0], 2e-3) << k / 4;
    ASSERT_NEAR(now[2], before[2], 2e-3) << k / 4;
    ASSERT_EQ(now[3], before[3]) << k / 4;
  }
}

// Interleaved as an engine's vertex buffer has them: position, normal, tangent, two numbers of its own; so are the
// texture coordinates, behind three numbers.
TEST(LibraryTangents, AreReadAndWrittenBetweenOtherNumbers) {
  const Basis basis = load_basis(hero());
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const std::size_t vertices = basis.mesh.output_count(), vertex = 12, frame = vertex * vertices + 5;
  const std::vector<float> texture = texture_of(basis);
  std::vector<float> interleaved;
  for (std::size_t v = 0; v < vertices; ++v) {
    interleaved.insert(interleaved.end(), {NAN, NAN, NAN, texture[2 * v], texture[2 * v + 1]});
  }
  auto options = api::make<bodyopt_load_options>();
  options.texture = interleaved.data() + 3;
  options.texture_size = (interleaved.size() - 3) * sizeof(float);
  options.texture_stride = 5 * sizeof(float);
  options.texture_count = vertices;
  bodyopt_model* loaded = nullptr;
  api::check(bodyopt_load_model(hero().c_str(), &options, &loaded));
  const api::Model model(loaded);
  std::vector<float> buffer(frame * kFrames, -7.0f);
  auto skin = api::make<bodyopt_skin>();
  skin.tangents = {buffer.data() + 6, (buffer.size() - 6) * sizeof(float), vertex * sizeof(float),
                   frame * sizeof(float)};
  const PoseArrays given(poses);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &skin));
  const Frames expected(make_instance(load_textured()), basis, poses);
  for (std::size_t k = 0; k < buffer.size(); ++k) {
    const std::size_t f = k / frame, v = k % frame / vertex, i = k % frame % vertex;
    const bool is_tangent = v < vertices && 6 <= i && i < 10;
    ASSERT_EQ(buffer[k], is_tangent ? expected.tangents[4 * (f * vertices + v) + i - 6] : -7.0f) << k;
  }
}

// Under the check that compares every stage, whose result it is.
TEST(LibraryTangents, AreTheSameOnADevice) {
  test_device();
  const Basis basis = load_basis(hero());
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const api::Model model = load_textured();
  const api::Device device = api::open_device();
  auto options = api::make<bodyopt_instance_options>();
  options.device = device.get();
  const api::Instance instance = api::create_instance(model, options);
  const Frames found(instance, basis, poses);
  expect_close(found.tangents, kernels_tangents(basis, found.skin, kFrames), 1e-4);
  EXPECT_EQ(Frames(instance, basis, poses, false).tangents, found.tangents);
  options.check = 1;
  EXPECT_EQ(Frames(api::create_instance(model, options), basis, poses, false).tangents, found.tangents);
}

TEST(LibraryTangents, AreRefusedWithoutWhatTheyNeed) {
  const Basis basis = load_basis(hero());
  std::vector<float> texture = texture_of(basis);
  const auto refuses = [&](const auto& spoil, bodyopt_result expected, const std::string& said) {
    auto options = api::make<bodyopt_load_options>();
    options.texture = texture.data();
    options.texture_size = texture.size() * sizeof(float);
    options.texture_count = texture.size() / 2;
    spoil(options);
    bodyopt_model* model = nullptr;
    EXPECT_EQ(bodyopt_load_model(hero().c_str(), &options, &model), expected) << said;
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
    EXPECT_EQ(model, nullptr);
  };
  refuses([](auto& options) { options.texture_size -= 4; }, BODYOPT_USAGE,
          std::to_string(texture.size() * sizeof(float)) + " are needed");
  refuses([](auto& options) { options.texture_stride = 4; }, BODYOPT_USAGE, "at least 8");
  refuses([](auto& options) { options.texture_stride = 10; }, BODYOPT_USAGE, "no multiple of 4");
  const std::string has = " vertices, the model has " + std::to_string(texture.size() / 2);
  refuses([](auto& options) { options.texture_count -= 1; }, BODYOPT_MISMATCH, has);
  refuses([](auto& options) { options.texture_count += 1; }, BODYOPT_MISMATCH, has);
  refuses([](auto& options) { options.texture_count = 0; }, BODYOPT_MISMATCH, "of 0" + has);
  texture[7] = NAN;
  refuses([](auto&) {}, BODYOPT_MISMATCH, "of vertex 3 is not finite");

  // A program of the first version has none to give, and what it has behind its structure is not read.
  auto options = api::make<bodyopt_load_options>();
  options.texture = texture.data();
  options.struct_size = offsetof(bodyopt_load_options, texture);
  bodyopt_model* loaded = nullptr;
  api::check(bodyopt_load_model(hero().c_str(), &options, &loaded));
  const api::Model model(loaded);
  EXPECT_EQ(api::describe(model).has_tangents, 0u);
  const PoseArrays given(turning_poses(basis, 1));
  Arrays found(basis, 1);
  std::vector<float> tangents(4 * basis.mesh.output_count());
  found.all.tangents = floats_in(tangents);
  EXPECT_EQ(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all), BODYOPT_USAGE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("without texture coordinates"), std::string::npos);
  EXPECT_EQ(found.positions, std::vector<float>(found.positions.size()));
}

}  // namespace tangents_test
}  // namespace bodyopt::testing
