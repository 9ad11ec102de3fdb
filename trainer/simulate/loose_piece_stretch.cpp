#include "trainer/simulate/loose_piece_stretch.h"

#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/core/text.h"

namespace bodyopt::trainer {

LoosePieceStretch::LoosePieceStretch(const Character& character, const std::vector<std::uint32_t>& riding)
    : character_(character) {
  constexpr double kSliver = 0.05;  // of the mean edge: shorter ones stretch unseen
  if (riding.empty()) return;
  const double least = kSliver * bodyopt::mean_edge(character.vertices, character.triangles);
  std::vector<bool> rides(static_cast<std::size_t>(character.vertices.rows()), false);
  for (const std::uint32_t v : riding) rides[v] = true;
  for_each_edge(character.triangles, [&](std::uint32_t a, std::uint32_t b) {
    const double length = (character.vertices.row(a) - character.vertices.row(b)).norm();
    if ((!rides[a] && !rides[b]) || length < least) return;
    edges_.emplace_back(a, b);
    length_.push_back(length);
  });
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
  const auto vertex = [&](std::uint32_t v) {
    return std::to_string(character_.first_output(v)) + " ('" +
           character_.skeleton.joints[character_.weights[v].front().joint].name + "')";
  };
  return "a loose piece that follows the skin is stretched to " + formatted("%.1f", most_) +
         " times its length in frame " + std::to_string(frame_) + ", between the vertices " + vertex(a) + " and " +
         vertex(b) + ": it follows its own joints; paint its weights more evenly";
}

}  // namespace bodyopt::trainer
