// PC2 point caches (3ds Max, Blender, Houdini) have the header "POINTCACHE2\0", int32 version 1, int32 points, float
// start frame, float sample rate, int32 samples. Then come samples x points x 3 little-endian floats. The ending .mdd
// means MDD point caches (LightWave, Blender), big-endian: int32 samples, int32 points, the samples' times in seconds.
// Then come samples x points x 3 floats. They do not number their frames: the first counts as 1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "runtime/core/atomic_file.h"

namespace bodyopt {

// Keeps the file open: one that is replaced meanwhile is read to its end as it was. It is not mapped, which would be
// fatal where the file is cut off. Throws Error(file) when the header or the size is wrong.
class Pc2Reader {
 public:
  explicit Pc2Reader(const std::filesystem::path& path);
  ~Pc2Reader();
  Pc2Reader(Pc2Reader&&) noexcept;
  Pc2Reader& operator=(Pc2Reader&&) noexcept;

  const std::filesystem::path& path() const;
  std::uint32_t point_count() const;
  std::uint32_t sample_count() const;
  float start_frame() const;
  float sample_rate() const;
  // Sample k: point_count x 3, metres. Any thread may read. Throws Error(file) naming sample and point at a NaN or
  // infinity, and where the file was cut off.
  std::vector<float> sample(std::uint32_t k) const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

// How the points of a cache are written; here they are metres, Y up.
struct CacheSpace {
  double unit = 1;    // metres to a unit of the cache
  bool z_up = false;  // (x, y, z) is written as (x, -z, y)
  bool operator==(const CacheSpace&) const = default;
};

// Writes to a temporary name; close() checks the count and renames. Destroying it before leaves nothing behind. Numbers
// that are not finite are refused: Error(file). `fps`: of the times of MDD, which begin at 0.
class Pc2Writer {
 public:
  Pc2Writer(const std::filesystem::path& path, std::uint32_t point_count, std::uint32_t sample_count,
            float start_frame = 1, float sample_rate = 1, const CacheSpace& space = {}, double fps = 24);

  void append(std::span<const float> sample);  // point_count x 3, metres, Y up
  void close();

  // Puts the samples so far aside as a file, instead of close(). A new writer of the same header takes them up as its
  // first samples. The file's header is that of the whole.
  void put_aside(const std::filesystem::path& file);
  void take_up(const std::filesystem::path& file, std::uint32_t samples);

 private:
  std::filesystem::path path_;
  CacheSpace space_;
  std::size_t stride_;
  std::uint32_t expected_, written_ = 0;
  AtomicFile out_;
};

// The sample rate of a cache of these frames: frames from one sample to the next; 1 where they are not evenly spaced.
float frame_spacing(const std::vector<int>& frames);

}  // namespace bodyopt
