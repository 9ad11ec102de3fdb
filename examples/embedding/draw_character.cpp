// A program that draws a character: its skin breathes, and what is attached to it, its clothes, follows. Bodyopt
// evaluates on the program's Vulkan device and writes into its vertex buffers; each frame becomes a picture.
//   draw_character BASIS.safetensors ATTACHED.safetensors FRAMES FOLDER [CLIP.glb]
// Poses are skinning matrices, as the rig of an engine has them: of a clip, or of the bind pose.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "gltf_clip.h"
#include "painter.h"

namespace api = bodyopt::api;

namespace {

constexpr double kFramesPerSecond = 24;

// The cube around a surface, half as large again.
std::array<float, 4> box_around(const Surface& surface) {
  const auto* x = static_cast<const float*>(surface.positions.mapped);
  std::array<float, 3> low = {x[0], x[1], x[2]}, high = low;
  for (VkDeviceSize k = 0; k < surface.positions.size / sizeof(float); ++k) {
    low[k % 3] = std::min(low[k % 3], x[k]);
    high[k % 3] = std::max(high[k % 3], x[k]);
  }
  float half = 0;
  for (std::size_t i = 0; i < 3; ++i) half = std::max(half, 0.75f * (high[i] - low[i]));
  return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2, 1 / half};
}

// The matrices of all joints in the order of the model, twelve numbers each.
std::vector<float> pose_at(const api::Model& model, const GltfClip* clip, int frame) {
  std::vector<float> matrices;
  for (std::uint32_t j = 0; const char* joint = bodyopt_joint_name(model.get(), j); ++j) {
    GltfClip::Matrix own = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (clip != nullptr) own = clip->skinning(joint, static_cast<float>(frame / kFramesPerSecond));
    matrices.insert(matrices.end(), own.begin(), own.end());
  }
  return matrices;
}

void draw_frames(const char* basis, const char* attached, int frames, const std::string& folder, const GltfClip* clip) {
  const Engine engine;
  const api::Device device = engine.share();
  const api::Model model = api::load_model(basis, {}, attached);
  const bodyopt_description character = api::describe(model);
  auto options = api::make<bodyopt_instance_options>();
  options.device = device.get();
  const api::Instance instance = api::create_instance(model, options);

  const Surface body(engine, character.vertex_count, character.triangle_count, {0.9f, 0.6f, 0.5f, 1});
  api::check(bodyopt_get_triangles(model.get(), body.triangles(), body.indices.size));
  auto clothing = api::make<bodyopt_attached>();
  api::check(bodyopt_describe_attached(model.get(), 0, &clothing));
  const Surface shirt(engine, clothing.vertex_count, clothing.triangle_count, {0.2f, 0.3f, 0.8f, 1});
  api::check(bodyopt_get_attached_triangles(model.get(), 0, shirt.triangles(), shirt.indices.size));
  std::vector<bodyopt_floats> worn(character.attached_count);  // the first mesh alone
  worn[0] = shirt.output();
  auto skin = api::make<bodyopt_skin>();
  skin.positions = body.output();
  skin.attached = worn.data();
  skin.attached_count = character.attached_count;

  auto poses = api::make<bodyopt_poses>();
  poses.frame_count = 1;
  poses.joint_count = character.joint_count;
  poses.shows_modifiers = 1;
  poses.frames_per_second = kFramesPerSecond;
  const Painter painter(engine);
  std::array<float, 4> box{};
  for (int frame = 0; frame < frames; ++frame) {
    const std::vector<float> matrices = pose_at(model, clip, frame);
    poses.skinning = matrices.data();
    poses.goes_on = frame > 0;
    api::check(bodyopt_evaluate(instance.get(), &poses, &skin));
    if (frame == 0) box = box_around(body);
    write_picture(painter.draw({&body, &shirt}, box), folder + "/frame" + std::to_string(frame) + ".ppm");
  }
  std::printf("drew %d frames of %u vertices in '%s' on %s\n", frames, character.vertex_count, clothing.name,
              bodyopt_device_name(device.get()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) {
    std::fprintf(stderr, "usage: draw_character BASIS.safetensors ATTACHED.safetensors FRAMES FOLDER [CLIP.glb]\n");
    return BODYOPT_USAGE;
  }
  try {
    const std::optional<GltfClip> clip = argc == 6 ? std::optional<GltfClip>(argv[5]) : std::nullopt;
    draw_frames(argv[1], argv[2], std::atoi(argv[3]), argv[4], clip ? &*clip : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
