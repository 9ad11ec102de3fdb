// A motion that is known comes out of every file that holds it.
#include "tests/support/known_motion.h"

#include <gtest/gtest.h>

#include "tests/assets/gltf_blob.h"

namespace bodyopt::testing {
namespace {

TEST(KnownMotion, ComesOutUprightOfEveryFile) {
  constexpr std::uint32_t kFiles = 300;
  const TemporaryFolder folder;
  std::size_t asked = 0;
  // Joints at random that look like a pose, but for a foot, an elbow or a wrist.
  std::vector<std::uint32_t> seeds{4686, 19640, 56653, 64189, 77107};
  for (std::uint32_t seed = 1; seed <= kFiles; ++seed) seeds.push_back(seed);
  for (const std::uint32_t seed : seeds) {
    const KnownMotion known = known_motion(seed);
    put_bytes(folder / "known.bvh", known.bvh);
    const Clip clip = read_clip((folder / "known.bvh").string(), known.skeleton, {.fps = known.fps});
    const std::string wrong = wrong_in(known, clip);
    if (!wrong.empty() && asks_for_up(clip)) {
      ++asked;
    } else {
      EXPECT_EQ(wrong, "") << known.what;
    }
  }
  EXPECT_LT(asked, kFiles / 20);
}

// What moves by half a degree is carried as what stands still, but for that.
TEST(KnownMotion, HalfADegreeMakesHalfADegree) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const KnownMotion known = known_motion(seed);
    const std::size_t motion = known.bvh.find("MOTION");
    for (const char* angle : {"0", "0.5"}) {
      // One joint alone has another angle in one frame of two; the others stand as they do in the first.
      const std::size_t frame = known.bvh.find('\n', known.bvh.find("Frame Time")) + 1;
      const std::string line = known.bvh.substr(frame, known.bvh.find('\n', frame) - frame);
      const std::string last = line.substr(0, line.find_last_of(' ', line.size() - 2) + 1);
      put_bytes(
          folder / (std::string(angle) + ".bvh"),
          known.bvh.substr(0, motion) + "MOTION\nFrames: 2\nFrame Time: 1\n" + last + "0\n" + last + angle + "\n");
    }
    const Clip still = read_clip((folder / "0.bvh").string(), known.skeleton, {.fps = 1}),
               moved = read_clip((folder / "0.5.bvh").string(), known.skeleton, {.fps = 1});
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t j = 0; j < known.skeleton.size(); ++j) {
        EXPECT_LT(angle_between(still.poses[k].joints[j].rotation, moved.poses[k].joints[j].rotation), 0.01)
            << known.what;
      }
    }
  }
}

}  // namespace
}  // namespace bodyopt::testing
