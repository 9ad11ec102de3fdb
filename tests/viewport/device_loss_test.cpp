// The device is lost (by the layer of tests/support) while pictures are drawn, shown and evaluated: the programs end
// with a message, and what they leave behind is whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "tests/support/read_bytes.h"
#include "tests/viewport/window_fixture.h"

namespace bodyopt::testing {
namespace {

class DeviceLossTest : public WindowTest {
 protected:
  // Loses the device in the given call, as "vkQueueSubmit 5".
  static std::string losing(const std::string& call) { return misbehaving_device("LOSE_DEVICE='" + call + "'"); }

  static void expect_said(const ProgramResult& result, const std::string& call) {
    EXPECT_EQ(result.exit_code, 5) << call << "\n" << result.output;
    for (const char* said : {"the device was lost", "likely", "whole"}) {
      EXPECT_NE(result.output.find(said), std::string::npos) << call << ": " << said << " is not in\n" << result.output;
    }
  }

  void remove_pictures() const {
    for (int frame = 1; frame <= kClipFrames; ++frame) {
      char name[32];
      std::snprintf(name, sizeof(name), "late.%04d.png", frame);
      std::filesystem::remove(folder_ / name);
    }
  }

  std::size_t whole_pictures() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
      if (entry.path().extension() != ".png") continue;
      EXPECT_EQ(read_png(entry.path()).width, 320u) << entry.path();
      ++count;
    }
    return count;
  }
};

TEST_F(DeviceLossTest, OfAWindowIsSaid) {
  const auto playing = [&](const std::string& seconds) {
    return small(small_.truth + " --seconds " + seconds + " --do 'compare truth; ghosts 2 2; play'");
  };
  // In a minute there are more than in a second; waits are about as many.
  const int all = submissions_of(playing("1"));
  const std::string some = std::to_string(std::max(2, all / 5)), most = std::to_string(all);
  for (const std::string& call :
       {std::string("vkQueueSubmit 1"), "vkQueueSubmit " + some, "vkQueueSubmit " + most, "vkWaitForFences " + some,
        "vkWaitForFences " + most, std::string("vkAcquireNextImageKHR 1"), std::string("vkAcquireNextImageKHR 9"),
        std::string("vkQueuePresentKHR 1"), std::string("vkQueuePresentKHR 10")}) {
    expect_said(run_program(command(playing("60"), losing(call))), call);
  }
}

TEST_F(DeviceLossTest, OfPicturesLeavesThoseThatWereWritten) {
  const std::string pictures = small("--headless -o late.####.png");
  expect_said(run_program(command(pictures, losing("vkWaitForFences 2"))), "at the start");
  EXPECT_EQ(whole_pictures(), 0u);
  const int all = submissions_of(pictures);
  ASSERT_EQ(whole_pictures(), static_cast<std::size_t>(kClipFrames));
  // Earlier and earlier: what is there was written before.
  std::set<std::size_t> counts;
  for (const double part : {1.0, 0.85, 0.7, 0.5, 0.3}) {
    remove_pictures();
    const std::string submission = "vkQueueSubmit " + std::to_string(std::max(1, static_cast<int>(part * all)));
    expect_said(run_program(command(pictures, losing(submission))), submission);
    counts.insert(whole_pictures());
  }
  EXPECT_GT(counts.size(), 2u);
  EXPECT_LT(*counts.rbegin(), static_cast<std::size_t>(kClipFrames));  // the last picture needs the last submission
}

TEST_F(DeviceLossTest, OfAnEvaluationLeavesTheOldCache) {
  const std::string out = (folder_ / "out.pc2").string();
  const std::string program = " " + kProgram + " eval ";
  const auto evaluate = [&](const std::string& arguments, const std::string& device) {
    return run_program(device + program + arguments + " --require-device --out " + out);
  };
  const std::string bend = small_.basis + " --clip " + small_.clip;
  for (const std::string call : {"vkQueueSubmit 1", "vkWaitForFences 2"}) {
    expect_said(evaluate(bend, losing(call)), call);
    EXPECT_FALSE(std::filesystem::exists(out)) << call;
  }
  const JigglingCharacter limb(folder_);
  const std::string state = (folder_ / "out.state").string();
  const std::string jiggle = limb.basis + " --clip " + limb.clip + " --jiggle --state-out " + state;
  const int all = count_submissions([&](const std::string& counting) { return evaluate(jiggle, counting); });
  const auto written = std::filesystem::last_write_time(out), kept = std::filesystem::last_write_time(state);
  for (const int submission : {all / 2, all}) {  // the last one reads the state back
    const std::string call = "vkQueueSubmit " + std::to_string(submission);
    expect_said(evaluate(jiggle, losing(call)), call);
    EXPECT_EQ(std::filesystem::last_write_time(out), written) << call;
    EXPECT_EQ(std::filesystem::last_write_time(state), kept) << call;
  }
  EXPECT_EQ(whole_pictures(), 0u);
}

// Evaluates with --resume on a device: whole; with its loss in nearly the last submission; and again.
TEST_F(DeviceLossTest, AnEvaluationThatIsRunAgainGoesOnFromThere) {
  const std::string clip = write_long_clip(folder_, small_.made.skeleton, 800);  // more than are evaluated at once
  const JigglingCharacter limb(folder_);
  const std::string whole = (folder_ / "whole.pc2").string(), parts = (folder_ / "parts.pc2").string();
  const std::string state = (folder_ / "out.state").string();
  for (const std::string& options :
       {small_.basis + " --clip " + clip, limb.basis + " --clip " + limb.clip + " --jiggle --state-out " + state}) {
    const auto evaluate = [&](const std::string& device, const std::string& out) {
      return run_program(device + " " + kProgram + " eval " + options + " --require-device --resume --out " + out);
    };
    const int all = count_submissions([&](const std::string& counting) { return evaluate(counting, whole); });
    const std::string state_of_whole = std::filesystem::exists(state) ? read_bytes(state) : "";
    const std::string call = "vkQueueSubmit " + std::to_string(all - 1);
    const ProgramResult lost = evaluate(losing(call), parts);
    expect_said(lost, call);
    EXPECT_NE(lost.output.find("the same command goes on after frame"), std::string::npos) << lost.output;
    EXPECT_FALSE(std::filesystem::exists(parts));
    const ProgramResult again = evaluate("", parts);
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_NE(again.output.find(": goes on after frame"), std::string::npos) << again.output;
    EXPECT_EQ(read_bytes(parts), read_bytes(whole));
    EXPECT_EQ(std::filesystem::exists(state) ? read_bytes(state) : "", state_of_whole);
    EXPECT_FALSE(std::filesystem::exists(parts + ".checkpoint"));
    for (const std::string& file : {parts, whole}) {
      std::filesystem::remove(file);
      std::filesystem::remove(file + ".done.json");
    }
  }
}

TEST_F(DeviceLossTest, OutOfMemoryOfAnEvaluationIsSaid) {
  const std::string out = (folder_ / "out.pc2").string();
  const std::string clip = write_long_clip(folder_, small_.made.skeleton, 200);
  // Batches are short, so that one is under way when there is no memory for the next. At last there is enough.
  for (int allocation = 1; allocation < 40; ++allocation) {
    const ProgramResult result =
        run_program(misbehaving_device("FAIL_ALLOCATION=" + std::to_string(allocation)) + " BODYOPT_HEAP=1000000 " +
                    kProgram + " eval " + small_.basis + " --clip " + clip + " --require-device --out " + out);
    if (allocation > 2 && result.exit_code == 0) return;
    EXPECT_EQ(result.exit_code, 5) << result.output;
    for (const char* said : {"out of device memory", "fewer frames", "--device cpu"}) {
      EXPECT_NE(result.output.find(said), std::string::npos) << said << " is not in\n" << result.output;
    }
    EXPECT_FALSE(std::filesystem::exists(out));
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    }
  }
  ADD_FAILURE() << "it never ended well";
}

}  // namespace
}  // namespace bodyopt::testing
