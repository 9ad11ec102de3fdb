// What an engine has in place of files, terminals and names: bytes of a model, a log, and a list of devices.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "tests/library/c_api.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::testing {
namespace host_test {

std::vector<float> jiggled(const api::Model& model) {
  const Basis basis = load_basis(hero());
  const PoseArrays given(turning_poses(basis, 3));
  Arrays skin(basis, 3);
  api::check(bodyopt_jiggle(make_instance(model, true).get(), &given.all, &skin.all));
  return skin.positions;
}

TEST(LibraryMemory, GivesTheModelOfTheFiles) {
  // Bytes that begin at an odd address, and are gone before the first frame.
  std::string basis = "x" + read_bytes(hero()), dynamics = "x" + read_bytes(hero_dynamics());
  auto options = api::make<bodyopt_load_options>();
  options.dynamics_data = dynamics.data() + 1;
  options.dynamics_size = dynamics.size() - 1;
  bodyopt_model* loaded = nullptr;
  api::check(bodyopt_load_model_from_memory(basis.data() + 1, basis.size() - 1, &options, &loaded));
  const api::Model model(loaded);
  std::ranges::fill(basis, 'x');
  std::ranges::fill(dynamics, 'x');
  EXPECT_EQ(jiggled(model), jiggled(api::load_model(hero(), hero_dynamics())));
}

TEST(LibraryMemory, RefusesWhatIsNoModel) {
  const std::string basis = read_bytes(hero()), dynamics = read_bytes(hero_dynamics());
  bodyopt_model* model = nullptr;
  const auto expect = [&](bodyopt_result result, bodyopt_result expected, const std::string& said) {
    EXPECT_EQ(result, expected);
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
    EXPECT_EQ(model, nullptr);
  };
  const auto load = [&](const void* data, std::size_t size, const bodyopt_load_options* options = nullptr) {
    return bodyopt_load_model_from_memory(data, size, options, &model);
  };
  expect(load(nullptr, 0), BODYOPT_USAGE, "'data' is a null pointer");
  expect(bodyopt_load_model_from_memory(basis.data(), basis.size(), nullptr, nullptr), BODYOPT_USAGE, "'model'");
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{8}, std::size_t{100}, basis.size() - 1}) {
    expect(load(basis.data(), size), BODYOPT_FILE, "'data' in memory");
  }
  std::string spoilt = basis;
  spoilt.back() = static_cast<char>(spoilt.back() + 1);
  expect(load(spoilt.data(), spoilt.size()), BODYOPT_FILE, "its checksum is ");
  auto options = api::make<bodyopt_load_options>();
  options.level = 3;
  expect(load(basis.data(), basis.size(), &options), BODYOPT_USAGE, "'data' in memory has no level of detail 3");
  options.level = 0;
  options.dynamics_data = basis.data();
  options.dynamics_size = basis.size();
  expect(load(basis.data(), basis.size(), &options), BODYOPT_FILE, "'options.dynamics_data' in memory");
  options.dynamics_size = 0;
  expect(load(basis.data(), basis.size(), &options), BODYOPT_FILE, "'options.dynamics_data' in memory");
  const std::string file = hero_dynamics();
  options.dynamics = file.c_str();
  expect(load(basis.data(), basis.size(), &options), BODYOPT_USAGE, "both 'options.dynamics' and");
  options.struct_size = 4000;
  expect(load(basis.data(), basis.size(), &options), BODYOPT_USAGE, "another version");
}

// What the log was told, by any thread.
class LibraryLog : public ::testing::Test {
 protected:
  struct Line {
    bodyopt_log_level level;
    std::string text;
    std::thread::id thread;
  };

  LibraryLog() { api::check(bodyopt_set_log(&LibraryLog::take, this)); }
  ~LibraryLog() override { bodyopt_set_log(nullptr, nullptr); }

  static void take(bodyopt_log_level level, const char* message, void* user) {
    auto& self = *static_cast<LibraryLog*>(user);
    if (self.inside_) self.inside_();
    const std::lock_guard lock(self.mutex_);
    self.lines_.push_back({level, message, std::this_thread::get_id()});
  }

  std::function<void()> inside_;
  std::mutex mutex_;
  std::vector<Line> lines_;
};

TEST_F(LibraryLog, IsToldOfModelsAndErrors) {
  const api::Model model = api::load_model(hero());
  EXPECT_EQ(bodyopt_describe(model.get(), nullptr), BODYOPT_USAGE);
  ASSERT_EQ(lines_.size(), 2u);
  EXPECT_EQ(lines_[0].level, BODYOPT_LOG_INFO);
  EXPECT_NE(lines_[0].text.find("hero.safetensors"), std::string::npos) << lines_[0].text;
  EXPECT_EQ(lines_[1].level, BODYOPT_LOG_ERROR);
  EXPECT_EQ(lines_[1].text, bodyopt_last_error());
  api::check(bodyopt_set_log(nullptr, nullptr));
  EXPECT_EQ(bodyopt_describe(model.get(), nullptr), BODYOPT_USAGE);
  EXPECT_EQ(lines_.size(), 2u);
}

TEST_F(LibraryLog, IsToldOnTheThreadOfTheCall) {
  std::vector<std::thread::id> ids;
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([] {
      for (int call = 0; call < 50; ++call) bodyopt_describe(nullptr, nullptr);
    });
    ids.push_back(threads.back().get_id());
  }
  // Exchanged and put back meanwhile.
  for (int k = 0; k < 20; ++k) api::check(bodyopt_set_log(&LibraryLog::take, this));
  for (std::thread& thread : threads) thread.join();
  ASSERT_EQ(lines_.size(), 200u);
  for (const std::thread::id id : ids) EXPECT_EQ(std::ranges::count(lines_, id, &Line::thread), 50);
}

TEST_F(LibraryLog, MayCallTheLibraryButNotExchangeItself) {
  bodyopt_result exchanged = BODYOPT_OK;
  inside_ = [&] {
    exchanged = bodyopt_set_log(nullptr, nullptr);
    bodyopt_describe(nullptr, nullptr);
    throw std::runtime_error("what a log does wrong is not the call's");
  };
  EXPECT_EQ(bodyopt_describe(nullptr, nullptr), BODYOPT_USAGE);
  EXPECT_EQ(exchanged, BODYOPT_USAGE);
  inside_ = {};
  EXPECT_EQ(bodyopt_describe(nullptr, nullptr), BODYOPT_USAGE);
  EXPECT_EQ(lines_.size(), 1u);
}

TEST(LibraryDevices, AreListedAsTheyAreOpened) {
  test_device();  // the loader sees the test's device alone
  std::size_t count = 0;
  api::check(bodyopt_list_devices(nullptr, 0, &count));
  ASSERT_GT(count, 0u);
  // One more than there are stays as it was.
  std::vector<bodyopt_device_description> devices(count + 1, api::make<bodyopt_device_description>());
  devices.back().index = 77;
  api::check(bodyopt_list_devices(devices.data(), devices.size(), &count));
  EXPECT_EQ(devices.back().index, 77u);
  for (std::uint32_t k = 0; k < count; ++k) {
    EXPECT_EQ(devices[k].index, k);
    EXPECT_GT(devices[k].memory_bytes, 0u);
    if (devices[k].problem[0] != 0) continue;
    const api::Device device = api::open_device(std::to_string(k));
    EXPECT_STREQ(bodyopt_device_name(device.get()), devices[k].name);
  }
}

TEST(LibraryDevices, RefuseWrongCalls) {
  std::size_t count = 77;
  auto device = api::make<bodyopt_device_description>();
  EXPECT_EQ(bodyopt_list_devices(&device, 1, nullptr), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_list_devices(nullptr, 1, &count), BODYOPT_USAGE);
  for (const std::size_t size : {std::size_t{0}, sizeof(device) - 8, sizeof(device) + 8}) {
    device.struct_size = size;
    EXPECT_EQ(bodyopt_list_devices(&device, 1, &count), BODYOPT_USAGE);
    EXPECT_NE(std::string(bodyopt_last_error()).find("struct_size of 'devices'"), std::string::npos);
  }
  EXPECT_EQ(count, 77u);
}

}  // namespace host_test
}  // namespace bodyopt::testing
