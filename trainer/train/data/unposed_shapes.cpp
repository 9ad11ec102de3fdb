#include "trainer/train/data/unposed_shapes.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/progress.h"
#include "runtime/core/error.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

// Finite and of as many vertices as the character.
Positions read_shape(const SampleSet& set, const Sample& sample) {
  const std::string where = frame_name(set, sample);
  Positions shape;
  try {
    shape = sample.shape.read();
  } catch (const Error& error) {
    throw Error(error.kind(), where + ": " + error.what());
  }
  if (shape.rows() != set.character.vertices.rows()) {
    throw Error(ErrorKind::mismatch, where + ": its shape has " + std::to_string(shape.rows()) +
                                         " vertices, the character " + std::to_string(set.character.vertices.rows()));
  }
  if (!shape.allFinite()) throw Error(ErrorKind::mismatch, where + ": its shape holds a number that is not finite");
  return shape;
}

}  // namespace

UnposedFrames UnposedShapes::operator()(const std::string& title, std::span<const std::size_t> frames,
                                        std::span<const std::uint32_t> vertices) const {
  Displacements displacements(static_cast<Eigen::Index>(frames.size()), 3 * static_cast<Eigen::Index>(vertices.size()));
  Progress progress(title, frames.size());
  parallel_for(frames.size(), [&](std::size_t n) {
    const Sample& sample = set_.train[frames[n]];
    const Positions shape = read_shape(set_, sample);
    Positions some(static_cast<Eigen::Index>(vertices.size()), 3);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      some.row(static_cast<Eigen::Index>(k)) = shape.row(order_[vertices[k]]);
    }
    const Positions delta = unposing_ == Method::Unposing::ddm ? unpose_ddm(basis_, sample.pose, some, vertices)
                                                               : unpose_linear(ordered_, sample.pose, some, vertices);
    displacements.row(static_cast<Eigen::Index>(n)) =
        Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
    progress.advance();
  });
  if (set_.sparse) return {std::move(displacements), {}};
  std::vector<StrayVertex> strays = neighbours_.mend(displacements, frames, vertices);
  return {std::move(displacements), std::move(strays)};
}

}  // namespace bodyopt
