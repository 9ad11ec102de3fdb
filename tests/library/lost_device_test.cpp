// A device that is lost, by the layer of tests/support, while a host program evaluates on it.
#include "tests/library/c_api.h"
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

}  // namespace lost_device_test
}  // namespace bodyopt::testing
