#include "viewport/scene/cut_tets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "draw/view.h"
#include "runtime/basis/dynamics.h"

namespace bodyopt::viewport {
namespace {

constexpr std::array<float, 3> kSkin = draw::kClayColour;
// Fat, muscle, held.
constexpr std::array<float, 3> kTetColours[] = {{0.78f, 0.56f, 0.20f}, {0.50f, 0.065f, 0.05f}, {0.80f, 0.78f, 0.70f}};

// Hz: what springs alone would swing faster than that is held. Those of bones are near 160 Hz, of what jiggle.json
// holds 30 Hz; flesh swings at some 3 Hz.
constexpr double kHeldAbove = 20;

// Corners of the face opposite each corner, outward where the volume is positive.
constexpr std::uint32_t kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// N.
std::vector<bool> held_nodes(const JiggleTable& jiggle) {
  const double held_above = std::pow(2 * std::numbers::pi * kHeldAbove, 2);
  std::vector<bool> held;
  for (std::size_t n = 0; n < jiggle.nodes.size(); ++n) {
    held.push_back(double{jiggle.springs[n]} > held_above * double{jiggle.nodes[n].mass});
  }
  return held;
}

}  // namespace

std::vector<TetKind> kinds_of(const Dynamics& dynamics) {
  const std::vector<bool> held = held_nodes(dynamics.jiggle);
  std::vector<TetKind> kinds;
  for (std::uint32_t t = 0; t < dynamics.tets.tet_count(); ++t) {
    int held_corners = 0, of_muscles = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t n = dynamics.tets.tets[4 * t + k];
      held_corners += held[n] ? 1 : 0;
      of_muscles += dynamics.jiggle.nodes[n].fibre_count > 0 ? 1 : 0;
    }
    kinds.push_back(held_corners == 4 ? TetKind::held : of_muscles >= 3 ? TetKind::muscle : TetKind::fat);
  }
  return kinds;
}

TetCutter::TetCutter(std::span<const std::uint32_t> tets, std::vector<TetKind> kinds)
    : tets_(tets.begin(), tets.end()), kinds_(std::move(kinds)), neighbours_(tets.size(), -1) {
  std::map<std::array<std::uint32_t, 3>, std::size_t> seen;  // faces to the one of the two tets that came first
  for (std::size_t f = 0; f < neighbours_.size(); ++f) {
    std::array<std::uint32_t, 3> face;
    for (std::size_t k = 0; k < 3; ++k) face[k] = tets_[f / 4 * 4 + kFaces[f % 4][k]];
    std::ranges::sort(face);
    const auto [found, is_new] = seen.try_emplace(face, f);
    if (is_new) continue;
    neighbours_[f] = static_cast<std::int64_t>(found->second / 4);
    neighbours_[found->second] = static_cast<std::int64_t>(f / 4);
  }
}

CutFaces TetCutter::cut(std::span<const float> nodes, const Vec3& towards, double share) const {
  const std::size_t count = tets_.size() / 4;
  std::vector<double> depth(count);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const float* const at = nodes.data() + std::size_t{3} * tets_[4 * t + k];
      for (std::size_t i = 0; i < 3; ++i) depth[t] += 0.25 * static_cast<double>(at[i]) * towards[i];
    }
    low = std::min(low, depth[t]);
    high = std::max(high, depth[t]);
  }
  const double cut = high - share * (high - low);
  CutFaces faces;
  for (std::size_t f = 0; f < neighbours_.size(); ++f) {
    const std::size_t tet = f / 4;
    const std::int64_t neighbour = neighbours_[f];
    if (depth[tet] > cut || (neighbour >= 0 && depth[static_cast<std::size_t>(neighbour)] <= cut)) continue;
    auto& into = neighbour < 0 ? faces.skin : faces.inside[static_cast<std::size_t>(kinds_[tet])];
    for (const std::uint32_t corner : kFaces[f % 4]) into.push_back(tets_[4 * tet + corner]);
  }
  return faces;
}

std::array<float, 3> cut_colour(TetKind kind) { return kTetColours[static_cast<std::size_t>(kind)]; }

CutTets::CutTets(const vulkan::Device& device, const Dynamics& dynamics)
    : device_(device), cutter_(dynamics.tets.tets, kinds_of(dynamics)) {}

void CutTets::cut(std::vector<float> nodes, const Vec3& towards, double share) {
  if (share == share_ && towards == towards_ && nodes == nodes_) return;
  nodes_ = std::move(nodes);
  towards_ = towards;
  share_ = share;
  positions_ = vulkan::upload(device_, nodes_, "nodes of the tets");
  parts_.clear();
  const CutFaces faces = cutter_.cut(nodes_, towards, share);
  add_part(faces.skin, kSkin);
  for (std::size_t kind = 0; kind < faces.inside.size(); ++kind) {
    add_part(faces.inside[kind], cut_colour(static_cast<TetKind>(kind)));
  }
}

void CutTets::add_part(const std::vector<std::uint32_t>& triangles, const std::array<float, 3>& colour) {
  if (triangles.empty()) return;
  parts_.push_back({vulkan::upload(device_, triangles, "faces of the tets"),
                    static_cast<std::uint32_t>(triangles.size() / 3), colour});
}

}  // namespace bodyopt::viewport
