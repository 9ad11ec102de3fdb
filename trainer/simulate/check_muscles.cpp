#include "trainer/simulate/check_muscles.h"

#include <algorithm>

#include "runtime/basis/error.h"
#include "trainer/anatomy/skin_depth.h"
#include "trainer/dataset/notes.h"

namespace bodyopt {

std::string check_muscles(const Character& character, const std::vector<Muscle>& muscles,
                          const std::vector<FibreTet>& fibres) {
  std::vector<bool> fills(muscles.size(), false);
  for (const FibreTet& fibre : fibres) fills[static_cast<std::size_t>(fibre.muscle)] = true;
  const anatomy::SkinDepth depth(character.vertices, character.triangles);
  std::vector<std::string> thin;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (fills[m]) continue;
    const auto outside = [&](const MusclePoint& point) { return depth(Eigen::Vector3d(point.position.data())) < 0; };
    if (std::all_of(muscles[m].path.begin(), muscles[m].path.end(), outside)) {
      throw Error(ErrorKind::mismatch,
                  "the muscle '" + muscles[m].name +
                      "' lies outside the skin: muscles of another character, or in another unit?");
    }
    thin.push_back(muscles[m].name);
  }
  if (thin.empty()) return "";
  return std::to_string(thin.size()) +
         " muscles are too thin to fill a tetrahedron and do nothing: " + list_names(thin) +
         "; a smaller --tet-size shows more of them";
}

}  // namespace bodyopt
