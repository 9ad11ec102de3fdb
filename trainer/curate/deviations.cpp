#include "trainer/curate/deviations.h"

#include "base/parallel.h"
#include "base/progress.h"

namespace bodyopt {

using Eigen::Index;

Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models) {
  const std::vector<std::uint32_t>& vertices = part.region.vertices;
  Displacements result = Displacements::Zero(displacements.rows(), 3 * static_cast<Index>(vertices.size()));
  parallel_for(models.shares.size(), [&](std::size_t n) {
    if (models.shares[n].empty()) return;
    for (const FrameShare& other : models.shares[n]) {
      const float share = static_cast<float>(other.share);
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        result.row(static_cast<Index>(n)).segment<3>(3 * static_cast<Index>(k)) +=
            share * displacements.row(static_cast<Index>(other.frame)).segment<3>(3 * Index{vertices[k]});
      }
    }
  });
  return result;
}

Displacements all_displacements(const PoseDatabase& database, const std::string& title,
                                const std::function<Positions(std::size_t frame)>& offsets) {
  Displacements displacements(static_cast<Index>(database.frames.size()), 3 * database.character.vertices.rows());
  Progress progress(title, database.frames.size());
  parallel_for(database.frames.size(), [&](std::size_t n) {
    const Positions own = offsets(n);
    displacements.row(static_cast<Index>(n)) =
        Eigen::Map<const Eigen::RowVectorXd>(own.data(), own.size()).cast<float>();
    progress.advance();
  });
  return displacements;
}

}  // namespace bodyopt
