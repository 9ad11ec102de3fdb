// Shapes of any kind of cache, by the ending of its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

namespace bodyopt {

class NodesReader;
class Pc2Reader;

// `.nodes`: a draft (nodes_cache.h); anything else: PC2 or MDD (pc2.h).
class ShapeReader {
 public:
  // Throws Error(file).
  explicit ShapeReader(const std::filesystem::path& path);
  ShapeReader(ShapeReader&&) noexcept;
  ~ShapeReader();

  std::uint32_t point_count() const;
  std::uint32_t sample_count() const;
  float start_frame() const;
  float sample_rate() const;  // frames from one sample to the next
  // Sample k: point_count x 3, metres. Throws Error(file) naming sample and point at a NaN or infinity.
  std::vector<float> sample(std::uint32_t k) const;

 private:
  std::unique_ptr<const std::variant<Pc2Reader, NodesReader>> reader_;
};

}  // namespace bodyopt
