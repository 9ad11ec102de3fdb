#include "trainer/curate/deviations.h"

#include "base/parallel.h"
#include "base/progress.h"

namespace bodyopt {

using Eigen::Index;

Eigen::RowVectorXf frame_deviation(const Displacements& displacements, const SkinPart& part,
                                   const std::vector<FrameShare>& shares) {
  const std::vector<std::uint32_t>& vertices = part.region.vertices;
  Eigen::RowVectorXf result = Eigen::RowVectorXf::Zero(3 * static_cast<Index>(vertices.size()));
  for (const FrameShare& other : shares) {
    const float share = static_cast<float>(other.share);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      result.segment<3>(3 * static_cast<Index>(k)) +=
          share * displacements.row(static_cast<Index>(other.frame)).segment<3>(3 * Index{vertices[k]});
    }
  }
  return result;
}

Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models) {
  Displacements result = Displacements::Zero(displacements.rows(), 3 * static_cast<Index>(part.region.vertices.size()));
  parallel_for(models.shares.size(), [&](std::size_t n) {
    result.row(static_cast<Index>(n)) = frame_deviation(displacements, part, models.shares[n]);
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
