// A program with a Vulkan device of its own: Bodyopt records the skin into its command buffer and writes its vertex
// buffer, position and normal interleaved. At the end it compares with the CPU.
//   share_device BASIS.safetensors
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <vector>

#include "engine.h"

namespace api = bodyopt::api;

namespace {

void compare(const char* basis) {
  const api::Model model = api::load_model(basis);
  const bodyopt_description character = api::describe(model);
  constexpr VkDeviceSize kVertex = 6 * sizeof(float);
  const Engine engine;
  const Buffer vertices(engine, kVertex * character.vertex_count,
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  const api::Device device = engine.share();
  auto options = api::make<bodyopt_instance_options>();
  options.device = device.get();
  const api::Instance instance = api::create_instance(model, options);

  std::vector<double> joints(10 * std::size_t{character.joint_count});
  api::check(bodyopt_get_bind_pose(model.get(), joints.data(), joints.size() * sizeof(double)));
  const double half_turn[] = {std::sin(0.2), 0, 0, std::cos(0.2)};  // of the last joint, about x
  std::copy(std::begin(half_turn), std::end(half_turn), joints.end() - 7);
  auto poses = api::make<bodyopt_poses>();
  poses.frame_count = 1;
  poses.joint_count = character.joint_count;
  poses.joints = joints.data();
  auto recording = api::make<bodyopt_recording>();
  recording.commands = engine.commands;
  recording.positions = {vertices.handle, vertices.size, 0, kVertex};
  recording.normals = {vertices.handle, vertices.size, kVertex / 2, kVertex};
  engine.begin();
  api::check(bodyopt_record(instance.get(), &poses, &recording));
  // Here an engine would draw; this one lets the CPU see the vertices.
  engine.submit(VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT);

  std::vector<float> expected(3 * std::size_t{character.vertex_count});
  auto skin = api::make<bodyopt_skin>();
  skin.positions.data = expected.data();
  skin.positions.size = expected.size() * sizeof(float);
  const api::Instance on_cpu = api::create_instance(model, api::make<bodyopt_instance_options>());
  api::check(bodyopt_evaluate(on_cpu.get(), &poses, &skin));
  const auto* found = static_cast<const float*>(vertices.mapped);
  float largest = 0;
  for (std::size_t v = 0; v < character.vertex_count; ++v) {
    for (std::size_t i = 0; i < 3; ++i) {
      largest = std::max(largest, std::abs(found[6 * v + i] - expected[3 * v + i]));
    }
  }
  std::printf("%u vertices on %s, at most %.6f mm from those of the CPU\n", character.vertex_count,
              bodyopt_device_name(device.get()), 1e3 * double{largest});
  if (!(largest < 1e-5f)) throw std::runtime_error("the device and the CPU differ");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: share_device BASIS.safetensors\n");
    return BODYOPT_USAGE;
  }
  try {
    compare(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
