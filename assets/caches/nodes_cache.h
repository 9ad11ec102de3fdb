// Shapes of a draft: the nodes of a coarse cage per frame, in 16 bits, and the skin embedded in it.
#pragma once

#include <filesystem>
#include <vector>

#include "geometry/tet_mesh.h"
#include "runtime/basis/safetensors.h"

namespace bodyopt {

// A safetensors file. Tensors tets (U32, T x 4), skin.tet (U32, P) and skin.weights (F64, P x 4) tell where each output
// vertex lies. Tensor bounds (F64, S x 6) has the lowest and highest x, y, z of a sample's nodes, metres. Tensor nodes
// (U16, S x N x 3) is 0 at the lowest, 65535 at the highest. A coordinate is off by 1/131070 of its sample's extent at
// most: 14 um for 1.8 m. Metadata: schema, checksum, inputs (body_hash), start_frame, frame_spacing (as PC2's sample
// rate).
class NodesWriter {
 public:
  NodesWriter(std::filesystem::path path, const Tets& tets, const std::vector<EmbeddedPoint>& skin,
              std::uint64_t inputs, const std::vector<int>& frames);
  void append(const Positions& nodes);  // N x 3; as many for every sample
  // Writes the file. Throws Error(file).
  void close();

 private:
  std::filesystem::path path_;
  Safetensors file_;
  std::vector<double> bounds_;
  std::vector<std::uint16_t> nodes_;
  std::uint64_t node_count_ = 0;
};

class NodesReader {
 public:
  // Throws Error(file) when the bytes are wrong.
  explicit NodesReader(const std::filesystem::path& path);

  std::uint32_t point_count() const { return static_cast<std::uint32_t>(skin_.size()); }
  std::uint32_t sample_count() const { return samples_; }
  Eigen::Index node_count() const { return node_count_; }
  const Tets& tets() const { return tets_; }
  float start_frame() const { return start_frame_; }
  float sample_rate() const { return sample_rate_; }  // frames from one sample to the next

  Positions nodes(std::uint32_t k) const;  // N x 3, metres
  // Sample k of the skin, point_count x 3: the same bits every time.
  std::vector<float> sample(std::uint32_t k) const;

 private:
  std::filesystem::path path_;
  Tets tets_;
  std::vector<EmbeddedPoint> skin_;
  std::vector<double> bounds_;
  std::vector<std::uint16_t> nodes_;
  std::uint32_t samples_ = 0;
  Eigen::Index node_count_ = 0;
  float start_frame_ = 0, sample_rate_ = 1;
};

}  // namespace bodyopt
