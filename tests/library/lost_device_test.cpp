// A device that is lost, by the layer of tests/support, while a host program evaluates on it.
#include "include/bodyopt/vulkan.h"
#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"
#include "tests/library/c_api.h"
#include "tests/library/shared_device.h"
#include "tests/support/environment.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {
namespace lost_device_test {

struct Host {
  bodyopt_result evaluate(const api::Instance& instance) {
    return bodyopt_evaluate(instance.get(), &poses.all, &arrays.all);
  }

  Basis basis = load_basis(hero());
  PoseArrays poses{turning_poses(basis, 2)};
  Arrays arrays{basis, 2};
  api::Model model = api::load_model(hero());
};

TEST(LostDevice, FailsFromThenOnAndTheCpuWorksOn) {
  test_device();  // the driver
  const Environment path("VK_LAYER_PATH", kDeviceLossLayer),
      layers("VK_INSTANCE_LAYERS", "VK_LAYER_BODYOPT_device_loss");
  Host host;
  const api::Device device = api::open_device();
  const api::Instance on_device = make_instance(host.model, false, device),
                      other = make_instance(host.model, false, device);
  ASSERT_EQ(host.evaluate(on_device), BODYOPT_OK) << bodyopt_last_error();
  const std::vector<float> before = host.arrays.positions;
  {
    const Environment now("BODYOPT_LOSE_DEVICE_NOW", "1");
    EXPECT_EQ(host.evaluate(on_device), BODYOPT_DEVICE);
    EXPECT_NE(std::string(bodyopt_last_error()).find("the device was lost"), std::string::npos) << bodyopt_last_error();
  }
  EXPECT_EQ(host.evaluate(on_device), BODYOPT_DEVICE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("failed earlier"), std::string::npos) << bodyopt_last_error();
  EXPECT_EQ(host.evaluate(other), BODYOPT_DEVICE);
  const api::Instance on_cpu = make_instance(host.model);
  ASSERT_EQ(host.evaluate(on_cpu), BODYOPT_OK) << bodyopt_last_error();
  for (std::size_t k = 0; k < before.size(); ++k) ASSERT_NEAR(host.arrays.positions[k], before[k], 1e-5) << k;
}

// A device of the host, which has its skin recorded there.
class RecordingHost {
 public:
  bodyopt_result record(const api::Instance& instance, const vulkan::Commands& commands) {
    auto recording = api::make<bodyopt_recording>();
    recording.commands = commands.handle();
    recording.positions = {skin.handle(), skin.size(), 0, 0};
    return bodyopt_record(instance.get(), &poses.all, &recording);
  }

  static DeviceChoice choice() {
    DeviceChoice choice = test_device();
    choice.validation = false;  // of which the layer's folder knows nothing
    return choice;
  }

  Basis basis = load_basis(hero());
  PoseArrays poses{turning_poses(basis, 1)};
  vulkan::Device own{choice()};
  vulkan::Buffer skin = vulkan::floats(own, 3 * basis.mesh.output_count(), "the host's skin");
  api::Device shared = share(handles_of(own));
};

// What was recorded is lost with the device. From then on the host's calls of the library fail, and can be released.
TEST(LostDevice, MayBeLostBetweenRecordAndSubmit) {
  test_device();
  const Environment path("VK_LAYER_PATH", kDeviceLossLayer),
      layers("VK_INSTANCE_LAYERS", "VK_LAYER_BODYOPT_device_loss");
  RecordingHost host;
  const api::Model model = api::load_model(hero(), hero_dynamics());
  const api::Instance instance = make_instance(model, true, host.shared);
  vulkan::Commands commands(host.own);
  commands.begin();
  ASSERT_EQ(host.record(instance, commands), BODYOPT_OK) << bodyopt_last_error();
  commands.end();
  {
    const Environment now("BODYOPT_LOSE_DEVICE_NOW", "1");
    EXPECT_THROW(commands.run(), Error);
  }
  const auto record_next = [&] {
    vulkan::Commands more(host.own);
    more.begin();
    ++host.poses.numbers[0];
    return host.record(instance, more);
  };
  const bodyopt_result unaware = record_next();  // it submits nothing that could tell
  EXPECT_TRUE(unaware == BODYOPT_OK || unaware == BODYOPT_DEVICE) << bodyopt_last_error();
  bodyopt_state* state = nullptr;
  EXPECT_EQ(bodyopt_get_state(instance.get(), &state), BODYOPT_DEVICE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("the device was lost"), std::string::npos) << bodyopt_last_error();
  EXPECT_EQ(state, nullptr);
  EXPECT_EQ(record_next(), BODYOPT_DEVICE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("failed earlier"), std::string::npos) << bodyopt_last_error();
  EXPECT_EQ(bodyopt_get_state(instance.get(), &state), BODYOPT_DEVICE);
  EXPECT_EQ(bodyopt_forget_buffers(instance.get()), BODYOPT_OK) << bodyopt_last_error();
  bodyopt_instance* another = nullptr;
  auto options = api::make<bodyopt_instance_options>();
  options.device = host.shared.get();
  EXPECT_EQ(bodyopt_create_instance(model.get(), &options, &another), BODYOPT_DEVICE);
}

}  // namespace lost_device_test
}  // namespace bodyopt::testing
