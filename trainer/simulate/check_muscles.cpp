#include "trainer/simulate/check_muscles.h"

#include "base/wording.h"
#include "geometry/thickness.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

// Whether any of a muscle's path lies under the skin, also between its points: both ends may stick out of a limb.
bool reaches_inside(const Muscle& muscle, const SkinDepth& depth) {
  constexpr int kParts = 8;  // of the way from a point to the next
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    const Eigen::Vector3d from(muscle.path[k].position.data()), to(muscle.path[k + 1].position.data());
    for (int part = 0; part <= kParts; ++part) {
      if (depth(from + static_cast<double>(part) / kParts * (to - from)) > 0) return true;
    }
  }
  return false;
}

}  // namespace

std::string check_muscles(const Character& character, const std::vector<Muscle>& muscles, const QuasiStaticBody& body) {
  const SkinDepth depth(character.vertices, character.triangles);
  for (const Muscle& muscle : muscles) {
    if (reaches_inside(muscle, depth)) continue;
    throw Error(ErrorKind::mismatch, "the muscle '" + muscle.name +
                                         "' lies outside the skin: muscles of another character, or in another unit?");
  }
  std::vector<bool> has_room(muscles.size(), false);
  for (const FibreTet& fibre : body.tissue().fibres) has_room[static_cast<std::size_t>(fibre.muscle)] = true;
  std::vector<std::string> without;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (!has_room[m]) without.push_back(muscles[m].name);
  }
  if (without.empty()) return "";
  // All of them: each is to be made thicker or left out.
  return count_of(without.size(), "muscle finds no room in the body and pulls nothing: ",
                  "muscles find no room in the body and pull nothing: ") +
         list_names(without, without.size());
}

}  // namespace bodyopt::trainer
