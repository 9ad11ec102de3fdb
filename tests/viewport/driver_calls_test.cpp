// What programs ask of the driver, as the layer of tests/support sees it.

#include "runtime/vulkan/pipeline_cache.h"
#include "tests/support/read_bytes.h"
#include "tests/viewport/window_fixture.h"

namespace bodyopt::testing {
namespace {

const std::string kLittleMemory = " BODYOPT_HEAP=1000000";  // batches are short
constexpr int kFew = 256, kMany = 768;                      // frames: a part, and three

class DriverCallsTest : public WindowTest {
 protected:
  // What a picture needs more, once all is loaded.
  int of_a_picture(const std::string& cast) const {
    const auto of_pictures = [&](int last) {
      return submissions_of(cast + " --headless --ff 1 --lf " + std::to_string(last) + " -o many.####.png");
    };
    const int few = of_pictures(4), many = of_pictures(kClipFrames);
    EXPECT_EQ((many - few) % (kClipFrames - 4), 0);
    return (many - few) / (kClipFrames - 4);
  }

  std::filesystem::path out() const { return folder_ / "out.pc2"; }
  ProgramResult evaluate(const std::string& environment, const std::string& basis, const std::string& clip,
                         int last) const {
    return run_program(environment + " " + kProgram + " eval " + basis + " --clip " + clip + " --frames 1-" +
                       std::to_string(last) + " --require-device --out " + out().string());
  }
  DriverCalls of_an_evaluation(const std::string& basis, const std::string& clip, int last,
                               const std::string& device = "") const {
    return count_calls([&](const std::string& counting) { return evaluate(counting + device, basis, clip, last); });
  }
  static void expect_no_more_memory(const DriverCalls& few, const DriverCalls& many) {
    EXPECT_EQ(many.allocations, few.allocations);
    EXPECT_EQ(many.buffers, few.buffers);
    EXPECT_EQ(many.sets, few.sets);
  }
};

TEST_F(DriverCallsTest, SubmissionsOfACastAreThoseOfOne) {
  const std::string one = small_.basis + " " + small_.clip + " --device 0";
  EXPECT_EQ(of_a_picture(one),
            of_a_picture(one + " " + small_.basis + " " + small_.clip + " " + small_.basis + " " + small_.clip));
}

// Ghosts, which are quasi-static, beside the jiggle.
TEST_F(DriverCallsTest, SubmissionsOfSeveralMethodsAreThoseOfOne) {
  const JigglingCharacter limb(folder_);
  const std::string one = limb.basis + " " + limb.clip + " --device 0";
  EXPECT_EQ(of_a_picture(one), of_a_picture(one + " --do 'jiggle on; ghosts 1 1'"));
}

// Once all is loaded a frame is a submission of what is there: a part of a quasi-static clip, or a frame that jiggles.
TEST_F(DriverCallsTest, FramesAllocateNothingOnTheDevice) {
  const JigglingCharacter limb(folder_);
  const std::string clip = write_long_clip(folder_, limb.made.basis.skeleton, kMany);
  for (const auto& [options, submissions] : {std::pair(std::string(), 2), {std::string(" --jiggle"), kMany - kFew}}) {
    SCOPED_TRACE(options);
    const DriverCalls few = of_an_evaluation(limb.basis + options, clip, kFew),
                      many = of_an_evaluation(limb.basis + options, clip, kMany);
    EXPECT_EQ(many.submissions - few.submissions, submissions);
    expect_no_more_memory(few, many);
    EXPECT_EQ(many.most_unwaited, 1);
  }
}

// While one runs the next is on its way.
TEST_F(DriverCallsTest, TwoBatchesOfAPartAreUnderWay) {
  const std::string clip = write_long_clip(folder_, small_.made.skeleton, kMany);
  const DriverCalls few = of_an_evaluation(small_.basis, clip, kFew, kLittleMemory),
                    many = of_an_evaluation(small_.basis, clip, kMany, kLittleMemory);
  EXPECT_GT(many.submissions - few.submissions, 6);
  EXPECT_EQ(many.most_unwaited, 2);
  expect_no_more_memory(few, many);
}

// Two submissions a batch: what computes, and what copies once that is done.
TEST_F(DriverCallsTest, AQueueForCopiesFetchesTheSameSkin) {
  const std::string clip = write_long_clip(folder_, small_.made.skeleton, kFew), copies = " BODYOPT_COPY_FAMILY=1";
  const int with_one_queue = of_an_evaluation(small_.basis, clip, kFew).submissions;
  const std::string skin = read_bytes(out());
  EXPECT_EQ(of_an_evaluation(small_.basis, clip, kFew, copies).submissions, with_one_queue + 1);
  EXPECT_EQ(read_bytes(out()), skin);
  std::filesystem::remove(out());
  EXPECT_GT(of_an_evaluation(small_.basis, clip, kFew, copies + kLittleMemory).submissions, with_one_queue + 3);
  EXPECT_EQ(read_bytes(out()), skin);
  // The last submission copies: what computes is on its way.
  const std::string call = "LOSE_DEVICE='vkQueueSubmit " + std::to_string(with_one_queue + 1) + "'";
  const ProgramResult lost = evaluate(misbehaving_device(call) + copies, small_.basis, clip, kFew);
  EXPECT_EQ(lost.exit_code, 5) << lost.output;
}

TEST_F(DriverCallsTest, TablesOfACharacterGoInOneSubmission) {
  const int count = count_submissions([&](const std::string& counting) {
    return run_program(counting + " " + kProgram + " eval " + small_.basis + " --clip " + small_.clip +
                       " --frames 1 --require-device --out " + (folder_ / "out.pc2").string());
  });
  EXPECT_EQ(count, 5) << "beside them: coefficients at rest, sent twice and found once; the frame";
}

TEST_F(DriverCallsTest, PipelinesThatWereKeptReachTheDriver) {
  const std::filesystem::path given = folder_ / "given.bin", caches = folder_ / "caches";
  const auto evaluate = [&] {
    std::filesystem::remove(given);
    const ProgramResult result =
        run_program(misbehaving_device("KEEP_PIPELINES=" + given.string()) + " XDG_CACHE_HOME=" + caches.string() +
                    " " + kProgram + " eval " + small_.basis + " --clip " + small_.clip + " --require-device --out " +
                    (folder_ / "out.pc2").string());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_TRUE(std::filesystem::exists(given));
    return read_bytes(given);
  };
  EXPECT_EQ(evaluate(), "");
  const std::filesystem::directory_iterator kept(caches / "bodyopt");
  ASSERT_NE(kept, std::filesystem::directory_iterator());
  const std::string file = read_bytes(kept->path());
  ASSERT_GT(file.size(), sizeof(vulkan::PipelineCacheHeader));
  EXPECT_EQ(evaluate(), file.substr(sizeof(vulkan::PipelineCacheHeader)));
}

}  // namespace
}  // namespace bodyopt::testing
