#include "trainer/simulate/check_muscles.h"

#include "assets/wording.h"
#include "geometry/skin_depth.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Whether any of a muscle's path lies under the skin. Between its points, too: both ends may stick out of a limb.
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
  std::vector<int> tets(muscles.size(), 0);
  std::vector<double> share(muscles.size(), 0);
  for (const FibreTet& fibre : body.fibres()) {
    ++tets[static_cast<std::size_t>(fibre.muscle)];
    share[static_cast<std::size_t>(fibre.muscle)] += fibre.share;
  }
  std::vector<std::string> thin;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (tets[m] == 1 && share[m] < 1) thin.push_back(muscles[m].name);
  }
  if (thin.empty()) return "";
  // All of them: each is to be made thicker or left out.
  return count_of(thin.size(), "muscle is thinner than the tetrahedra and pulls in one of them alone: ",
                  "muscles are thinner than the tetrahedra and pull in one of them alone: ") +
         list_names(thin, thin.size()) + (body.is_cage() ? "" : "; a smaller --tet-size may help");
}

}  // namespace bodyopt
