// Movies by ffmpeg, where it is there: whole, or not there at all.
#include "viewport/movie_file.h"

#include <cstdlib>
#include <functional>

#include "tests/support/environment.h"
#include "tests/support/lowered_limit.h"
#include "tests/support/random_tables.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace movie_file_test {

using namespace draw;
using namespace viewport;

bool has_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1 && ffprobe -version > /dev/null 2>&1") == 0; }

// Of the video stream: size, frames a second, and how many frames are decoded.
std::string probe(const std::string& file) {
  const std::string command =
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=width,height,pix_fmt,r_frame_rate,nb_read_frames -of csv=p=0 '" +
      file + "' > probed.txt";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return read_bytes("probed.txt");
}

std::string message_of(ErrorKind kind, const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "nothing was thrown";
}

class MovieFileTest : public PlayedTest {
 protected:
  void SetUp() override {
    if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  }
  static std::size_t left_behind() {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(".")) {
      count += entry.path().string().find(".tmp") != std::string::npos || entry.path().extension() == ".mp4";
    }
    return count;
  }
  static Image noise(std::uint32_t side, std::uint32_t seed) {
    Image image{side, side, {}};
    Random random(seed);
    for (std::uint32_t k = 0; k < 4 * side * side; ++k)
      image.rgba.push_back(static_cast<std::uint8_t>(random.below(256)));
    return image;
  }
};

TEST_F(MovieFileTest, HasEveryFrameOfTheRangeInItsTime) {
  ViewerOptions options = small();
  options.width = 321;
  options.height = 181;
  options.clip.fps = 30;
  options.headless = true;
  options.out = "m.mp4";
  options.commands = kBarePicture + "; in 3; out 9; speed 0.5";
  Application(options, device_, nullptr).make_pictures();
  EXPECT_EQ(probe("m.mp4"), "320,180,yuv420p,15/1,7\n") << "half as fast, and even";
  ASSERT_EQ(std::system("ffmpeg -v error -i m.mp4 -frames:v 1 first.png"), 0);
  Image expected = headless(small(), "frame 3");
  EXPECT_EQ(left_behind(), 1u);
  EXPECT_LT(spot_difference(read_png("first.png"), expected).mean, 3) << "the colours are those of pictures";
}

// Three seconds of a sound that begins half a second before the movie, which is half a second long.
TEST_F(MovieFileTest, HasTheSoundOfTheTimeline) {
  ASSERT_EQ(std::system("ffmpeg -v error -f lavfi -i sine=frequency=440:duration=3 -c:a pcm_s16le a.wav"), 0);
  ViewerOptions options = small();
  options.headless = true;
  options.out = "m.mp4";
  options.commands = kBarePicture + "; sound a.wav -11";
  Application(options, device_, nullptr).make_pictures();
  EXPECT_EQ(probe("m.mp4"), "320,180,yuv420p,24/1,12\n");
  ASSERT_EQ(std::system("ffprobe -v error -select_streams a -show_entries stream=codec_name,duration -of csv=p=0 m.mp4 "
                        "> probed.txt"),
            0);
  const std::string sound = read_bytes("probed.txt");
  EXPECT_TRUE(sound.starts_with("aac,0.5")) << sound;
}

TEST_F(MovieFileTest, EscapeLeavesNothing) {
  const auto viewport = open(small(), kBarePicture + "; sequence m.mp4");
  EXPECT_EQ(left_behind(), 1u);
  viewport->key("Enter");
  std::vector<WindowEvent> letters;
  for (const char letter : std::string("sequence n.mp4")) letters.emplace_back(LetterEvent{char32_t(letter)});
  viewport->play(letters);
  viewport->turn(PlayedViewport::stroke("Enter"), PlayedViewport::kTurn);
  for (int k = 0; k < 4; ++k) viewport->turn({}, PlayedViewport::kTurn);
  viewport->turn(PlayedViewport::stroke("Escape"), PlayedViewport::kTurn);
  viewport->rest();
  ASSERT_FALSE(viewport->controls().messages.empty());
  EXPECT_NE(viewport->controls().messages.back().text.find("pictures: nothing is written"), std::string::npos);
  EXPECT_EQ(left_behind(), 1u);
}

TEST_F(MovieFileTest, AnEncoderThatFailsIsToldAndLeavesNothing) {
  const LoweredLimit limit(RLIMIT_FSIZE, 20000);
  const std::string message = message_of(ErrorKind::file, [] {
    MovieFile movie("full.mp4", {24});
    for (std::uint32_t k = 0; k < 40; ++k) movie.add(noise(256, k));
    movie.finish();
  });
  EXPECT_NE(message.find("full.mp4: ffmpeg could not write it"), std::string::npos) << message;
  EXPECT_EQ(left_behind(), 0u);
}

TEST(MovieFileWithoutFfmpeg, SaysWhatToInstall) {
  const TemporaryFolder folder;
  const Environment empty("PATH", "");
  const std::string message = message_of(ErrorKind::usage, [&] {
    MovieFile(folder / "m.mp4", {24}).add({8, 8, std::vector<std::uint8_t>(256)});
  });
  for (const char* named : {"m.mp4", "apt-get install ffmpeg", ".webp"}) {
    EXPECT_NE(message.find(named), std::string::npos) << message;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace movie_file_test
}  // namespace bodyopt::testing
