// vulkan.h on a device that the test opened: recorded frames are those that the library runs itself, bit for bit.
#include "include/bodyopt/vulkan.h"

#include <dlfcn.h>
#include <link.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "runtime/basis/attachments.h"
#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"
#include "tests/library/c_api.h"
#include "tests/library/shared_device.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace vulkan_test {

class LibraryVulkan : public GpuTest {
 protected:
  static bodyopt_vulkan_device handles() { return handles_of(*device_); }
  static api::Device share() { return testing::share(handles()); }

  static api::Instance instance(const api::Model& model, const api::Device& device, bool jiggles,
                                std::uint32_t recorded_frames = 1) {
    auto options = api::make<bodyopt_instance_options>();
    options.device = device.get();
    options.jiggles = jiggles;
    options.recorded_frames = recorded_frames;
    return api::create_instance(model, options);
  }
};

// A buffer of the host for some frames, each vertex twelve numbers, of which the last two are not written, after a gap.
class HostVertices {
 public:
  HostVertices(const vulkan::Device& device, std::size_t vertices, std::size_t frames)
      : frame_(12 * vertices),
        bytes_((kGap + frames * frame_) * sizeof(float)),
        target_(device, bytes_, vulkan::Memory::device, "the host's vertices"),
        readback_(device, bytes_, vulkan::Memory::staging, "readback"),
        commands_(device) {
    commands_.begin();
    commands_.fill(target_, 0);
  }

  // From frame `at` of the buffer on.
  bodyopt_recording place(std::size_t at) const {
    const auto placed = [&](std::size_t offset) {
      return bodyopt_vulkan_output{target_.handle(), bytes_, (kGap + at * frame_ + offset) * sizeof(float),
                                   12 * sizeof(float)};
    };
    auto recording = api::make<bodyopt_recording>();
    recording.commands = commands_.handle();
    recording.positions = placed(0);
    recording.normals = placed(3);
    recording.tangents = placed(6);
    recording.positions_frame_stride = recording.normals_frame_stride = recording.tangents_frame_stride =
        frame_ * sizeof(float);
    return recording;
  }

  std::vector<float> run() {
    commands_.copy(target_, readback_);
    commands_.end();
    commands_.run();
    std::vector<float> found(bytes_ / sizeof(float));
    std::memcpy(found.data(), readback_.mapped(), bytes_);
    return found;
  }

  static constexpr std::size_t kGap = 5;

 private:
  std::size_t frame_, bytes_;
  vulkan::Buffer target_, readback_;
  vulkan::Commands commands_;
};

// Holds what was recorded against what the library runs itself.
void expect_frames(const std::vector<float>& found, const api::Instance& runner, const std::vector<Pose>& poses,
                   std::size_t vertices, bool jiggles) {
  const PoseArrays given(poses);
  const std::size_t all = poses.size() * vertices;
  std::vector<float> positions(3 * all), normals(3 * all), tangents(4 * all);
  auto skin = api::make<bodyopt_skin>();
  skin.positions = floats_in(positions);
  skin.normals = floats_in(normals);
  skin.tangents = floats_in(tangents);
  const auto run = jiggles ? bodyopt_jiggle : bodyopt_evaluate;
  ASSERT_EQ(run(runner.get(), &given.all, &skin), BODYOPT_OK) << bodyopt_last_error();
  for (std::size_t k = 0; k < HostVertices::kGap; ++k) ASSERT_EQ(found[k], 0);
  for (std::size_t v = 0; v < all; ++v) {
    const float* at = found.data() + HostVertices::kGap + 12 * v;
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(at[i], positions[3 * v + i]) << v;
      ASSERT_EQ(at[3 + i], normals[3 * v + i]) << v;
    }
    for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ(at[6 + i], tangents[4 * v + i]) << v;
    ASSERT_EQ(at[10], 0);
    ASSERT_EQ(at[11], 0);
  }
}

// Frames in one command buffer, each recorded by itself or several at once, the last call with fewer than the others.
TEST_F(LibraryVulkan, RecordsFramesIntoTheHostsBuffer) {
  constexpr std::size_t kFrames = 5;
  const api::Model model = load_textured(hero_dynamics());
  const api::Device device = share();
  const std::vector<Pose> poses = turning_poses(load_basis(hero()), kFrames);
  const std::size_t vertices = api::describe(model).vertex_count;
  for (const bool jiggles : {false, true}) {
    for (const std::size_t at_once : {1u, 3u}) {
      SCOPED_TRACE(concat(jiggles ? "jiggle, " : "still, ", at_once, " at once"));
      const api::Instance recorder = instance(model, device, jiggles, static_cast<std::uint32_t>(at_once));
      HostVertices host(*device_, vertices, kFrames);
      for (std::size_t f = 0; f < kFrames; f += at_once) {
        const auto from = poses.begin() + static_cast<std::ptrdiff_t>(f);
        const std::size_t count = std::min(at_once, kFrames - f);
        PoseArrays given(std::vector(from, from + static_cast<std::ptrdiff_t>(count)));
        for (int& number : given.numbers) number += static_cast<int>(f);
        const bodyopt_recording recording = host.place(f);
        ASSERT_EQ(bodyopt_record(recorder.get(), &given.all, &recording), BODYOPT_OK) << bodyopt_last_error();
      }
      expect_frames(host.run(), instance(model, device, jiggles), poses, vertices, jiggles);
      const PoseArrays given(poses);
      const Arrays skin(load_basis(hero()), kFrames);
      EXPECT_EQ((jiggles ? bodyopt_jiggle : bodyopt_evaluate)(recorder.get(), &given.all, &skin.all), BODYOPT_USAGE);
      EXPECT_NE(std::string(bodyopt_last_error()).find("records for the host program"), std::string::npos);
      EXPECT_EQ(bodyopt_forget_buffers(recorder.get()), BODYOPT_OK);
    }
  }
}

TEST_F(LibraryVulkan, RecordsACrowdAtOnce) {
  constexpr std::size_t kCrowd = 1000;
  const api::Model model = load_textured("");
  const api::Device device = share();
  const std::vector<Pose> poses = turning_poses(load_basis(hero()), kCrowd);
  const std::size_t vertices = api::describe(model).vertex_count;
  const api::Instance recorder = instance(model, device, false, kCrowd), runner = instance(model, device, false);
  HostVertices host(*device_, vertices, kCrowd);
  const bodyopt_recording recording = host.place(0);
  const PoseArrays given(poses);
  ASSERT_EQ(bodyopt_record(recorder.get(), &given.all, &recording), BODYOPT_OK) << bodyopt_last_error();
  expect_frames(host.run(), runner, poses, vertices, false);
}

// Several characters of a picture in one command buffer.
TEST_F(LibraryVulkan, RecordsInstancesIntoOneCommandBuffer) {
  const api::Model model = load_textured(hero_dynamics());
  const api::Device device = share();
  const std::vector<Pose> poses = turning_poses(load_basis(hero()), 2);
  const std::size_t vertices = api::describe(model).vertex_count;
  HostVertices host(*device_, vertices, poses.size());
  const api::Instance cast[] = {instance(model, device, false), instance(model, device, false)};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const PoseArrays given({poses[k]});
    const bodyopt_recording recording = host.place(k);
    ASSERT_EQ(bodyopt_record(cast[k].get(), &given.all, &recording), BODYOPT_OK) << bodyopt_last_error();
  }
  expect_frames(host.run(), instance(model, device, false), poses, vertices, false);
}

// Clothes on frames that go on from each other, where the host wants them: as the library itself has them, which
// carries them on the host in double precision. Of the meshes between one is not wanted.
TEST_F(LibraryVulkan, RecordsAttachedMeshes) {
  constexpr std::size_t kFrames = 4, kGap = 3, kElement = 5;  // numbers before the first, and of each vertex
  const Basis basis = load_basis(hero());
  Attachments attached = load_attachments(kept_file("hero.attached.safetensors"), basis);
  for (const char* name : {"second", "third"}) {
    attached.meshes.push_back(attached.meshes[0]);
    attached.meshes.back().name = name;
    for (float& x : attached.meshes.back().rest) x *= 0.9f;
  }
  const TemporaryFolder folder;
  save_attachments(attached, folder / "outfit.safetensors");
  const api::Model model = api::load_model(hero(), hero_dynamics(), (folder / "outfit.safetensors").string());
  const api::Device device = share();
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const api::Instance recorder = instance(model, device, true, 2), runner = instance(model, device, true);
  vulkan::Commands commands(*device_);
  commands.begin();
  std::vector<vulkan::Buffer> targets, readbacks;
  std::vector<std::size_t> frames;
  for (const AttachedMesh& mesh : attached.meshes) {
    frames.push_back(kElement * mesh.vertex_count() + 7);
    const VkDeviceSize bytes = (kGap + kFrames * frames.back()) * sizeof(float);
    targets.emplace_back(*device_, bytes, vulkan::Memory::device, "clothes");
    readbacks.emplace_back(*device_, bytes, vulkan::Memory::staging, "readback");
    commands.fill(targets.back(), 0);
  }
  for (std::size_t f = 0; f < kFrames; f += 2) {
    PoseArrays given({poses[f], poses[f + 1]});
    for (int& number : given.numbers) number += static_cast<int>(f);
    std::vector<bodyopt_vulkan_output> outputs;
    std::vector<VkDeviceSize> strides;
    for (std::size_t m = 0; m < targets.size(); ++m) {
      outputs.push_back({m == 1 ? VK_NULL_HANDLE : targets[m].handle(), targets[m].size(),
                         (kGap + f * frames[m]) * sizeof(float), kElement * sizeof(float)});
      strides.push_back(frames[m] * sizeof(float));
    }
    auto recording = api::make<bodyopt_recording>();
    recording.commands = commands.handle();
    recording.attached = outputs.data();
    recording.attached_count = static_cast<std::uint32_t>(outputs.size());
    recording.attached_frame_strides = strides.data();
    ASSERT_EQ(bodyopt_record(recorder.get(), &given.all, &recording), BODYOPT_OK) << bodyopt_last_error();
  }
  for (std::size_t m = 0; m < targets.size(); ++m) commands.copy(targets[m], readbacks[m]);
  commands.end();
  commands.run();

  const PoseArrays given(poses);
  Arrays skin(basis, kFrames);
  std::vector<std::vector<float>> expected;
  std::vector<bodyopt_floats> outputs;
  for (const AttachedMesh& mesh : attached.meshes) expected.emplace_back(kFrames * mesh.rest.size());
  for (std::vector<float>& mesh : expected) outputs.push_back(floats_in(mesh));
  skin.all.attached = outputs.data();
  skin.all.attached_count = static_cast<std::uint32_t>(outputs.size());
  api::check(bodyopt_jiggle(runner.get(), &given.all, &skin.all));
  for (std::size_t m = 0; m < expected.size(); ++m) {
    std::vector<float> found(readbacks[m].size() / sizeof(float)), before(found.size(), 0.0f);
    std::memcpy(found.data(), readbacks[m].mapped(), found.size() * sizeof(float));
    for (std::size_t k = 0; m != 1 && k < expected[m].size(); ++k) {
      const std::size_t vertices = attached.meshes[m].vertex_count(), v = k / 3;
      const std::size_t at = kGap + v / vertices * frames[m] + v % vertices * kElement + k % 3;
      ASSERT_NEAR(found[at], expected[m][k], 2e-6) << m << ", " << k;
      found[at] = 0;
    }
    ASSERT_EQ(found, before) << m;
  }
}

// Takes one of these, or leaves what was there.
template <typename T>
void maybe(Random& random, T& value, std::initializer_list<std::type_identity_t<T>> others) {
  if (random.below(5) == 0) value = *(others.begin() + random.below(static_cast<std::uint32_t>(others.size())));
}

// Recordings with structures at random, most of them wrong: every one gives a code, none writes beyond what it was told
// of a buffer, and the instance records on.
TEST_F(LibraryVulkan, RandomRecordingsGiveACodeAndKeepWithinTheBuffers) {
  constexpr std::size_t kOutputs = 3, kRoom = 1u << 15;  // positions, normals and clothes; numbers of each buffer
  constexpr std::uint32_t kUntouched = 0xc0e00000;       // -7
  const api::Model model = api::load_model(hero(), {}, kept_file("hero.attached.safetensors"));
  const api::Instance recorder = instance(model, share(), false, 2);
  PoseArrays given(turning_poses(load_basis(hero()), 2));
  std::vector<vulkan::Buffer> targets, readbacks;
  for (std::size_t k = 0; k < kOutputs; ++k) {
    targets.emplace_back(*device_, kRoom * sizeof(float), vulkan::Memory::device, "the host's");
    readbacks.emplace_back(*device_, kRoom * sizeof(float), vulkan::Memory::staging, "readback");
  }
  vulkan::Commands commands(*device_);
  std::map<int, int> codes;
  for (std::uint32_t call = 0; call < 400; ++call) {
    Random random(call);
    bodyopt_poses poses = given.all;
    poses.frame_count = 1 + random.below(2);
    maybe(random, poses.frame_count, {0u, 1u, 3u, ~0u});
    maybe(random, poses.struct_size, {8, BODYOPT_POSES_FIRST_SIZE});
    std::vector<bodyopt_vulkan_output> outputs;
    for (const vulkan::Buffer& target : targets) {
      bodyopt_vulkan_output output{target.handle(), (20000 + 4 * random.below(8000)) * 1ull, 0, 0};
      maybe(random, output.buffer, {VK_NULL_HANDLE});
      maybe(random, output.size, {0, 16, output.size / 2, kRoom * sizeof(float)});
      maybe(random, output.offset, {4, 1200, 6, ~VkDeviceSize{3}});
      maybe(random, output.element_stride, {12, 20, 8, 14, VkDeviceSize{1} << 40});
      outputs.push_back(output);
    }
    VkDeviceSize stride = 0;
    maybe(random, stride, {4, 20000, 20001, VkDeviceSize{1} << 40});
    auto recording = api::make<bodyopt_recording>();
    recording.positions = outputs[0];
    recording.normals = outputs[1];
    recording.attached = &outputs[2];
    recording.attached_count = 1;
    recording.attached_frame_strides = &stride;
    maybe(random, recording.attached_count, {0u, 2u, ~0u});
    maybe(random, recording.attached, {nullptr});
    maybe(random, recording.attached_frame_strides, {nullptr});
    maybe(random, recording.positions_frame_stride, {stride, 4, 10000});
    maybe(random, recording.struct_size,
          {0, BODYOPT_RECORDING_FIRST_SIZE, offsetof(bodyopt_recording, attached), sizeof(bodyopt_recording) + 8});
    commands.begin();
    for (const vulkan::Buffer& target : targets) commands.fill(target, kUntouched);
    recording.commands = commands.handle();
    const bodyopt_result result = bodyopt_record(recorder.get(), &poses, &recording);
    ++codes[result];
    ASSERT_TRUE(result == BODYOPT_OK || result == BODYOPT_USAGE) << call << ": " << bodyopt_last_error();
    if (result != BODYOPT_OK) continue;
    for (std::size_t k = 0; k < kOutputs; ++k) commands.copy(targets[k], readbacks[k]);
    commands.end();
    commands.run();
    for (std::size_t k = 0; k < kOutputs; ++k) {
      std::vector<std::uint32_t> words(kRoom);
      std::memcpy(words.data(), readbacks[k].mapped(), kRoom * sizeof(float));
      const auto own = static_cast<std::ptrdiff_t>(outputs[k].buffer == VK_NULL_HANDLE ? 0 : outputs[k].size / 4);
      ASSERT_TRUE(std::all_of(words.begin() + own, words.end(), [](std::uint32_t w) { return w == kUntouched; }))
          << call << ", " << k;
    }
  }
  EXPECT_GT(codes[BODYOPT_OK], 50);
  EXPECT_GT(codes[BODYOPT_USAGE], 100);
}

// The host's own cache; a program of the first version has none to give.
TEST_F(LibraryVulkan, TakesTheHostsPipelineCache) {
  auto info = vulkan::structure<VkPipelineCacheCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO);
  VkPipelineCache cache = VK_NULL_HANDLE;
  vulkan::check(vkCreatePipelineCache(device_->handle(), &info, nullptr, &cache), "vkCreatePipelineCache");
  const auto expect_shared = [](const bodyopt_vulkan_device& host) {
    EXPECT_NE(instance(api::load_model(hero()), testing::share(host), false), nullptr);
  };
  bodyopt_vulkan_device host = handles();
  host.pipeline_cache = cache;
  expect_shared(host);
  vkDestroyPipelineCache(device_->handle(), cache, nullptr);  // not looked at any more
  host.struct_size = offsetof(bodyopt_vulkan_device, pipeline_cache);
  expect_shared(host);
}

// A loader of the host's own: a copy of the system's, which knows nothing of the first one's handles. dlmopen would
// give one, too, but with a C library of its own, and ThreadSanitizer ends a program in whose memory that one's threads
// allocate.
struct HostLoader {
  HostLoader() {
    link_map* system = nullptr;
    dlinfo(dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL), RTLD_DI_LINKMAP, &system);
    const TemporaryFolder folder;
    std::filesystem::copy_file(system->l_name, folder / "libhost.so");
    void* const copy = dlopen((folder / "libhost.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(copy, "vkGetInstanceProcAddr"));
  }

  template <typename Function>
  Function find(VkInstance instance, const char* name) const {
    return reinterpret_cast<Function>(get(instance, name));
  }

  PFN_vkGetInstanceProcAddr get;
};

// What the host gives of it, to see that it is called.
const HostLoader* hosts_loader = nullptr;
PFN_vkQueueSubmit hosts_submit = nullptr;
int submissions = 0;

VKAPI_ATTR VkResult VKAPI_CALL count_submission(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits,
                                                VkFence fence) {
  ++submissions;
  return hosts_submit(queue, count, submits, fence);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_by_host(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkQueueSubmit") != 0) return hosts_loader->get(instance, name);
  hosts_submit = hosts_loader->find<PFN_vkQueueSubmit>(instance, name);
  return reinterpret_cast<PFN_vkVoidFunction>(count_submission);
}

// The first device of a host with a loader of its own, opened by that.
bodyopt_vulkan_device open_by(const HostLoader& loader) {
  auto host = api::make<bodyopt_vulkan_device>();
  auto application = vulkan::structure<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.apiVersion = VK_API_VERSION_1_2;
  auto instance = vulkan::structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  instance.pApplicationInfo = &application;
  vulkan::check(
      loader.find<PFN_vkCreateInstance>(VK_NULL_HANDLE, "vkCreateInstance")(&instance, nullptr, &host.instance),
      "vkCreateInstance");
  std::uint32_t count = 1;
  loader.find<PFN_vkEnumeratePhysicalDevices>(host.instance, "vkEnumeratePhysicalDevices")(host.instance, &count,
                                                                                           &host.physical_device);
  const float priority = 1;
  auto queue = vulkan::structure<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto device = vulkan::structure<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  device.queueCreateInfoCount = 1;
  device.pQueueCreateInfos = &queue;
  vulkan::check(loader.find<PFN_vkCreateDevice>(host.instance, "vkCreateDevice")(host.physical_device, &device, nullptr,
                                                                                 &host.device),
                "vkCreateDevice");
  loader.find<PFN_vkGetDeviceQueue>(host.instance, "vkGetDeviceQueue")(host.device, 0, 0, &host.queue);
  return host;
}

std::vector<float> bind_skin(const api::Model& model, bodyopt_device* device) {
  auto options = api::make<bodyopt_instance_options>();
  options.device = device;
  const api::Instance instance = api::create_instance(model, options);
  const PoseArrays poses(turning_poses(load_basis(hero()), 1));
  std::vector<float> positions(3 * std::size_t{api::describe(model).vertex_count});
  auto skin = api::make<bodyopt_skin>();
  skin.positions = floats_in(positions);
  api::check(bodyopt_evaluate(instance.get(), &poses.all, &skin));
  return positions;
}

void use_the_hosts_loader() {
  test_device();
  const api::Model model = api::load_model(hero());
  const HostLoader loader;
  hosts_loader = &loader;
  bodyopt_vulkan_device host = open_by(loader);
  host.get_instance_proc_addr = find_by_host;
  bodyopt_device* device = nullptr;
  api::check(bodyopt_share_device(&host, &device));
  const api::Device shared(device);
  const std::vector<float> found = bind_skin(model, device), expected = bind_skin(model, nullptr);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!(std::abs(found[k] - expected[k]) < 1e-5f)) throw std::runtime_error("another skin");
  }
  bodyopt_device* of_the_system = nullptr;
  host.get_instance_proc_addr = nullptr;  // whose functions are not those in use
  if (bodyopt_share_device(&host, &of_the_system) != BODYOPT_DEVICE) throw std::runtime_error("a second loader");
  if (submissions > 0) std::fputs("the host's loader was called\n", stderr);
}

// In a process of its own, as the functions of one loader are those of a process.
TEST(LibraryVulkanDeathTest, CallsTheHostsLoader) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        use_the_hosts_loader();
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(0), "the host's loader was called");
}

TEST_F(LibraryVulkan, RefusesASecondLoader) {
  bodyopt_vulkan_device host = handles();
  host.get_instance_proc_addr = vkGetInstanceProcAddr;  // that of the first
  bodyopt_device* shared = nullptr;
  ASSERT_EQ(bodyopt_share_device(&host, &shared), BODYOPT_OK) << bodyopt_last_error();
  bodyopt_release_device(shared);
  shared = nullptr;
  host.get_instance_proc_addr = HostLoader().get;
  EXPECT_EQ(bodyopt_share_device(&host, &shared), BODYOPT_DEVICE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("another loader"), std::string::npos) << bodyopt_last_error();
  EXPECT_EQ(shared, nullptr);
}

TEST_F(LibraryVulkan, KeepsPipelinesWhereTold) {
  const TemporaryFolder folder;
  instance(api::load_model(hero()), api::open_device({}, folder.path()), false);
  EXPECT_FALSE(std::filesystem::is_empty(folder.path()));
}

TEST_F(LibraryVulkan, RefusesWhatDoesNotDo) {
  const auto expect = [](bodyopt_result result, bodyopt_result expected, const std::string& said) {
    EXPECT_EQ(result, expected) << said;
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
  };
  bodyopt_device* shared = nullptr;
  bodyopt_vulkan_device host = handles();
  host.device = VK_NULL_HANDLE;
  expect(bodyopt_share_device(&host, &shared), BODYOPT_USAGE, "null handle");
  host = handles();
  host.queue_family = 99;
  expect(bodyopt_share_device(&host, &shared), BODYOPT_DEVICE, "queue family 99");
  host.struct_size = 4;
  expect(bodyopt_share_device(&host, &shared), BODYOPT_USAGE, "struct_size of 'host'");
  EXPECT_EQ(shared, nullptr);

  const api::Model model = api::load_model(hero());
  const api::Device device = share();
  const api::Instance recorder = instance(model, device, false);
  const PoseArrays one(turning_poses(load_basis(hero()), 1)), two(turning_poses(load_basis(hero()), 2));
  vulkan::Commands commands(*device_);
  const vulkan::Buffer target(*device_, 1200, vulkan::Memory::device, "the host's vertices");
  const auto record = [&](const PoseArrays& poses, VkDeviceSize offset, VkDeviceSize stride, bool has_commands) {
    auto recording = api::make<bodyopt_recording>();
    recording.commands = has_commands ? commands.handle() : VK_NULL_HANDLE;
    recording.positions = {target.handle(), 1200, offset, stride};
    return bodyopt_record(recorder.get(), &poses.all, &recording);
  };
  expect(record(two, 0, 0, true), BODYOPT_USAGE, "'poses' has 2 frames, expected 1 to 1");
  expect(record(one, 0, 0, false), BODYOPT_USAGE, "'recording.commands' is a null pointer");
  expect(record(one, 0, 8, true), BODYOPT_USAGE, "at least 12");
  expect(record(one, 2, 0, true), BODYOPT_USAGE, "multiple of 4");
  expect(record(one, 0, 0, true), BODYOPT_USAGE, "has 1200 bytes");
  expect(record(one, ~VkDeviceSize{3}, 0, true), BODYOPT_USAGE, "larger than can be addressed");
  auto options = api::make<bodyopt_instance_options>();
  options.device = device.get();
  options.recorded_frames = ~0u;
  bodyopt_instance* created = nullptr;
  expect(bodyopt_create_instance(model.get(), &options, &created), BODYOPT_USAGE, "'options.recorded_frames' is");
  const api::Model dressed = api::load_model(hero(), {}, kept_file("hero.attached.safetensors"));
  const auto record_attached = [&](const api::Instance& by, std::uint32_t count, const bodyopt_vulkan_output* outputs,
                                   std::size_t struct_size = sizeof(bodyopt_recording)) {
    auto clothes = api::make<bodyopt_recording>();
    clothes.struct_size = struct_size;
    clothes.commands = commands.handle();
    clothes.attached = outputs;
    clothes.attached_count = count;
    return bodyopt_record(by.get(), &one.all, &clothes);
  };
  const std::uint32_t meshes = api::describe(dressed).attached_count;
  std::vector<bodyopt_vulkan_output> outputs(meshes, {target.handle(), 8, 0, 0});
  const api::Instance wearer = instance(dressed, device, false), unprepared = make_instance(dressed, false, device);
  expect(record_attached(wearer, meshes + 1, outputs.data()), BODYOPT_USAGE, "'recording.attached' has");
  expect(record_attached(wearer, meshes, nullptr), BODYOPT_USAGE, "'recording.attached' is a null pointer");
  expect(record_attached(wearer, meshes, outputs.data()), BODYOPT_USAGE, "'recording.attached[0]' has 8 bytes");
  expect(record_attached(wearer, meshes, outputs.data(), sizeof(bodyopt_recording) + 8), BODYOPT_USAGE, "struct_size");
  expect(record_attached(recorder, 1, outputs.data()), BODYOPT_USAGE, "the model has 0 attached meshes");
  expect(record_attached(unprepared, meshes, outputs.data()), BODYOPT_USAGE, "'options.recorded_frames' of 1 or more");
  commands.begin();  // what an earlier version's structure ends before is not looked at
  expect(record_attached(wearer, meshes + 1, nullptr, offsetof(bodyopt_recording, attached)), BODYOPT_OK, "");
  commands.end();
  const api::Instance on_cpu = api::create_instance(model, api::make<bodyopt_instance_options>());
  auto recording = api::make<bodyopt_recording>();
  recording.commands = commands.handle();
  expect(bodyopt_record(on_cpu.get(), &one.all, &recording), BODYOPT_USAGE, "only an instance on a Vulkan device");
}

}  // namespace vulkan_test
}  // namespace bodyopt::testing
