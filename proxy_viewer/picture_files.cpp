#include "proxy_viewer/picture_files.h"

#include <filesystem>
#include <numbers>
#include <span>
#include <vector>

#include "proxy_viewer/frame_sequence_name.h"
#include "proxy_viewer/render/animation.h"
#include "runtime/basis/atomic_file.h"
#include "trainer/progress.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTurntablePictures = 72;
constexpr const char* kNewScreenshot = "bodyopt.####.png";
constexpr const char* kKept = "the pictures that were written are kept";

std::string free_name() {
  const FrameSequenceName name(kNewScreenshot, 2);
  int k = 1;
  while (fs::exists(name(k))) ++k;
  return name(k).string();
}

void say_written(std::size_t count, const fs::path& one, Controls& controls) {
  controls.say("wrote " + std::to_string(count) + " pictures, " + one.string());
}

}  // namespace

void write_screenshot(const std::string& file, const DrawPicture& draw, Controls& controls) {
  const std::string name = file.empty() ? free_name() : file;
  write_png(draw(), name);
  controls.say("wrote " + name);
}

void write_sequence(const std::string& pattern, double fps, const DrawPicture& draw, Controls& controls) {
  Playback& playback = controls.playback;
  const bool flip_book = fs::path(pattern).extension() == ".webp";
  const bool moves = flip_book || pattern.find_first_of("#%") != std::string::npos;
  playback.pause();
  const int shown = playback.frame(), first = moves ? playback.in() : shown, last = moves ? playback.out() : shown;
  const std::size_t count = static_cast<std::size_t>(last - first + 1);
  const FrameSequenceName name(pattern, flip_book ? 1 : count);
  std::vector<Image> pictures;
  Progress progress("pictures", count, kKept);
  for (int frame = first; frame <= last; ++frame) {
    playback.scrub(frame);
    if (flip_book) {
      pictures.push_back(draw());
    } else {
      write_png(draw(), name(frame));
    }
    progress.advance();
  }
  if (flip_book) {
    const auto bytes = encode_animation(pictures, 1e3 / fps / playback.speed());
    write_file_atomically(pattern, std::as_bytes(std::span(bytes)));
  }
  playback.scrub(shown);
  say_written(count, name(shown), controls);
}

void write_turntable(const std::string& pattern, const DrawPicture& draw, Controls& controls) {
  const FrameSequenceName name(pattern, kTurntablePictures);
  const OrbitCamera camera = controls.camera;
  Progress progress("pictures", kTurntablePictures, kKept);
  for (std::size_t k = 0; k < kTurntablePictures; ++k) {
    write_png(draw(), name(static_cast<int>(k) + 1));
    progress.advance();
    controls.camera.orbit(2 * std::numbers::pi / static_cast<double>(kTurntablePictures), 0);
  }
  controls.camera = camera;
  say_written(kTurntablePictures, name(1), controls);
}

}  // namespace bodyopt
