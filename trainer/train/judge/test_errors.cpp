#include "trainer/train/judge/test_errors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/progress.h"
#include "geometry/laplacian.h"
#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/deformer.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/judge/heldout.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {
namespace {

using Index = Eigen::Index;
using Squares = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // V or parts x (ddm, full, expected), mm^2

// Square metres of skin that each joint has of each vertex, V x joints.
Eigen::SparseMatrix<double> skin_of_joints(const Character& character) {
  const Eigen::VectorXd areas = lumped_areas(character.vertices, character.triangles);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& w : character.weights[v]) {
      entries.emplace_back(static_cast<int>(v), static_cast<int>(w.joint), w.weight * areas[static_cast<Index>(v)]);
    }
  }
  Eigen::SparseMatrix<double> skin(static_cast<Index>(character.weights.size()),
                                   static_cast<Index>(character.skeleton.size()));
  skin.setFromTriplets(entries.begin(), entries.end());
  return skin;
}

MethodErrors errors_of(const Eigen::RowVector3d& squares, double weight) {
  if (!(weight > 0)) return {};
  return {std::sqrt(squares[0] / weight), std::sqrt(squares[1] / weight), std::sqrt(squares[2] / weight)};
}

// Evaluates frames, and says of each vertex how far they are off.
class Tester {
 public:
  Tester(const Basis& basis, const SampleSet& set)
      : character_(set.character), full_(basis, {.name = "cpu"}), ddm_(without_residual(basis), {.name = "cpu"}) {
    if (basis.coverage.empty()) return;
    expectation_.emplace(full_.basis());
    shares_ = RegionShares(basis);
  }

  Squares squares(const Sample& sample, FrameErrors& frame) {
    Pose pose = sample.pose;
    if (full_.basis().residual.controls.empty()) pose.controls.clear();  // a basis that has learned none
    const Evaluation full = full_.evaluate({&pose, 1});
    const Positions truth = sample.shape.read();
    Squares squares(truth.rows(), 3);
    pose.controls.clear();
    squares.col(0) = squared_mm(ddm_.evaluate({&pose, 1}).positions, truth);
    squares.col(1) = squared_mm(full.positions, truth);
    pose.controls = sample.pose.controls;
    squares.col(2) = expected_squares(sample.pose, full.strains);
    frame.fade = mean_fade(full, 0);
    if (full.fading_joint[0] >= 0) {
      frame.fading_joint = full_.basis().skeleton.joints[static_cast<std::size_t>(full.fading_joint[0])].name;
    }
    return squares;
  }

 private:
  Eigen::VectorXd squared_mm(const std::vector<float>& positions, const Positions& truth) const {
    return 1e6 * (welded_from_output(character_, positions.data()) - truth).rowwise().squaredNorm();
  }

  Eigen::VectorXd expected_squares(const Pose& pose, const std::vector<float>& strains) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(character_.vertices.rows());
    if (!expectation_) return squares;
    const Basis& basis = full_.basis();
    const std::vector<float> metres = shares_.carry(expectation_->of(pose, strains).region_mm);
    for (std::size_t o = 0; o < character_.output_vertex.size(); ++o) {
      squares[character_.output_vertex[o]] = 1e6 * std::pow(double{metres[basis.mesh.output_vertex[o]]}, 2);
    }
    return squares;
  }

  const Character& character_;
  Deformer full_, ddm_;
  std::optional<ErrorExpectation> expectation_;
  RegionShares shares_;
};

// Of one take, over its frames.
class TakeSums {
 public:
  explicit TakeSums(const Eigen::SparseMatrix<double>& skin) : skin_(skin) {
    areas_ = skin.transpose() * Eigen::VectorXd::Ones(skin.rows());
    sums_ = Squares::Zero(skin.cols(), 3);
  }

  void add(FrameErrors frame, const Squares& squares) {
    const Squares parts = skin_.transpose() * squares;
    sums_ += parts;
    frame.errors = errors_of(parts.colwise().sum(), areas_.sum());
    frames_.push_back(std::move(frame));
    for (Index j = 0; j < parts.rows(); ++j) {
      if (!(areas_[j] > 0)) continue;
      const MethodErrors errors = errors_of(parts.row(j), areas_[j]);
      expected_.push_back(errors.expected);
      measured_.push_back(errors.full);
    }
  }

  bool empty() const { return frames_.empty(); }

  TakeErrors finish(const std::string& name, const Skeleton& skeleton) const {
    TakeErrors take{name, {}, {}, frames_, rank_correlation(expected_, measured_)};
    const auto count = static_cast<double>(frames_.size());
    take.errors = errors_of(sums_.colwise().sum(), count * areas_.sum());
    for (Index j = 0; j < areas_.size(); ++j) {
      if (!(areas_[j] > 0)) continue;
      take.parts.push_back(
          {skeleton.joints[static_cast<std::size_t>(j)].name, areas_[j], errors_of(sums_.row(j), count * areas_[j])});
    }
    return take;
  }

 private:
  const Eigen::SparseMatrix<double>& skin_;
  Eigen::VectorXd areas_;
  Squares sums_;
  std::vector<FrameErrors> frames_;
  std::vector<double> expected_, measured_;
};

}  // namespace

std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set) {
  return test_errors(basis, set, set.heldout.empty() ? set.train : set.heldout);
}

std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set, const std::vector<Sample>& samples) {
  const Character ordered = in_order(set.character, morton_order(set.character.vertices));
  require_same_character(make_mesh_table(ordered), ordered.skeleton, basis);
  const Eigen::SparseMatrix<double> skin = skin_of_joints(set.character);
  Tester tester(basis, set);
  const LearnedPoses learned(basis, set);
  std::vector<TakeSums> sums(set.takes.size(), TakeSums(skin));
  Progress progress("test", samples.size());
  for (const Sample& sample : samples) {
    FrameErrors frame;
    frame.frame = sample.frame;
    frame.learned = learned.has(sample.pose);
    const Squares squares = tester.squares(sample, frame);
    sums[static_cast<std::size_t>(sample.take)].add(std::move(frame), squares);
    progress.advance();
  }
  std::vector<TakeErrors> takes;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (!sums[k].empty()) takes.push_back(sums[k].finish(set.takes[k], set.character.skeleton));
  }
  return takes;
}

std::vector<PartErrors> harmed_parts(const TakeErrors& take, double share) {
  std::vector<PartErrors> harmed;
  for (const PartErrors& part : take.parts) {
    if (part.errors.full > (1 + share) * part.errors.ddm) harmed.push_back(part);
  }
  return harmed;
}

}  // namespace bodyopt
