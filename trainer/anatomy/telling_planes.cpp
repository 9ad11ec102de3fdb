#include "trainer/anatomy/telling_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace bodyopt {
namespace {

// Half space: a point, and which way the plane through it faces.
struct Cut {
  std::string name;
  Eigen::Vector3d at, normal;
  std::vector<BodyRegion> regions;  // that the picture is of; empty: all that is cut
};

// The samples in the regions of a cut that lie next to it.
std::vector<int> samples_at(const Cut& cut, const AnatomyField::Half& half) {
  std::vector<int> samples;
  for (int s = 0; s < half.grid.size(); ++s) {
    const BodyRegion region = half.tissue.region[static_cast<std::size_t>(s)];
    if (!cut.regions.empty() && std::ranges::find(cut.regions, region) == cut.regions.end()) continue;
    const Eigen::Vector3d point = half.grid.points.row(s);
    if (std::abs(cut.normal.dot(point - cut.at)) <= half.grid.cell) samples.push_back(s);
  }
  return samples;
}

std::size_t main_joint(const AnatomyField::Half& half, const std::vector<int>& samples) {
  std::vector<double> sums(half.body.places.size());
  for (const int s : samples) {
    const SkinPoint& skin = half.grid.skin[static_cast<std::size_t>(s)];
    for (int k = 0; k < 3; ++k) {
      for (const JointWeight& of : half.body.weights[skin.vertices[static_cast<std::size_t>(k)]]) {
        sums[of.joint] += skin.weights[k] * of.weight;
      }
    }
  }
  return static_cast<std::size_t>(std::ranges::max_element(sums) - sums.begin());
}

// Of a plane that lies flat the front is at the top of the picture and the left side at its right, as radiologists have
// it; of any other, what is above is at the top.
SectionPlane plane_of(const Cut& cut, const AnatomyField::Half& half, const std::vector<int>& samples, int pixels) {
  const bool is_flat = std::abs(cut.normal.y()) > 0.5;
  const Eigen::Vector3d up = is_flat ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d down = -(up - up.dot(cut.normal) * cut.normal).normalized();
  const Eigen::Vector3d right = cut.normal.cross(down);
  Eigen::AlignedBox2d box;
  for (const int s : samples) {
    const Eigen::Vector3d from_cut = half.grid.points.row(s).transpose() - cut.at;
    box.extend(Eigen::Vector2d(right.dot(from_cut), down.dot(from_cut)));
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d::Zero().eval());
  const bool goes_through_middle = cut.at.x() == 0 && half.body.has_plane && std::abs(cut.normal.x()) < 0.5;
  if (goes_through_middle) {  // the other half is its mirror image
    box.extend(Eigen::Vector2d(-box.max().x(), box.max().y()));
    box.extend(Eigen::Vector2d(-box.min().x(), box.max().y()));
  }
  const Eigen::Vector2d sides = box.sizes() + Eigen::Vector2d::Constant(4 * half.grid.cell);
  const Eigen::Vector3d middle = cut.at + box.center().x() * right + box.center().y() * down;
  const Eigen::Affine3d to_rest = half.body.from_rest.inverse();
  return plane_around(to_rest * middle, to_rest.linear() * right, to_rest.linear() * down, {sides.x(), sides.y()},
                      sides.maxCoeff() / pixels);
}

// Across a bone, a share of the way along it; nothing where a joint has no name that is known.
void add_across(const HalfBody& body, const Cut& pattern, BodyPart from, BodyPart to, double share,
                std::vector<Cut>& cuts) {
  const int first = body.find(from), last = body.find(to);
  if (first < 0 || last < 0) return;
  const Eigen::Vector3d along =
      body.places[static_cast<std::size_t>(last)] - body.places[static_cast<std::size_t>(first)];
  if (!(along.norm() > 0)) return;
  cuts.push_back(pattern);
  cuts.back().at = body.places[static_cast<std::size_t>(first)] + share * along;
  cuts.back().normal = along.normalized();
}

std::vector<Cut> human_cuts(const HalfBody& body) {
  std::vector<Cut> cuts;
  const auto across = [&](const char* name, BodyRegion region, BodyPart from, BodyPart to, double share) {
    add_across(body, {name, {}, {}, {region}}, from, to, share, cuts);
  };
  across("thigh", BodyRegion::thigh, BodyPart::thigh, BodyPart::shin, 0.5);
  across("calf", BodyRegion::calf, BodyPart::shin, BodyPart::foot, 0.3);
  const int hip = body.find(BodyPart::thigh), shoulder = body.find(BodyPart::upper_arm);
  if (hip >= 0 && shoulder >= 0) {
    const Eigen::Vector3d low = body.places[static_cast<std::size_t>(hip)],
                          high = body.places[static_cast<std::size_t>(shoulder)];
    // Shares of the way from the hip joints to the shoulders' height.
    constexpr std::pair<const char*, double> kLevels[] = {{"hip", 0}, {"loin (L3)", 0.32}, {"chest", 0.68}};
    for (const auto& [name, share] : kLevels) {
      const Eigen::Vector3d at = low + share * (high - low);
      cuts.push_back({name, {0, at.y(), at.z()}, -Eigen::Vector3d::UnitY(), {BodyRegion::trunk, BodyRegion::hip}});
    }
    cuts[cuts.size() - 3].regions.push_back(BodyRegion::thigh);
  }
  across("upper arm", BodyRegion::upper_arm, BodyPart::upper_arm, BodyPart::forearm, 0.5);
  across("forearm", BodyRegion::forearm, BodyPart::forearm, BodyPart::hand, 0.3);
  return cuts;
}

std::vector<Cut> cuts_along(const HalfBody& body) {
  constexpr int kCuts = 5;
  Eigen::AlignedBox3d box;
  for (const auto& vertex : body.vertices.rowwise()) box.extend(vertex.transpose());
  int longest = 0;
  Eigen::Vector3d sides = box.sizes();
  if (body.has_plane) sides.x() = 0;
  sides.maxCoeff(&longest);
  Eigen::Vector3d middle = box.center();
  if (body.has_plane) middle.x() = 0;
  std::vector<Cut> cuts;
  for (int k = 0; k < kCuts; ++k) {
    const double share = (k + 0.5) / kCuts;
    Eigen::Vector3d at = middle;
    at[longest] = box.max()[longest] - share * box.sizes()[longest];
    cuts.push_back({std::to_string(std::lround(100 * share)) + " %", at, -Eigen::Vector3d::Unit(longest), {}});
  }
  const int across = longest == 0 ? 2 : 0;
  cuts.push_back({"along the middle", middle, Eigen::Vector3d::Unit(across), {}});
  return cuts;
}

}  // namespace

std::vector<NamedPlane> telling_planes(const AnatomyField& field, int pixels) {
  const AnatomyField::Half& half = field.halves().front();
  std::vector<Cut> cuts;
  if (field.kind() == BodyKind::biped || field.kind() == BodyKind::limb) cuts = human_cuts(half.body);
  constexpr std::size_t kFewest = 3;  // fewer are of joints that are a human's by name alone, and tell little
  if (cuts.size() < kFewest) cuts = cuts_along(half.body);
  std::vector<NamedPlane> planes;
  for (const Cut& cut : cuts) {
    const std::vector<int> samples = samples_at(cut, half);
    planes.push_back({cut.name, plane_of(cut, half, samples, pixels), main_joint(half, samples)});
  }
  return planes;
}

}  // namespace bodyopt
