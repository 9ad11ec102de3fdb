// The jiggle's tetrahedra, cut open: whole tets are removed on the camera's side. The faces behind them have the
// colours of fat, muscle and what is held.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/core/transform.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt {
struct Dynamics;
}

namespace bodyopt::viewport {

// held: by springs that leave no corner room to jiggle: bone, what counts as bone by its depth, what jiggle.json holds.
enum class TetKind { fat, muscle, held };

// Linear RGB.
std::array<float, 3> cut_colour(TetKind kind);

// T: of every tet.
std::vector<TetKind> kinds_of(const Dynamics& dynamics);

// Triangles, T x 3 nodes each, outward.
struct CutFaces {
  std::vector<std::uint32_t> skin;                   // of the body's surface
  std::array<std::vector<std::uint32_t>, 3> inside;  // that the cut lays bare, by kind
};

// Keeps the tets that are not among the nearest `share` (0: none, 1: all) of the body's depth along `towards`.
class TetCutter {
 public:
  // T x 4, positive volume; T.
  TetCutter(std::span<const std::uint32_t> tets, std::vector<TetKind> kinds);
  CutFaces cut(std::span<const float> nodes, const Vec3& towards, double share) const;

 private:
  std::vector<std::uint32_t> tets_;
  std::vector<TetKind> kinds_;
  std::vector<std::int64_t> neighbours_;  // T x 4: the tet across the face that is opposite each corner; -1: none
};

class CutTets {
 public:
  struct Part {
    vulkan::Buffer triangles;
    std::uint32_t triangle_count = 0;
    std::array<float, 3> colour{};  // linear RGB
  };

  CutTets(const vulkan::Device& device, const Dynamics& dynamics);

  // Nodes N x 3, metres, world. The same as the last time is not cut again.
  void cut(std::vector<float> nodes, const Vec3& towards, double share);

  const vulkan::Buffer& positions() const { return positions_; }
  const std::vector<Part>& parts() const { return parts_; }

 private:
  void add_part(const std::vector<std::uint32_t>& triangles, const std::array<float, 3>& colour);

  const vulkan::Device& device_;
  TetCutter cutter_;
  std::vector<float> nodes_;
  Vec3 towards_{};
  double share_ = -1;
  vulkan::Buffer positions_;
  std::vector<Part> parts_;
};

}  // namespace bodyopt::viewport
