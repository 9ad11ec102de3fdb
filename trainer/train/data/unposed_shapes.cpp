#include "trainer/train/data/unposed_shapes.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/quantile.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
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

using Eigen::Index;
using Eigen::Vector3f;

// Nearer to its neighbours' displacement no vertex is an outlier; a part of the character's size: 9 mm of 1.8 m.
constexpr double kNear = 5e-3;
// An outlier is this many times further off than its neighbours are spread, and than it is in nine frames of ten.
// Folds and contact of simulated skins reach 3.2 times.
constexpr float kFar = 5;
constexpr double kUsual = 0.9;
constexpr std::size_t kFewestNeighbours = 3;

Vector3f displacement(const Displacements& displacements, Index frame, std::uint32_t column) {
  return displacements.row(frame).segment<3>(3 * Index{column}).transpose();
}

// One vertex among others: its column and theirs.
struct Neighbourhood {
  std::uint32_t column;
  std::vector<std::uint32_t> neighbours;

  // Measures from the mean of the neighbours' displacements: quick, and large beside an outlier, too.
  float roughly_apart(const Displacements& displacements, Index frame) const {
    Vector3f sum = Vector3f::Zero();
    for (const std::uint32_t other : neighbours) sum += displacement(displacements, frame, other);
    return (displacement(displacements, frame, column) - sum / static_cast<float>(neighbours.size())).norm();
  }

  // The median of the neighbours' displacements, coordinate by coordinate: one of them that is an outlier does not move
  // it.
  Vector3f common(const Displacements& displacements, Index frame) const {
    Vector3f result;
    std::vector<float> values(neighbours.size());
    for (Index axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        values[k] = displacement(displacements, frame, neighbours[k])[axis];
      }
      result[axis] = median(values);
    }
    return result;
  }

  // Median distance of the neighbours' displacements from the common one.
  float spread(const Displacements& displacements, Index frame, const Vector3f& common) const {
    std::vector<float> values;
    for (const std::uint32_t other : neighbours) {
      values.push_back((displacement(displacements, frame, other) - common).norm());
    }
    return median(values);
  }

  // How far apart the vertex is at most in all but a few frames.
  float usually_apart(const Displacements& displacements) const {
    std::vector<float> values;
    for (Index n = 0; n < displacements.rows(); ++n) values.push_back(roughly_apart(displacements, n));
    return quantile(values, kUsual);
  }
};

// Returns those of every vertex with enough neighbours, all of them among `vertices`.
std::vector<Neighbourhood> neighbourhoods_among(const std::vector<std::vector<std::uint32_t>>& neighbours,
                                                std::span<const std::uint32_t> vertices) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> column_of(neighbours.size(), kNone);
  for (std::size_t k = 0; k < vertices.size(); ++k) column_of[vertices[k]] = static_cast<std::uint32_t>(k);
  std::vector<Neighbourhood> among;
  for (const std::uint32_t vertex : vertices) {
    Neighbourhood around{column_of[vertex], {}};
    for (const std::uint32_t other : neighbours[vertex]) {
      if (column_of[other] != kNone) around.neighbours.push_back(column_of[other]);
    }
    const bool complete = around.neighbours.size() == neighbours[vertex].size();
    if (complete && around.neighbours.size() >= kFewestNeighbours) among.push_back(std::move(around));
  }
  return among;
}

void sort_unique(std::vector<std::uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
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
  std::vector<OutlierVertex> outliers = neighbours_.mend(displacements, frames, vertices);
  return {std::move(displacements), std::move(outliers)};
}

OutlierVertices::OutlierVertices(const Character& character)
    : size_(longest_extent(character.vertices)), neighbours_(static_cast<std::size_t>(character.vertices.rows())) {
  for_each_edge(character.triangles, [&](std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    neighbours_[a].push_back(b);
    neighbours_[b].push_back(a);
  });
  for (std::vector<std::uint32_t>& list : neighbours_) sort_unique(list);
}

std::vector<std::uint32_t> OutlierVertices::with_neighbours(const std::vector<std::uint32_t>& vertices) const {
  std::vector<std::uint32_t> grown = vertices;
  for (const std::uint32_t vertex : vertices) {
    grown.insert(grown.end(), neighbours_[vertex].begin(), neighbours_[vertex].end());
  }
  sort_unique(grown);
  return grown;
}

std::vector<OutlierVertex> OutlierVertices::mend(Displacements& displacements, std::span<const std::size_t> frames,
                                                 std::span<const std::uint32_t> vertices) const {
  const std::vector<Neighbourhood> neighbourhoods = neighbourhoods_among(neighbours_, vertices);
  const auto near = static_cast<float>(kNear * size_);
  std::vector<std::vector<std::size_t>> suspects(frames.size());  // neighbourhoods
  parallel_for(frames.size(), [&](std::size_t n) {
    for (std::size_t k = 0; k < neighbourhoods.size(); ++k) {
      if (neighbourhoods[k].roughly_apart(displacements, static_cast<Index>(n)) > near) suspects[n].push_back(k);
    }
  });
  std::vector<char> suspected(neighbourhoods.size(), false);
  for (const std::vector<std::size_t>& list : suspects) {
    for (const std::size_t k : list) suspected[k] = true;
  }
  std::vector<float> usual(neighbourhoods.size());
  parallel_for(neighbourhoods.size(), [&](std::size_t k) {
    if (suspected[k]) usual[k] = neighbourhoods[k].usually_apart(displacements);
  });

  std::vector<OutlierVertex> outliers;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const auto row = static_cast<Index>(n);
    std::vector<std::pair<std::uint32_t, Vector3f>> mended;  // put in place once all of the frame are known
    for (const std::size_t k : suspects[n]) {
      const Neighbourhood& around = neighbourhoods[k];
      const Vector3f common = around.common(displacements, row);
      const float apart = (displacement(displacements, row, around.column) - common).norm();
      if (!(apart > std::max({near, kFar * usual[k], kFar * around.spread(displacements, row, common)}))) continue;
      outliers.push_back({frames[n], vertices[around.column], double{apart}});
      mended.emplace_back(around.column, common);
    }
    for (const auto& [column, common] : mended) {
      displacements.row(row).segment<3>(3 * Index{column}) = common.transpose();
    }
  }
  return outliers;
}

}  // namespace bodyopt::trainer
