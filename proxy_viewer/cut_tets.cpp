#include "proxy_viewer/cut_tets.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace bodyopt {
namespace {

constexpr std::array<float, 3> kSkin = {0.545f, 0.500f, 0.440f}, kFat = {0.78f, 0.56f, 0.20f},
                               kMuscle = {0.50f, 0.065f, 0.05f};

// Corners of the face opposite each corner, outward where the volume is positive.
constexpr std::uint32_t kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

std::vector<bool> tets_of_muscles(const Dynamics& dynamics) {
  std::vector<bool> is_muscle;
  for (std::uint32_t t = 0; t < dynamics.tets.tet_count(); ++t) {
    int count = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      count += dynamics.jiggle.nodes[dynamics.tets.tets[4 * t + k]].fibre_count > 0 ? 1 : 0;
    }
    is_muscle.push_back(count >= 3);
  }
  return is_muscle;
}

}  // namespace

TetCutter::TetCutter(std::span<const std::uint32_t> tets, std::vector<bool> is_muscle)
    : tets_(tets.begin(), tets.end()), is_muscle_(std::move(is_muscle)), neighbours_(tets.size(), -1) {
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
    std::vector<std::uint32_t>& into = neighbour < 0 ? faces.skin : is_muscle_[tet] ? faces.muscle : faces.fat;
    for (const std::uint32_t corner : kFaces[f % 4]) into.push_back(tets_[4 * tet + corner]);
  }
  return faces;
}

CutTets::CutTets(const vulkan::Device& device, const Dynamics& dynamics)
    : device_(device), cutter_(dynamics.tets.tets, tets_of_muscles(dynamics)) {}

void CutTets::cut(std::vector<float> nodes, const Vec3& towards, double share) {
  if (share == share_ && towards == towards_ && nodes == nodes_) return;
  nodes_ = std::move(nodes);
  towards_ = towards;
  share_ = share;
  positions_ = vulkan::upload(device_, nodes_, "nodes of the tets");
  parts_.clear();
  const CutFaces faces = cutter_.cut(nodes_, towards, share);
  for (const auto& [triangles, colour] :
       {std::pair{&faces.skin, kSkin}, std::pair{&faces.fat, kFat}, std::pair{&faces.muscle, kMuscle}}) {
    if (triangles->empty()) continue;
    parts_.push_back({vulkan::upload(device_, *triangles, "faces of the tets"),
                      static_cast<std::uint32_t>(triangles->size() / 3), colour});
  }
}

}  // namespace bodyopt
