#include <algorithm>
#include <cmath>

#include "trainer/anatomy/animal.h"

namespace bodyopt {
namespace {

// Shares of the body's size.
constexpr double kVertebra = 0.022, kProcess = 0.0022, kRib = 0.0035, kAxisCover = 0.002;
constexpr double kRibShare = 0.42;  // of the length that a rib and the gap beside it take

bool has_processes(BodyKind kind) { return kind != BodyKind::many_legs && kind != BodyKind::limb; }

// The bones of those rows of the spine that one joint holds.
class AxisPart {
 public:
  AxisPart(const Animal& animal, const AnimalCavity& cavity, double thickness, double from, double to)
      : animal_(animal), cavity_(cavity), thickness_(thickness), from_(from), to_(to) {}

  double operator()(const Spot& spot) const {
    constexpr double kNext = 4;  // rows: what is nearer to those belongs to the bones of another joint
    const SpineCurve::Spot at = animal_.spine.spot(spot.point, from_ - kNext, to_ + kNext);
    if (at.row < from_ || at.row > to_) return animal_.size;
    const SpineCurve::Row row = animal_.spine.at(at.row);
    const double height = at.height - (row.place - row.middle).dot(row.dorsal);
    double distance = vertebra(at, row, height);
    if (at.is_beyond()) return distance;
    if (has_processes(animal_.kind)) distance = std::min(distance, process(spot, at, row, height));
    if (!cavity_.empty() && at.row >= cavity_.chest_from() && at.row <= cavity_.to() && has_processes(animal_.kind))
      distance = std::min({distance, rib(spot, at, row), breastbone(at, row)});
    return distance;
  }

 private:
  double vertebra(const SpineCurve::Spot& at, const SpineCurve::Row& row, double height) const {
    return std::hypot(at.aside, height, at.beyond) - thickness_ * vertebra_radius(animal_, row);
  }

  // -1 to 1 along one of many equal pieces of the body's length.
  double in_piece(double along, double piece) const { return 2 * (along / piece - std::floor(along / piece)) - 1; }

  // From a vertebra to below the back; of fish also downwards, behind the gut.
  double process(const Spot& spot, const SpineCurve::Spot& at, const SpineCurve::Row& row, double height) const {
    const double piece = kVertebra * animal_.size;
    const double above = row.up - (row.place - row.middle).dot(row.dorsal), below = row.up + row.down - above;
    const bool reaches_down = animal_.kind == BodyKind::fish && at.row < cavity_.from();
    const double up = (at.row < animal_.spine.hip() ? 0.4 : 0.75) * above;
    const double off = height > 0 ? height - up : -height - (reaches_down ? 0.75 * below : 0);
    const double along = (std::abs(in_piece(row.along, piece)) - 0.5) * piece / 2;
    const double skin = spot.fat + 2 * kAxisCover * animal_.size - spot.depth;
    return std::max({off, at.aside - kProcess * thickness_ * animal_.size, along, skin});
  }

  // A shell about the chest, of which strips that slant backwards are rib.
  double rib(const Spot& spot, const SpineCurve::Spot& at, const SpineCurve::Row& row) const {
    const double thick = kRib * thickness_ * animal_.size, piece = kVertebra * animal_.size;
    const double shell = cavity_.distance(spot, at, thick / 2);
    const double slanted = row.along + 0.35 * (row.up - at.height);
    const double strip = (std::abs(in_piece(slanted, piece)) - kRibShare) * piece / 2;
    return std::max(std::abs(shell) - thick / 2, strip);
  }

  double breastbone(const SpineCurve::Spot& at, const SpineCurve::Row& row) const {
    if (animal_.kind == BodyKind::snake || animal_.kind == BodyKind::fish) return animal_.size;
    const double thick = 1.2 * kRib * thickness_ * animal_.size, wide = 2 * thick;
    const double floor = -row.down + (animal_.kind == BodyKind::bird ? 0.28 : 0.09) * (row.up + row.down);
    const double front = cavity_.chest_from() + 0.35 * (cavity_.to() - cavity_.chest_from()) - at.row;
    return std::max({std::abs(at.height - floor) - thick, at.aside - wide, front * kVertebra * animal_.size});
  }

  const Animal& animal_;
  const AnimalCavity& cavity_;
  double thickness_, from_, to_;
};

}  // namespace

std::vector<Bone> axis_bones(const Animal& animal, const AnimalCavity& cavity, double thickness) {
  std::vector<Bone> bones;
  const std::vector<SpineCurve::Row>& rows = animal.spine.rows();
  for (std::size_t first = 0; first + 1 < rows.size();) {
    std::size_t last = first + 1;
    while (last + 1 < rows.size() && rows[last].joint == rows[first].joint) ++last;
    const AxisPart part(animal, cavity, thickness, static_cast<double>(first), static_cast<double>(last));
    bones.push_back({rows[first].joint, kAxisCover * animal.size, part});
    first = last;
  }
  return bones;
}

std::vector<Bone> skull_bones(const Animal& animal) {
  constexpr double kOfHead = 0.42, kOfBody = 0.035;  // of the volume, at most
  int head = -1;
  for (int j = static_cast<int>(animal.chains.is_head.size()); j-- > 0;)
    head = animal.chains.is_head[static_cast<std::size_t>(j)] && animal.chains.has_skin(j) ? j : head;
  std::vector<double> deep;
  for (const Spot& spot : animal.survey.spots()) {
    if (spot.region == BodyRegion::head) deep.push_back(spot.depth - spot.fat);
  }
  if (head < 0 || deep.empty()) return {};
  const double most = std::min(kOfHead * static_cast<double>(deep.size()), kOfBody * animal.survey.grid().size());
  const auto edge = deep.end() - 1 - static_cast<std::ptrdiff_t>(most);
  std::nth_element(deep.begin(), edge, deep.end());
  const double over = std::max(*edge, 0.0), far = animal.size;
  return {{head, kAxisCover * animal.size, [over, far](const Spot& spot) {
             return spot.region == BodyRegion::head ? spot.fat + over - spot.depth : far;
           }}};
}

}  // namespace bodyopt
