// PC2 point caches (3ds Max, Blender, Houdini): header "POINTCACHE2\0", int32 version 1, int32 points, float start
// frame, float sample rate, int32 samples; then samples x points x 3 little-endian floats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace bodyopt {

// Memory-mapped reader. Throws Error(file) when the header or the size is wrong.
class Pc2Reader {
 public:
  explicit Pc2Reader(const std::filesystem::path& path);
  ~Pc2Reader();
  Pc2Reader(Pc2Reader&&) noexcept;
  Pc2Reader& operator=(Pc2Reader&&) noexcept;

  std::uint32_t point_count() const;
  std::uint32_t sample_count() const;
  float start_frame() const;
  float sample_rate() const;
  // Sample k: point_count x 3, metres. Valid while the reader lives. Not checked for NaN (see require_finite).
  std::span<const float> sample(std::uint32_t k) const;
  // Throws Error(file) naming sample and point when sample k holds a NaN or infinity.
  void require_finite(std::uint32_t k) const;
  // Sample k of a file that may be written anew meanwhile: not by the mapping, which would be fatal where the file was
  // cut off. Throws Error(file) where it was, and as require_finite().
  std::vector<float> read_sample(std::uint32_t k) const;

 private:
  struct Mapping;
  Mapping* mapping_;
};

// Writes to a temporary name; close() checks the count and renames. Destroying it before leaves nothing behind.
class Pc2Writer {
 public:
  Pc2Writer(const std::filesystem::path& path, std::uint32_t point_count, std::uint32_t sample_count,
            float start_frame = 1, float sample_rate = 1);
  ~Pc2Writer();
  Pc2Writer(const Pc2Writer&) = delete;
  Pc2Writer& operator=(const Pc2Writer&) = delete;

  void append(std::span<const float> sample);  // point_count x 3
  void close();

 private:
  struct File;
  File* file_;
};

// The sample rate of a cache of these frames: frames from one sample to the next; 1 where they are not evenly spaced.
float frame_spacing(const std::vector<int>& frames);

}  // namespace bodyopt
