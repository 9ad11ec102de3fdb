#include "assets/caches/pc2.h"

#include <endian.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/text.h"

namespace bodyopt {

struct Pc2Header {
  char magic[12];
  std::int32_t version, points;
  float start_frame, sample_rate;
  std::int32_t samples;
};
static_assert(sizeof(Pc2Header) == 32);

namespace {

constexpr char kMagic[12] = "POINTCACHE2";

bool is_mdd(const std::filesystem::path& path) { return lower_case(path.extension().string()) == ".mdd"; }

[[noreturn]] void refuse(const std::filesystem::path& path, const auto&... what) {
  const char* kind = is_mdd(path) ? "an MDD" : "a PC2";
  throw Error(ErrorKind::file, path, ": ", what..., " (not ", kind, " point cache, or a damaged or cut-off one)");
}

void require_finite(const std::filesystem::path& path, std::uint32_t sample, std::span<const float> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw Error(ErrorKind::file, path, ": sample ", sample, ", point ", i / 3,
                " is not a finite number: did a simulation, or what it began from, blow up?");
  }
}

// Swaps between the machine's order of bytes and MDD's.
void swap_floats(std::span<float> values) {
  for (float& value : values) value = std::bit_cast<float>(be32toh(std::bit_cast<std::uint32_t>(value)));
}

}  // namespace

struct Pc2Reader::File {
  std::filesystem::path path;
  int descriptor = -1;
  std::uint64_t size = 0;
  Pc2Header header{};
  std::uint64_t begin = sizeof(Pc2Header);  // of the samples

  ~File() {
    if (descriptor >= 0) close(descriptor);
  }

  void open_file() {
    descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe must not block
    struct stat status {};
    if (descriptor < 0 || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
      throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
    }
    size = static_cast<std::uint64_t>(status.st_size);
  }

  void read(void* to, std::size_t bytes, std::uint64_t offset, const std::string& what) const {
    for (std::size_t done = 0; done < bytes;) {
      const ssize_t got =
          pread(descriptor, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got > 0) {
        done += static_cast<std::size_t>(got);
        continue;
      }
      const std::string reason = got < 0 ? std::strerror(errno) : "it ends before";
      throw Error(ErrorKind::file, path, ": ", what, " cannot be read: ", reason,
                  ": was the file cut off, or is it being written?");
    }
  }

  void require_header(std::size_t bytes) const {
    if (size < bytes) refuse(path, "it has ", size, " bytes, less than a header");
  }

  void read_pc2_header() {
    require_header(sizeof(Pc2Header));
    read(&header, sizeof(Pc2Header), 0, "the header");
    if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) {
      read_mdd_header();
      const std::string kind = holds_samples() ? "; it looks like an MDD point cache: call it .mdd" : looks_like(path);
      refuse(path, "it does not start with POINTCACHE2", kind);
    }
    if (header.version != 1) refuse(path, "its version is ", header.version, ", expected 1");
    if (!std::isfinite(header.start_frame) || !std::isfinite(header.sample_rate)) {
      refuse(path, "its start frame or sample rate is not a number");
    }
  }

  // Then come the times of the samples, in seconds: they do not tell a frame's number.
  void read_mdd_header() {
    std::uint32_t counts[2];
    require_header(sizeof(counts));
    read(counts, sizeof(counts), 0, "the header");
    header.samples = static_cast<std::int32_t>(be32toh(counts[0]));
    header.points = static_cast<std::int32_t>(be32toh(counts[1]));
    header.start_frame = header.sample_rate = 1;
    begin = sizeof(counts) + sizeof(float) * std::uint64_t{static_cast<std::uint32_t>(header.samples)};
  }

  void check() {
    is_mdd(path) ? read_mdd_header() : read_pc2_header();
    const std::string kind = is_mdd(path) ? looks_like(path) : "";  // which has no mark at its beginning
    if (header.points < 1 || header.samples < 0) {
      refuse(path, "it claims ", header.samples, " samples of ", header.points,
             " points, expected 0 or more samples of 1 or more points", kind);
    }
    if (!holds_samples()) {
      refuse(path, header.samples, " samples of ", header.points, " points take 12 bytes a point, found ",
             size - std::min(size, begin), " bytes after the header", kind);
    }
  }

  bool holds_samples() const {
    // Below 2^62 values; the bytes they take may not fit 64 bits, so the file's are divided instead.
    const std::uint64_t values = static_cast<std::uint64_t>(header.points) * static_cast<std::uint64_t>(header.samples);
    return header.points > 0 && header.samples >= 0 && size >= begin && (size - begin) % 12 == 0 &&
           (size - begin) / 12 == values;
  }
};

Pc2Reader::Pc2Reader(const std::filesystem::path& path) : file_(std::make_unique<File>()) {
  file_->path = path;
  file_->open_file();
  file_->check();
}

Pc2Reader::~Pc2Reader() = default;
Pc2Reader::Pc2Reader(Pc2Reader&&) noexcept = default;
Pc2Reader& Pc2Reader::operator=(Pc2Reader&&) noexcept = default;

const std::filesystem::path& Pc2Reader::path() const { return file_->path; }
std::uint32_t Pc2Reader::point_count() const { return static_cast<std::uint32_t>(file_->header.points); }
std::uint32_t Pc2Reader::sample_count() const { return static_cast<std::uint32_t>(file_->header.samples); }
float Pc2Reader::start_frame() const { return file_->header.start_frame; }
float Pc2Reader::sample_rate() const { return file_->header.sample_rate; }

std::vector<float> Pc2Reader::sample(std::uint32_t k) const {
  if (k >= sample_count()) {
    throw Error(ErrorKind::mismatch, file_->path, ": sample ", k, " was asked for, it has ", sample_count());
  }
  std::vector<float> values(3 * std::size_t{point_count()});
  const std::size_t bytes = sizeof(float) * values.size();
  file_->read(values.data(), bytes, file_->begin + std::uint64_t{k} * bytes, "sample " + std::to_string(k));
  if (is_mdd(file_->path)) swap_floats(values);
  require_finite(file_->path, k, values);
  return values;
}

namespace {

// The header's counts are 32 bits with a sign.
std::uint32_t checked_count(const std::filesystem::path& path, std::uint32_t count, std::uint32_t least,
                            const char* what) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
  if (count >= least && count <= kMost) return count;
  throw Error(ErrorKind::file, path, ": cannot be written: it would have ", count, ' ', what, ", a PC2 cache holds ",
              least, " to ", kMost);
}

void write_mdd_header(AtomicFile& out, std::uint32_t points, std::uint32_t samples, double seconds) {
  std::vector<std::uint32_t> words{htobe32(samples), htobe32(points)};
  for (std::uint32_t k = 0; k < samples; ++k) {
    words.push_back(htobe32(std::bit_cast<std::uint32_t>(static_cast<float>(k * seconds))));
  }
  out.write(std::as_bytes(std::span(words)));
}

std::vector<float> in_space(std::span<const float> points, const CacheSpace& space) {
  const auto in_units = [&](float metres) { return static_cast<float>(static_cast<double>(metres) / space.unit); };
  std::vector<float> result;
  for (std::size_t k = 0; k + 2 < points.size(); k += 3) {
    const float x = in_units(points[k]), y = in_units(points[k + 1]), z = in_units(points[k + 2]);
    if (space.z_up) {
      result.insert(result.end(), {x, -z, y});
    } else {
      result.insert(result.end(), {x, y, z});
    }
  }
  return result;
}

}  // namespace

Pc2Writer::Pc2Writer(const std::filesystem::path& path, std::uint32_t point_count, std::uint32_t sample_count,
                     float start_frame, float sample_rate, const CacheSpace& space, double fps)
    : path_(path),
      space_(space),
      stride_(3 * std::size_t{checked_count(path, point_count, 1, "points")}),
      expected_(checked_count(path, sample_count, 0, "samples")),
      out_(path) {
  if (is_mdd(path)) {
    write_mdd_header(out_, point_count, sample_count, static_cast<double>(sample_rate) / fps);
    return;
  }
  Pc2Header header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.version = 1;
  header.points = static_cast<std::int32_t>(point_count);
  header.samples = static_cast<std::int32_t>(sample_count);
  header.start_frame = start_frame;
  header.sample_rate = sample_rate;
  out_.write(std::as_bytes(std::span(&header, 1)));
}

void Pc2Writer::append(std::span<const float> sample) {
  if (sample.size() != stride_) {
    throw Error(ErrorKind::mismatch, path_, ": a sample of ", sample.size() / 3, " points was given to a cache of ",
                stride_ / 3);
  }
  if (written_ == expected_) {
    throw Error(ErrorKind::mismatch, path_, ": more than the ", expected_, " samples it was opened for were given");
  }
  const bool as_it_is = space_.unit == 1 && !space_.z_up;
  std::vector<float> changed = as_it_is ? std::vector<float>() : in_space(sample, space_);
  std::span<const float> written = as_it_is ? sample : changed;
  require_finite(path_, written_, written);
  if (is_mdd(path_)) {
    if (as_it_is) changed.assign(sample.begin(), sample.end());
    swap_floats(changed);
    written = changed;
  }
  out_.write(std::as_bytes(written));
  ++written_;
}

void Pc2Writer::close() {
  if (written_ != expected_) {
    throw Error(ErrorKind::file, path_, ": ", written_, " of ", expected_, " samples were given; nothing is written");
  }
  out_.commit();
}

void Pc2Writer::put_aside(const std::filesystem::path& file) { out_.put_aside(file); }

void Pc2Writer::take_up(const std::filesystem::path& file, std::uint32_t samples) {
  out_.restart();
  out_.write_file(file);
  written_ = samples;
}

float frame_spacing(const std::vector<int>& frames) {
  if (frames.size() < 2) return 1;
  const int step = frames[1] - frames[0];
  for (std::size_t k = 2; k < frames.size(); ++k) {
    if (frames[k] - frames[k - 1] != step) return 1;
  }
  return step > 0 ? static_cast<float>(step) : 1;
}

}  // namespace bodyopt
