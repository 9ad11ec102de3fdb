#include "runtime/vulkan/pipeline_cache.h"

#include <fstream>
#include <thread>

#include "runtime/core/atomic_file.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace pipeline_cache_test {

namespace fs = std::filesystem;
using vulkan::PipelineCacheHeader;

const std::string kData("what\0a driver compiled", 22);

PipelineCacheHeader some_driver() {
  PipelineCacheHeader header;
  header.vendor = 1;
  header.device = 2;
  header.driver_version = 3;
  header.driver.fill(4);
  header.cache.fill(5);
  return header;
}

TEST(PipelineCacheFile, GivesBackWhatWasPacked) {
  for (const std::string& data : {kData, std::string()}) {
    EXPECT_EQ(vulkan::unpack_pipelines(some_driver(), vulkan::pack_pipelines(some_driver(), data)), data);
  }
}

TEST(PipelineCacheFile, OfAnotherDriverIsNotTaken) {
  const std::string file = vulkan::pack_pipelines(some_driver(), kData);
  PipelineCacheHeader other[6];
  std::ranges::fill(other, some_driver());
  ++other[0].vendor;
  ++other[1].device;
  ++other[2].driver_version;
  ++other[3].driver.back();
  ++other[4].cache.front();
  ++other[5].version;
  for (const PipelineCacheHeader& driver : other) EXPECT_EQ(vulkan::unpack_pipelines(driver, file), "");
}

TEST(PipelineCacheFile, ThatIsDamagedIsNotTaken) {
  const std::string file = vulkan::pack_pipelines(some_driver(), kData);
  for (std::size_t k = 0; k < file.size(); ++k) {
    EXPECT_EQ(vulkan::unpack_pipelines(some_driver(), file.substr(0, k)), "") << "cut off at " << k;
    std::string flipped = file;
    flipped[k] = static_cast<char>(flipped[k] ^ 16);
    EXPECT_EQ(vulkan::unpack_pipelines(some_driver(), flipped), "") << "byte " << k;
  }
  EXPECT_EQ(vulkan::unpack_pipelines(some_driver(), file + 'x'), "");
}

class PipelineCache : public ::testing::Test {
 protected:
  // Opens the device with this cache, compiles a kernel, and closes it. Expects a pipeline, and nothing of validation.
  static void use(const fs::path& folder) {
    DeviceChoice choice = test_device();
    choice.pipeline_cache = folder;
    std::shared_ptr<const vulkan::ValidationLog> log;
    {
      const vulkan::Device device(choice);
      log = device.validation_log();
      EXPECT_EQ(device.pipeline_cache() == VK_NULL_HANDLE, folder.empty());
      const vulkan::OutputNormals kernel(device);
    }
    EXPECT_EQ(log->messages(), std::vector<std::string>());
  }

  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(kept())) found.push_back(entry.path());
    return found;
  }

  fs::path kept() const { return folder_ / "new/bodyopt"; }

  // The one file of the cache, which must hold data of the driver.
  fs::path expect_sound() const {
    const std::vector<fs::path> found = files();
    if (found.size() != 1) {
      ADD_FAILURE() << found.size() << " files";
      return {};
    }
    const vulkan::Device device(test_device());
    EXPECT_NE(vulkan::unpack_pipelines(vulkan::pipeline_cache_header(device.physical()), read_bytes(found.front())),
              "");
    return found.front();
  }

  const TemporaryFolder folder_;
};

TEST_F(PipelineCache, IsKeptInItsFolderAlone) {
  use(kept());
  expect_sound();
  use(kept());  // with what was kept
  expect_sound();
}

TEST_F(PipelineCache, IsNotKeptWithoutAFolder) {
  use("");
  EXPECT_FALSE(fs::exists(kept()));
}

TEST_F(PipelineCache, ReplacesWhatDoesNotFit) {
  use(kept());
  const fs::path file = expect_sound();
  const std::string sound = read_bytes(file);
  PipelineCacheHeader other = some_driver();
  for (const std::string& bad : {std::string(), std::string("noise"), sound.substr(0, sound.size() - 1),
                                 vulkan::pack_pipelines(other, sound.substr(sizeof(other)))}) {
    write_file_atomically(file, std::as_bytes(std::span(bad)));
    use(kept());
    expect_sound();
  }
}

// Root may write everywhere, but not into a file as if it were a folder; nor is a folder replaced by the file.
TEST_F(PipelineCache, AFolderThatCannotBeWrittenIsNoError) {
  std::ofstream(folder_ / "file") << "in the way";
  use(folder_ / "file");
  use(folder_ / "file/below");
  EXPECT_EQ(read_bytes(folder_ / "file"), "in the way");
  use(kept());
  const fs::path file = expect_sound();
  fs::remove(file);
  fs::create_directory(file);
  use(kept());
  EXPECT_EQ(files(), std::vector{file});
  EXPECT_TRUE(fs::is_directory(file));
}

// Several at once, as processes are: each reads a whole file or none.
TEST_F(PipelineCache, IsSharedByWhoRunsAtTheSameTime) {
  test_device();  // sets the environment, before there are threads
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int k = 0; k < 3; ++k) use(kept());
    });
  }
  for (std::thread& thread : threads) thread.join();
  expect_sound();
}

}  // namespace pipeline_cache_test
}  // namespace bodyopt::testing
