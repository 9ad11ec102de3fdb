#include "assets/join_caches.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "assets/pc2.h"
#include "assets/usda.h"
#include "base/progress.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::mismatch, path.string() + ": " + what);
}

void require_apart(const fs::path& before, int last, const fs::path& after, int first) {
  if (first > last) return;
  fail(after, "begins with frame " + std::to_string(first) + ", and " + before.string() + " ends with frame " +
                  std::to_string(last) + ": parts of one shot have no frames in common");
}

int frame_number(const fs::path& path, double frame) {
  if (std::abs(frame) <= 1e7 && frame == std::floor(frame)) return static_cast<int>(frame);
  fail(path, "its samples are not at whole frames: it is no part that 'bodyopt eval' wrote");
}

std::vector<int> frames_of(const Pc2Reader& part) {
  std::vector<int> frames;
  for (std::uint32_t k = 0; k < part.sample_count(); ++k) {
    frames.push_back(frame_number(part.path(), static_cast<double>(part.start_frame()) +
                                                   static_cast<double>(k) * static_cast<double>(part.sample_rate())));
  }
  return frames;
}

void join_pc2(const std::vector<fs::path>& paths, const fs::path& out) {
  std::vector<Pc2Reader> parts;
  for (const fs::path& path : paths) parts.emplace_back(path);
  std::sort(parts.begin(), parts.end(),
            [](const Pc2Reader& a, const Pc2Reader& b) { return a.start_frame() < b.start_frame(); });
  std::vector<int> frames;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].point_count() != parts[0].point_count()) {
      fail(parts[k].path(), "has " + std::to_string(parts[k].point_count()) + " points, and " +
                                parts[0].path().string() + " has " + std::to_string(parts[0].point_count()) +
                                ": caches of two meshes");
    }
    const std::vector<int> more = frames_of(parts[k]);
    if (k > 0 && !frames.empty() && !more.empty()) {
      require_apart(parts[k - 1].path(), frames.back(), parts[k].path(), more.front());
    }
    frames.insert(frames.end(), more.begin(), more.end());
  }
  Pc2Writer writer(out, parts[0].point_count(), static_cast<std::uint32_t>(frames.size()),
                   frames.empty() ? 1.0f : static_cast<float>(frames.front()), frame_spacing(frames));
  Progress progress("join", frames.size());
  for (const Pc2Reader& part : parts) {
    for (std::uint32_t k = 0; k < part.sample_count(); ++k) {
      writer.append(part.sample(k));
      progress.advance();
    }
  }
  writer.close();
}

// A .usda that UsdaWriter wrote, line by line.
class UsdaPart {
 public:
  explicit UsdaPart(const fs::path& path) : path_(path), file_(path) {
    if (!file_) throw Error(ErrorKind::file, path.string() + ": cannot be read: no such file, or no permission?");
    while (next() && line_ != kUsdaPointSamples) {
      if (line_.starts_with(kUsdaLastFrame)) {
        last_frame_ = line_;
      } else if (!line_.starts_with("    startTimeCode = ")) {
        head_ += line_ + '\n';
      }
      (last_frame_.empty() ? before_ : after_) += line_ + '\n';
    }
    if (line_ != kUsdaPointSamples) refuse();
    samples_begin_ = file_.tellg();
    find_frames();
  }

  // Every line of the samples that stand after `opening`, in order.
  template <typename Take>
  void for_samples(const std::string& opening, const Take& take) {
    file_.clear();
    file_.seekg(samples_begin_);
    line_ = kUsdaPointSamples;
    while (line_ != opening) {
      if (!next()) refuse();
    }
    while (next() && line_ != kUsdaSamplesEnd) take(line_);
    if (line_ != kUsdaSamplesEnd) refuse();
  }

  const fs::path& path() const { return path_; }
  const std::string& head() const { return head_; }  // but for the range of frames
  // The text up to the samples, with another last frame.
  std::string opening(const std::string& last_frame) const {
    return before_ + last_frame + after_.substr(last_frame_.size());
  }
  const std::string& last_frame() const { return last_frame_; }
  const std::vector<int>& frames() const { return frames_; }
  // What stands between the samples of points and of normals; where there are none, what ends the file.
  const std::string& between() const { return between_; }
  bool has_normals() const { return has_normals_; }

 private:
  bool next() { return static_cast<bool>(std::getline(file_, line_)); }

  [[noreturn]] void refuse() const {
    throw Error(ErrorKind::file, path_.string() +
                                     ": is no .usda that 'bodyopt eval' wrote, or is damaged or cut off: only such can "
                                     "be joined");
  }

  void find_frames() {
    for_samples(kUsdaPointSamples, [&](const std::string& line) {
      int frame = 0;
      const std::size_t begin = line.find_first_not_of(' ');
      if (begin == std::string::npos) refuse();
      const auto [stop, failure] = std::from_chars(line.data() + begin, line.data() + line.size(), frame);
      if (failure != std::errc() || !std::string_view(stop).starts_with(": [") || !line.ends_with("],")) refuse();
      if (!frames_.empty() && frame <= frames_.back()) refuse();
      frames_.push_back(frame);
    });
    if (frames_.empty()) refuse();
    between_ = std::string(kUsdaSamplesEnd) + '\n';
    while (next() && line_ != kUsdaNormalSamples) between_ += line_ + '\n';
    has_normals_ = line_ == kUsdaNormalSamples;
    if (!has_normals_ && !between_.ends_with("}\n}\n")) refuse();
  }

  fs::path path_;
  std::ifstream file_;
  std::string line_, head_, before_, after_, last_frame_, between_;
  std::streampos samples_begin_;
  std::vector<int> frames_;
  bool has_normals_ = false;
};

void join_usda(const std::vector<fs::path>& paths, const fs::path& out) {
  std::vector<UsdaPart> parts;
  for (const fs::path& path : paths) parts.emplace_back(path);
  std::sort(parts.begin(), parts.end(), [](const UsdaPart& a, const UsdaPart& b) { return a.frames() < b.frames(); });
  std::size_t frames = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].head() != parts[0].head() || parts[k].between() != parts[0].between()) {
      fail(parts[k].path(), "is of another mesh or frame rate than " + parts[0].path().string());
    }
    if (k > 0) {
      require_apart(parts[k - 1].path(), parts[k - 1].frames().back(), parts[k].path(), parts[k].frames().front());
    }
    frames += parts[k].frames().size();
  }
  AtomicFile file(out);
  const auto write = [&](const std::string& text) { file.write(std::as_bytes(std::span(text))); };
  Progress progress("join", 2 * frames);
  const auto write_samples = [&](const std::string& opening) {
    write(opening + '\n');
    for (UsdaPart& part : parts) {
      part.for_samples(opening, [&](const std::string& line) {
        write(line + '\n');
        progress.advance();
      });
    }
  };
  write(parts.front().opening(parts.back().last_frame()));
  write_samples(kUsdaPointSamples);
  write(parts.front().between());
  if (parts.front().has_normals()) {
    write_samples(kUsdaNormalSamples);
    write(std::string(kUsdaSamplesEnd) + "\n}\n");
  }
  file.commit();
}

}  // namespace

void join_caches(const std::vector<fs::path>& parts, const fs::path& out) {
  if (parts.empty()) throw Error(ErrorKind::usage, out.string() + ": there are no parts to join");
  for (const fs::path& part : parts) {
    if (part.extension() == out.extension()) continue;
    fail(part, "and " + out.string() + " are of different formats: parts and whole are all .pc2 or all .usda");
  }
  if (out.extension() == ".usda") {
    join_usda(parts, out);
  } else {
    join_pc2(parts, out);
  }
}

}  // namespace bodyopt
