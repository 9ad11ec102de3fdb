#include "trainer/simulate/loose_piece_stretch.h"

#include <algorithm>
#include <cstdio>

#include "geometry/mend_surface.h"

namespace bodyopt::trainer {

LoosePieceStretch::LoosePieceStretch(const Character& character, const std::vector<std::uint32_t>& riding)
    : character_(character) {
  constexpr double kSliver = 0.05;  // of the mean edge: shorter ones stretch unseen
  const double least = riding.empty() ? 0 : kSliver * bodyopt::mean_edge(character.vertices, character.triangles);
  std::vector<bool> rides(static_cast<std::size_t>(character.vertices.rows()), false);
  for (const std::uint32_t v : riding) rides[v] = true;
  for (Eigen::Index t = 0; t < character.triangles.rows() && !riding.empty(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = character.triangles(t, k), b = character.triangles(t, (k + 1) % 3);
      const double length = (character.vertices.row(a) - character.vertices.row(b)).norm();
      if ((!rides[a] && !rides[b]) || length < least) continue;
      edges_.emplace_back(a, b);
      length_.push_back(length);
    }
  }
}

void LoosePieceStretch::add(int frame, const Positions& skin) {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const double stretch = (skin.row(edges_[e].first) - skin.row(edges_[e].second)).norm() / length_[e];
    if (stretch <= most_) continue;
    most_ = stretch;
    edge_ = e;
    frame_ = frame;
  }
}

std::string LoosePieceStretch::warning() const {
  if (most_ <= kMost) return "";
  const auto [a, b] = edges_[edge_];
  const auto in_file = [&](std::uint32_t v) {
    const auto& output = character_.output_vertex;
    return std::to_string(std::find(output.begin(), output.end(), v) - output.begin());
  };
  const auto joint = [&](std::uint32_t v) {
    return "'" + character_.skeleton.joints[character_.weights[v].front().joint].name + "'";
  };
  char stretch[16];
  std::snprintf(stretch, sizeof(stretch), "%.1f", most_);
  return "a loose piece that follows the skin is stretched to " + std::string(stretch) + " times its length in frame " +
         std::to_string(frame_) + ", between the vertices " + in_file(a) + " (" + joint(a) + ") and " + in_file(b) +
         " (" + joint(b) + "): it follows its own joints; paint its weights more evenly";
}

}  // namespace bodyopt::trainer
