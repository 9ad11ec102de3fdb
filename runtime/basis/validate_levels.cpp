
#include "runtime/basis/levels.h"
#include "runtime/basis/table_checks.h"

namespace bodyopt {
namespace {

class LevelValidator : TableChecks {
 public:
  explicit LevelValidator(const std::string& origin) : TableChecks(origin) {}

  void check_count(std::size_t count) const {
    if (count >= 1 && count <= kMostLevels) return;
    refuse("it has ", count, " levels, expected 1 to ", kMostLevels);
  }

  void check_carried(const Level& level) const {
    const std::size_t triangles = level.basis.mesh.output_triangles.size() / 3;
    if (!(level.carried.step >= 0 && static_cast<double>(level.carried.step) * 32768 <= kLargest)) {
      refuse("carried.step is ", level.carried.step, " m, expected 0 to ", kLargest / 32768);
    }
    for (std::size_t k = 0; k < level.carried.size(); ++k) {
      const CarriedPoint& point = level.carried.points[k];
      if (point.triangle >= triangles) {
        refuse(element("carried.points", k), " lies on triangle ", point.triangle, ", expected an index below ",
               triangles);
      }
      if (point.b + point.c > 255) {
        refuse(element("carried.points", k), " has the barycentric weights ", point.b, " and ", point.c,
               " of 255, expected 255 at most in all");
      }
    }
  }

  // `first`: the finest level.
  void check_kinship(const Level& first, const Level& level) const {
    if (skeleton_hash(first.basis.skeleton) != skeleton_hash(level.basis.skeleton) ||
        first.basis.residual.controls != level.basis.residual.controls) {
      refuse("its skeleton or its controls are others than those of the first level");
    }
    if (first.carried.empty()) refuse("the first level does not say where it carries the full skin");
    expect_size("carried.points", level.carried.size(), first.carried.size());
  }
};

}  // namespace

void validate(const std::vector<Level>& levels, const std::string& origin) {
  LevelValidator(origin).check_count(levels.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const std::string where = k == 0 ? origin : origin + ", level " + std::to_string(k);
    const LevelValidator validator(where);
    validate(levels[k].basis, where);
    validator.check_carried(levels[k]);
    if (k > 0) validator.check_kinship(levels.front(), levels[k]);
  }
}

}  // namespace bodyopt
