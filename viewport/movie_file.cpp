#include "viewport/movie_file.h"

#include <algorithm>
#include <initializer_list>
#include <span>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt::viewport {
namespace {

// ffmpeg takes what it would for an MP4: H.264, or else MPEG-4, each by its own measure as good as it looks.
std::vector<std::string> encode(const draw::Image& frame, const MovieFile::Plan& plan, const std::string& file) {
  const auto number = [](double value) { return formatted("%.9g", value); };
  const std::string size = std::to_string(frame.width) + "x" + std::to_string(frame.height);
  std::vector<std::string> words = {"ffmpeg", "-nostdin", "-loglevel", "error", "-xerror", "-y"};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  add({"-f", "rawvideo", "-pix_fmt", "rgba", "-s", size, "-r", number(plan.fps), "-i", "pipe:0"});
  if (!plan.sound.empty()) {
    add({"-ss", number(std::max(0.0, -plan.sound_begins)), "-itsoffset", number(std::max(0.0, plan.sound_begins))});
    add({"-i", "file:" + plan.sound, "-t", number(static_cast<double>(plan.count) / plan.fps)});
  }
  add({"-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2:0:0,scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p"});
  add({"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-crf", "17", "-q:v", "2"});
  add({"-movflags", "+faststart", "-f", "mp4", "file:" + file});
  return words;
}

}  // namespace

void MovieFile::add(const draw::Image& frame) {
  if (!encoder_) {
    try {
      encoder_.emplace(encode(frame, plan_, file_.temporary().string()));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::usage) throw;
      throw Error(ErrorKind::usage, path_.string() + ": movies of this kind are encoded by ffmpeg, and " +
                                        error.what() + ": install it (apt-get install ffmpeg), or write .webp");
    }
  }
  if (!encoder_->write(std::as_bytes(std::span(frame.rgba)))) end_encoder();
}

void MovieFile::finish() {
  end_encoder();
  file_.commit();
}

void MovieFile::end_encoder() {
  const std::string problem = encoder_->finish();
  if (problem.empty()) return;
  throw Error(ErrorKind::file, path_.string() + ": ffmpeg could not write it (is the disk full?): " + problem);
}

}  // namespace bodyopt::viewport
