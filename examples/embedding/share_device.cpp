// A program with a Vulkan device of its own: Bodyopt records the skin into its command buffer and writes its vertex
// buffer, position and normal interleaved. At the end it compares with the CPU.
//   share_device BASIS.safetensors
#include <bodyopt/vulkan.h>

#include <algorithm>
#include <bodyopt/bodyopt.hpp>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace api = bodyopt::api;

namespace {

void require(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("Vulkan failed: " + std::to_string(result));
}

// What any engine has: a device, a queue, a command buffer, and a vertex buffer, here one that the CPU can read.
struct Engine {
  VkInstance instance{};
  VkPhysicalDevice physical{};
  VkDevice device{};
  VkQueue queue{};
  VkCommandPool pool{};
  VkCommandBuffer commands{};
  VkBuffer vertices{};
  VkDeviceMemory memory{};
  const float* mapped{};

  explicit Engine(VkDeviceSize bytes) {
    const VkApplicationInfo application{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "engine", 1, nullptr, 0, VK_API_VERSION_1_2};
    const VkInstanceCreateInfo instance_info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &application};
    require(vkCreateInstance(&instance_info, nullptr, &instance));
    std::uint32_t count = 1;
    vkEnumeratePhysicalDevices(instance, &count, &physical);
    if (count == 0) throw std::runtime_error("no Vulkan device");
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue_info{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    const VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, nullptr, 0, 1, &queue_info};
    require(vkCreateDevice(physical, &device_info, nullptr, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);
    const VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    require(vkCreateCommandPool(device, &pool_info, nullptr, &pool));
    const VkCommandBufferAllocateInfo commands_info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                                    VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    require(vkAllocateCommandBuffers(device, &commands_info, &commands));
    make_vertices(bytes);
  }

  void make_vertices(VkDeviceSize bytes) {
    const VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, nullptr, 0, bytes,
                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT};
    require(vkCreateBuffer(device, &info, nullptr, &vertices));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device, vertices, &needs);
    VkPhysicalDeviceMemoryProperties types;
    vkGetPhysicalDeviceMemoryProperties(physical, &types);
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    std::uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) || (types.memoryTypes[type].propertyFlags & wanted) != wanted) ++type;
    const VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
    require(vkAllocateMemory(device, &allocation, nullptr, &memory));
    require(vkBindBufferMemory(device, vertices, memory, 0));
    void* at = nullptr;
    require(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &at));
    mapped = static_cast<const float*>(at);
  }

  void begin() const {
    const VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    require(vkBeginCommandBuffer(commands, &info));
  }

  // Here an engine would draw; this one lets the CPU see the vertices.
  void submit() const {
    const VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_SHADER_WRITE_BIT,
                                  VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0,
                         nullptr, 0, nullptr);
    require(vkEndCommandBuffer(commands));
    VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    require(vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE));
    require(vkQueueWaitIdle(queue));
  }

  ~Engine() {
    vkDestroyBuffer(device, vertices, nullptr);
    vkFreeMemory(device, memory, nullptr);
    vkDestroyCommandPool(device, pool, nullptr);
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
  }
};

void compare(const char* basis) {
  const api::Model model = api::load_model(basis);
  const bodyopt_description character = api::describe(model);
  constexpr VkDeviceSize kVertex = 6 * sizeof(float);
  const Engine engine(kVertex * character.vertex_count);

  auto host = api::make<bodyopt_vulkan_device>();
  host.instance = engine.instance;
  host.physical_device = engine.physical;
  host.device = engine.device;
  host.queue = engine.queue;
  bodyopt_device* shared = nullptr;
  api::check(bodyopt_share_device(&host, &shared));
  const api::Device device(shared);
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
  recording.positions = {engine.vertices, kVertex * character.vertex_count, 0, kVertex};
  recording.normals = {engine.vertices, kVertex * character.vertex_count, kVertex / 2, kVertex};
  engine.begin();
  api::check(bodyopt_record(instance.get(), &poses, &recording));
  engine.submit();

  std::vector<float> expected(3 * std::size_t{character.vertex_count});
  auto skin = api::make<bodyopt_skin>();
  skin.positions.data = expected.data();
  skin.positions.size = expected.size() * sizeof(float);
  const api::Instance on_cpu = api::create_instance(model, api::make<bodyopt_instance_options>());
  api::check(bodyopt_evaluate(on_cpu.get(), &poses, &skin));
  float largest = 0;
  for (std::size_t v = 0; v < character.vertex_count; ++v) {
    for (std::size_t i = 0; i < 3; ++i) {
      largest = std::max(largest, std::abs(engine.mapped[6 * v + i] - expected[3 * v + i]));
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
