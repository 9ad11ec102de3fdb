// Sounds against those that were synthesised here.
#include "viewport/state/waveform.h"

#include <imgui_internal.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"
#include "tests/support/read_bytes.h"
#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace waveform_test {

using namespace shots;
using namespace draw;
using namespace viewport;

constexpr int kRate = 8000, kChannels = 2;

struct Coding {
  int bits;
  bool is_float;
};

std::string little(std::uint32_t value, int bytes) {
  std::string text;
  for (int k = 0; k < bytes; ++k) text += static_cast<char>(value >> 8 * k);
  return text;
}

std::string sample(double value, const Coding& coding) {
  if (coding.is_float) {
    const auto single = static_cast<float>(value);
    std::uint32_t word;
    std::memcpy(&word, &single, 4);
    return little(word, 4);
  }
  const double full = std::ldexp(1.0, coding.bits - 1);
  const auto level = static_cast<std::int64_t>(std::lround(value * (full - 1)));
  return little(static_cast<std::uint32_t>(coding.bits == 8 ? level + 128 : level), coding.bits / 8);
}

// A second of silence, a second of a sine of half the full swing on the second channel, and a second of silence.
std::string wav(const Coding& coding) {
  std::string data;
  for (int k = 0; k < 3 * kRate; ++k) {
    const bool sounds = k >= kRate && k < 2 * kRate;
    data += sample(0, coding) + sample(sounds ? 0.5 * std::sin(2 * std::numbers::pi * 440 * k / kRate) : 0, coding);
  }
  const auto frame = static_cast<std::uint32_t>(kChannels * coding.bits / 8);
  return "RIFF" + little(static_cast<std::uint32_t>(36 + data.size()), 4) + "WAVEfmt " + little(16, 4) +
         little(coding.is_float ? 3 : 1, 2) + little(kChannels, 2) + little(kRate, 4) + little(kRate * frame, 4) +
         little(frame, 2) + little(static_cast<std::uint32_t>(coding.bits), 2) + "data" +
         little(static_cast<std::uint32_t>(data.size()), 4) + data;
}

class WaveformTest : public PlayedTest {
 protected:
  static Waveform read(const std::string& bytes) {
    write_bytes("a.wav", bytes);
    return read_waveform("a.wav");
  }
};

TEST_F(WaveformTest, SwingsAsTheSoundDoes) {
  for (const Coding& coding : {Coding{8, false}, {16, false}, {24, false}, {32, false}, {32, true}}) {
    const Waveform wave = read(wav(coding));
    EXPECT_NEAR(static_cast<double>(wave.parts.size()) / wave.rate, 3, 0.01) << coding.bits;
    EXPECT_NEAR(wave.loudest, 0.5, 0.01) << coding.bits;
    for (const double at : {1.1, 1.5, 1.9}) {
      const auto [low, high] = wave.swing(at, at + 0.02);
      EXPECT_NEAR(low, -0.5, 0.01) << coding.bits;
      EXPECT_NEAR(high, 0.5, 0.01) << coding.bits;
    }
    for (const double at : {-5.0, 0.2, 0.98, 2.02, 2.9, 40.0}) {
      const auto [low, high] = wave.swing(at, at + 0.01);
      EXPECT_NEAR(high - low, 0, 0.01) << coding.bits << " at " << at;
    }
  }
}

TEST_F(WaveformTest, HostileFilesAreRefusedWithASentence) {
  const std::string good = wav({16, false});
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  for (const std::string& bytes :
       {std::string(), std::string("RIFF"), good.substr(0, 20), good.substr(0, 44), with(24, little(0, 4)),
        with(24, little(7, 4)), with(22, little(0, 2)), with(0, "RIFX"), with(8, "AVI "), std::string(5000, 'x')}) {
    write_bytes("a.wav", bytes);
    EXPECT_EQ(kind_of([] { read_waveform("a.wav"); }), ErrorKind::file) << bytes.size();
  }
  ASSERT_EQ(mkfifo("pipe.wav", 0600), 0);
  for (const char* file : {"absent.wav", "pipe.wav", "."}) {
    EXPECT_EQ(kind_of([&] { read_waveform(file); }), ErrorKind::file) << file;
  }
  // Whatever is wrong in its head, it is read or refused.
  Random random(9);
  for (int k = 0; k < 300; ++k) {
    std::string bytes = good.substr(0, 4000);
    for (int n = 0; n < 3; ++n) bytes[random.below(48)] = static_cast<char>(random.below(256));
    write_bytes("a.wav", bytes);
    try {
      for (const auto& [low, high] : read_waveform("a.wav").parts) ASSERT_TRUE(-1 <= low && low <= high && high <= 1);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
    }
  }
}

// The small clip has 12 frames, of half a second: the sound begins half a second before the range.
TEST_F(WaveformTest, StandsUnderTheTimelineAndInTheSession) {
  write_bytes("a.wav", wav({16, false}));
  const auto viewport = open(small(), "hud off");
  viewport->resize(1280, 800);
  viewport->click_messages_away();
  const float before = ImGui::FindWindowByName("Timeline")->Rect().GetHeight();
  // Of the strip under the bar, the columns in which something swings, left and right of the middle.
  std::size_t tallest = 0;  // rows
  const auto columns = [&] {
    const Image& picture = viewport->screen.picture;
    std::array<int, 2> count{};
    for (std::uint32_t x = 600; x < 1270; ++x) {
      std::size_t swings = 0;
      for (std::uint32_t y = 762; y < 788; ++y) {
        const std::uint8_t* p = picture.rgba.data() + 4 * (std::size_t{y} * picture.width + x);
        swings += p[0] == 120 && p[1] == 170 && p[2] == 220;
      }
      tallest = std::max(tallest, swings);
      count[x < 935 ? 0 : 1] += swings > 6;
    }
    return count;
  };
  viewport->prompt("sound a.wav -17");  // its sine is from frame 7 on
  viewport->play({viewport->at(300, 100)});
  EXPECT_EQ(ImGui::FindWindowByName("Timeline")->Rect().GetHeight(), before + 32);
  const auto [left, right] = columns();
  EXPECT_LT(left, 60);
  EXPECT_GT(right, 250);
  EXPECT_GT(tallest, 20u) << "half the full swing fills the strip";
  viewport->prompt("in 8");
  viewport->prompt("zoom-range on");
  viewport->play({viewport->at(300, 100)});
  EXPECT_GT(columns()[0], 250) << "it zooms with the timeline";
  viewport->prompt("save shot.json");
  EXPECT_EQ(read_bytes("shot.json").find(folder_.path().string()), std::string::npos) << "relative";
  ViewerOptions options = small();
  options.files = {"shot.json"};
  {
    const auto again = open(options);
    EXPECT_EQ(again->controls().sound, (SoundFile{"a.wav", -17}));
    ASSERT_TRUE(again->session().snapshot.waveform);
    again->prompt("sound none");
    EXPECT_FALSE(again->session().snapshot.waveform);
  }
  std::filesystem::remove("a.wav");
  const auto without = open(options, "");
  EXPECT_EQ(without->controls().sound.file, "a.wav") << "it may come back";
  EXPECT_FALSE(without->session().snapshot.waveform);
  EXPECT_EQ(without->session().scene.cast().size(), 1u);
}

}  // namespace waveform_test
}  // namespace bodyopt::testing
