// What programs ask of the driver, as the layer of tests/support sees it.

#include "runtime/vulkan/pipeline_cache.h"
#include "tests/proxy_viewer/window_fixture.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::testing {
namespace {

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
  constexpr int kFew = 256, kMany = 768;  // a part, and three
  const JigglingCharacter limb(folder_);
  Clip clip = bending_clip(limb.made.basis.skeleton);
  for (int k = kClipFrames; k < kMany; ++k) clip.poses.push_back(clip.poses[static_cast<std::size_t>(k % kClipFrames)]);
  const std::string file = (folder_ / "long.glb").string();
  write_clip(clip, limb.made.basis.skeleton, file);
  for (const auto& [options, submissions] : {std::pair(std::string(), 2), {std::string(" --jiggle"), kMany - kFew}}) {
    SCOPED_TRACE(options);
    const auto calls = [&](int last) {
      return count_calls([&](const std::string& counting) {
        return run_program(counting + " " + kProgram + " eval " + limb.basis + options + " --clip " + file +
                           " --frames 1-" + std::to_string(last) + " --require-device --out " +
                           (folder_ / "out.pc2").string());
      });
    };
    const DriverCalls few = calls(kFew), many = calls(kMany);
    EXPECT_EQ(many.submissions - few.submissions, submissions);
    EXPECT_EQ(many.allocations, few.allocations);
    EXPECT_EQ(many.buffers, few.buffers);
    EXPECT_EQ(many.sets, few.sets);
  }
}

// Two submissions a part: what computes, and what copies once that is done.
TEST_F(DriverCallsTest, AQueueForCopiesFetchesTheSameSkin) {
  const std::string eval = std::string(kProgram) + " eval " + small_.basis + " --clip " + small_.clip +
                           " --require-device --out " + (folder_ / "out.pc2").string();
  const auto submissions = [&](const std::string& more) {
    return count_submissions([&](const std::string& counting) { return run_program(counting + more + " " + eval); });
  };
  const int with_one_queue = submissions("");
  const std::string skin = read_bytes(folder_ / "out.pc2");
  EXPECT_EQ(submissions(" BODYOPT_COPY_FAMILY=1"), with_one_queue + 1);
  EXPECT_EQ(read_bytes(folder_ / "out.pc2"), skin);
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
