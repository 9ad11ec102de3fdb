#include "trainer/check/shape_doubts.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <numbers>
#include <optional>
#include <sstream>

#include "assets/clips/clip.h"
#include "base/spread_evenly.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/host/rig.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

constexpr std::size_t kProbes = 48;  // frames of a take, that show what is stiff
constexpr std::size_t kBlock = 64;   // frames held at a time where all are looked at
constexpr double kMainWeight = 0.8;  // of a vertex that is a joint's own
constexpr std::size_t kFewestVertices = 5;
constexpr double kNotable = 0.01;  // of the character's longest extent
// Skin of real bodies follows its joint by 74 % and more; fingers that a coarser skin holds together, by 68 %.
constexpr double kLeastFollowing = 0.7;
constexpr std::size_t kShown = 5;  // outliers of a take

struct ProbedFrame {
  int frame = 0;
  std::vector<Affine> skinning;  // of every joint: from its place in the bind pose
  Positions skinned, shape;
};

std::vector<const Sample*> samples_of(const SampleSet& set, int take) {
  std::vector<const Sample*> samples;
  for (const std::vector<Sample>* some : {&set.train, &set.heldout}) {
    for (const Sample& sample : *some) {
      if (sample.take == take) samples.push_back(&sample);
    }
  }
  std::sort(samples.begin(), samples.end(), [](const Sample* a, const Sample* b) { return a->frame < b->frame; });
  return samples;
}

std::vector<ProbedFrame> probe(const Character& character, const std::vector<const Sample*>& samples) {
  std::vector<ProbedFrame> frames;
  const Skeleton& skeleton = character.skeleton;
  for (const std::size_t k : spread_evenly(samples.size(), kProbes)) {
    const Sample& sample = *samples[k];
    ProbedFrame frame{sample.frame, posed_joints(skeleton, sample.pose.joints), skin_linear(character, sample.pose),
                      sample.shape.read()};
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      frame.skinning[j] = frame.skinning[j] * skeleton.joints[j].inverse_bind;
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<std::vector<std::uint32_t>> own_vertices(const Character& character) {
  std::vector<std::vector<std::uint32_t>> own(character.skeleton.size());
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    const JointWeight& main = character.weights[v].front();
    if (main.weight > kMainWeight) own[main.joint].push_back(static_cast<std::uint32_t>(v));
  }
  return own;
}

// N x 3 vertices: where the parent has them, less their mean over the frames.
Eigen::MatrixXd motion(const std::vector<ProbedFrame>& frames, Positions ProbedFrame::*positions, std::size_t parent,
                       const std::vector<std::uint32_t>& vertices) {
  Eigen::MatrixXd places(static_cast<Index>(frames.size()), 3 * static_cast<Index>(vertices.size()));
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const Affine to_parent = inverse(frames[n].skinning[parent]);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      const auto p = (frames[n].*positions).row(vertices[k]);
      const Vec3 place = to_parent * Vec3{p[0], p[1], p[2]};
      for (Index i = 0; i < 3; ++i) {
        places(static_cast<Index>(n), 3 * static_cast<Index>(k) + i) = place[static_cast<std::size_t>(i)];
      }
    }
  }
  return places.rowwise() - places.colwise().mean();
}

void add_stiff_parts(const SampleSet& set, const std::vector<ProbedFrame>& frames, const std::string& take,
                     std::vector<std::string>& doubts) {
  const Skeleton& skeleton = set.character.skeleton;
  const double notable = kNotable * longest_extent(set.character.vertices);
  const std::vector<std::vector<std::uint32_t>> own = own_vertices(set.character);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0 || own[j].size() < kFewestVertices) continue;
    const auto above = static_cast<std::size_t>(parent);
    const Eigen::MatrixXd rigged = motion(frames, &ProbedFrame::skinned, above, own[j]);
    const double moved2 = rigged.squaredNorm() / static_cast<double>(frames.size() * own[j].size());
    if (moved2 < notable * notable) continue;
    const Eigen::MatrixXd found = motion(frames, &ProbedFrame::shape, above, own[j]);
    const double following = rigged.cwiseProduct(found).sum() / rigged.squaredNorm();
    if (following >= kLeastFollowing) continue;
    doubts.push_back("take '" + take + "': the skin of '" + skeleton.joints[j].name + "' follows its joint by " +
                     std::to_string(std::lround(100 * following)) +
                     " %: glued to what it touches at rest, or made with another rig?");
  }
}

// Returns outliers of every frame, by frame and vertex. A block takes every n-th frame, so that all of the motion shows
// what is usual. A vertex that is off for some frames in a row is in the minority in each block.
std::vector<OutlierVertex> outliers_in(const Character& character, const std::vector<const Sample*>& samples) {
  const OutlierVertices neighbours(character);
  const std::vector<std::uint32_t> all = all_vertices(character.vertices.rows());
  std::vector<OutlierVertex> outliers;
  const std::size_t blocks = (samples.size() + kBlock - 1) / kBlock;
  for (std::size_t block = 0; block < blocks; ++block) {
    std::vector<std::size_t> numbers;
    for (std::size_t n = block; n < samples.size(); n += blocks) numbers.push_back(n);
    Displacements displacements(static_cast<Index>(numbers.size()), 3 * character.vertices.rows());
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const Sample& sample = *samples[numbers[k]];
      const Positions apart = sample.shape.read() - skin_linear(character, sample.pose);
      displacements.row(static_cast<Index>(k)) =
          Eigen::Map<const Eigen::RowVectorXd>(apart.data(), apart.size()).cast<float>();
    }
    const std::vector<OutlierVertex> found = neighbours.mend(displacements, numbers, all);
    outliers.insert(outliers.end(), found.begin(), found.end());
  }
  std::stable_sort(outliers.begin(), outliers.end(),
                   [](const OutlierVertex& a, const OutlierVertex& b) { return a.frame < b.frame; });
  return outliers;
}

void add_outliers(const SampleSet& set, const std::vector<const Sample*>& samples, const std::string& take,
                  std::vector<std::string>& doubts) {
  const std::vector<OutlierVertex> outliers = outliers_in(set.character, samples);
  for (std::size_t k = 0; k < std::min(outliers.size(), kShown); ++k) {
    doubts.push_back("take '" + take + "', frame " + std::to_string(samples[outliers[k].frame]->frame) + ": vertex " +
                     std::to_string(set.character.first_output(outliers[k].vertex)) + " flies " +
                     std::to_string(std::lround(1e3 * outliers[k].distance)) + " mm away from its neighbours");
  }
  if (outliers.size() > kShown) {
    doubts.push_back("take '" + take + "': so do vertices " +
                     count_of(outliers.size() - kShown, "more time", "more times"));
  }
}

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Index kPoints = 1500;  // vertices that tell as much as all
constexpr int kMostShift = 30;   // frames
// Left of a distance that is explained. Of simulations as they are, the best of all leaves 0.89 and more.
constexpr double kExplained = 0.7;
constexpr double kMisplaced = 1e-3;  // of the longest extent: nearer shapes are where they should be
constexpr double kSame = 1e-4;       // of the longest extent: what rounding leaves

// y = size * turn * x + move: from the shapes, row by row, to where they should be.
struct Similarity {
  double size = 1;
  Matrix3d turn = Matrix3d::Identity();
  Vector3d move = Vector3d::Zero();

  Positions operator()(const Positions& points) const {
    return ((size * points) * turn.transpose()).rowwise() + move.transpose();
  }
};

// Fits those freedoms that are asked for, without mirror images.
Similarity best_similarity(const Positions& from, const Positions& to, bool size, bool turn, bool move) {
  Similarity best;
  Eigen::RowVector3d from_mean = Eigen::RowVector3d::Zero(), to_mean = from_mean;
  if (move) from_mean = from.colwise().mean(), to_mean = to.colwise().mean();
  const Positions x = from.rowwise() - from_mean, y = to.rowwise() - to_mean;
  const Matrix3d product = y.transpose() * x;
  if (turn) {
    const Eigen::JacobiSVD<Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
    best.turn = svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  }
  const double along = (best.turn.transpose() * product).trace();
  if (size && along > 0 && x.squaredNorm() > 0) best.size = along / x.squaredNorm();
  best.move = to_mean.transpose() - best.size * best.turn * from_mean.transpose();
  return best;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

// Writes whole thousandths of the power of ten below `extent`: "0 0.06 0".
std::string words(const Vector3d& vector, double extent) {
  const double step = std::pow(10.0, std::floor(std::log10(extent)) - 3);
  std::string text;
  for (const double value : vector) {
    text += (text.empty() ? "" : " ") + rounded(step * std::round(value / step) + 0.0);
  }
  return text;
}

std::string size_words(double size) {
  constexpr std::pair<double, const char*> kUnits[] = {
      {1e-3, "millimetres"}, {0.01, "centimetres"}, {0.0254, "inches"}, {0.1, "decimetres"}, {0.3048, "feet"}};
  for (const auto& [unit, name] : kUnits) {
    if (std::abs(size / unit - 1) < 0.02) return rounded(1 / unit) + " times too large, as in " + name;
  }
  return rounded(std::max(size, 1 / size)) + (size < 1 ? " times too large" : " times too small");
}

double degrees_of(const Matrix3d& turn) { return Eigen::AngleAxisd(turn).angle() * 180 / std::numbers::pi; }

// How far and about what the shapes are turned.
std::string turn_words(const Matrix3d& undone) {
  constexpr double kNearly = 1.5;  // degrees
  const Matrix3d quarter = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()).toRotationMatrix();
  if (degrees_of(quarter * undone) < kNearly) return "turned by 90 degrees about 1 0 0: Z-up, the character Y-up";
  if (degrees_of(quarter.transpose() * undone) < kNearly) {
    return "turned by 90 degrees about -1 0 0: Y-up, the character Z-up";
  }
  return "turned by " + rounded(std::round(10 * degrees_of(undone)) / 10) + " degrees about " +
         words(-Eigen::AngleAxisd(undone).axis(), 1);
}

struct Explanation {
  std::string cause;
  double left = 1;        // share of the distance
  double assumption = 1;  // what it assumes weighs, beside what it leaves
};

// Every so-many-th vertex.
struct Thinned {
  explicit Thinned(const Character& character) : step((character.vertices.rows() + kPoints - 1) / kPoints) {
    some.skeleton = character.skeleton;
    some.vertices = rows(character.vertices);
    for (Index v = 0; v < character.vertices.rows(); v += step) {
      some.weights.push_back(character.weights[static_cast<std::size_t>(v)]);
    }
  }
  Positions rows(const Positions& all) const { return all(Eigen::seq(0, all.rows() - 1, step), Eigen::all); }
  Index step;
  Character some;
};

class MisplacedShapes {
 public:
  MisplacedShapes(const Character& character, const Clip& clip, const std::vector<int>& frames,
                  const std::vector<Positions>& shapes)
      : thinned_(character), clip_(clip), frames_(frames), extent_(longest_extent(character.vertices)) {
    const Index points = thinned_.some.vertices.rows();
    shapes_.resize(points * static_cast<Index>(frames.size()), 3);
    skinned_.resizeLike(shapes_);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      frame_of(shapes_, k) = thinned_.rows(shapes[k]);
      frame_of(skinned_, k) = skinned(frames[k]);
    }
    distance_ = (shapes_ - skinned_).norm();
  }

  Misplacement find() {
    const double notable = std::sqrt(static_cast<double>(shapes_.rows())) * extent_;
    if (!(distance_ > kMisplaced * notable)) return {};
    explain_by_frames();
    explain_by_rate();
    explain_by_similarity();
    explain_by_mirror();
    explain_by_each_frame();
    const double rounding = kSame * notable / distance_;
    const auto& best = *std::ranges::min_element(
        found_, {}, [&](const Explanation& one) { return (one.left + rounding) * one.assumption; });
    return best.left < kExplained ? Misplacement{"the " + best.cause, best.left} : Misplacement{};
  }

 private:
  Eigen::Block<Positions, Eigen::Dynamic, 3, true> frame_of(Positions& all, std::size_t k) const {
    const Index points = thinned_.some.vertices.rows();
    return all.middleRows(points * static_cast<Index>(k), points);
  }
  const Pose& pose(int frame) const { return clip_.poses[static_cast<std::size_t>(frame - clip_.first_frame)]; }
  Positions skinned(int frame) const { return skin_linear(thinned_.some, pose(frame)); }

  // Between frames as between the shapes there; nothing where the clip has none.
  std::optional<Positions> skinned_between(double frame) const {
    const int before = static_cast<int>(std::floor(frame));
    const double share = frame - before;
    if (before < clip_.first_frame || before + (share > 0 ? 1 : 0) > clip_.last_frame()) return std::nullopt;
    if (share == 0) return skinned(before);
    return Positions((1 - share) * skinned(before) + share * skinned(before + 1));
  }

  // Returns the share of the distance left if `of_clip` numbers the frames; 1 if the clip lacks more than half of them.
  double left_by(const std::function<double(int frame)>& of_clip) {
    double before = 0, after = 0;
    std::size_t seen = 0;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const std::optional<Positions> there = skinned_between(of_clip(frames_[k]));
      if (!there) continue;
      before += (frame_of(shapes_, k) - frame_of(skinned_, k)).squaredNorm();
      after += (frame_of(shapes_, k) - *there).squaredNorm();
      ++seen;
    }
    return 2 * seen >= frames_.size() && before > 0 ? std::sqrt(after / before) : 1;
  }

  void explain_by_frames() {
    std::vector<double> shifts{0.25, 0.5, 0.75};
    for (int n = 1; n <= kMostShift; ++n) shifts.push_back(n);
    for (const double n : shifts) {
      const double assumption = n < 1 ? 1.25 : 1;  // a part that lags behind may look so
      const std::string number = "frames are numbered " + rounded(n);
      found_.push_back({number + " too high", left_by([n](int frame) { return frame - n; }), assumption});
      found_.push_back({number + " too low", left_by([n](int frame) { return frame + n; }), assumption});
    }
  }

  void explain_by_rate() {
    for (const double rate : {24, 25, 30, 48, 50, 60, 120}) {
      if (std::abs(rate - clip_.fps) < 1e-3 * rate) continue;
      const double left =
          left_by([&](int frame) { return clip_.first_frame + (frame - clip_.first_frame) * clip_.fps / rate; });
      found_.push_back({"frames are " + rounded(rate) + " a second, and those of the clip are taken as " +
                            rounded(clip_.fps) + " (--fps)",
                        left});
    }
  }

  void explain_by_similarity() {
    for (const int freedoms : {1, 2, 4, 3, 5, 6, 7}) {
      const bool size = freedoms & 1, turn = freedoms & 2, move = freedoms & 4;
      const Similarity undo = best_similarity(shapes_, skinned_, size, turn, move);
      std::vector<std::string> parts;
      if (size) parts.push_back(size_words(undo.size));
      if (turn) parts.push_back(turn_words(undo.turn));
      if (move) parts.push_back("moved by " + words(-undo.move, extent_) + " m in all frames");
      found_.push_back({"shapes are " + joined(parts), (undo(shapes_) - skinned_).norm() / distance_,
                        1 + 0.25 * static_cast<double>(parts.size() - 1)});
    }
  }

  void explain_by_mirror() {
    Positions mirrored = shapes_;
    mirrored.col(0) *= -1;
    found_.push_back({"shapes are mirrored left to right", (mirrored - skinned_).norm() / distance_});
  }

  // Returns how far the topmost joint that travels is, in each frame, from where it is in the first.
  Positions travel() const {
    Positions places = Positions::Zero(static_cast<Index>(frames_.size()), 3);
    for (std::size_t j = 0; j < thinned_.some.skeleton.size(); ++j) {
      for (std::size_t k = 0; k < frames_.size(); ++k) {
        const Affine joint = posed_joints(thinned_.some.skeleton, pose(frames_[k]).joints)[j];
        places.row(static_cast<Index>(k)) << joint.m[0][3], joint.m[1][3], joint.m[2][3];
      }
      places.rowwise() -= Eigen::RowVector3d(places.row(0));
      if (places.norm() > kSame * extent_) break;
    }
    return places;
  }

  void explain_by_each_frame() {
    const Positions way = travel();
    Positions lacking(way.rows(), 3);
    double moved2 = 0, turned2 = 0, turned = 0;  // what moving leaves, and what turning, too
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const Positions shape = frame_of(shapes_, k), expected = frame_of(skinned_, k);
      lacking.row(static_cast<Index>(k)) = (expected - shape).colwise().mean();
      moved2 += (best_similarity(shape, expected, false, false, true)(shape) - expected).squaredNorm();
      const Similarity undo = best_similarity(shape, expected, false, true, true);
      turned2 += (undo(shape) - expected).squaredNorm();
      turned = std::max(turned, degrees_of(undo.turn));
    }
    lacking.rowwise() -= Eigen::RowVector3d(lacking.row(0));
    const double missing = way.cwiseProduct(lacking).sum() / std::max(way.squaredNorm(), 1e-300);
    std::string cause = "shapes are moved in each frame by another way, ";
    if (std::abs(missing - 1) < 0.25) cause = "root's travel is missing, ";
    if (std::abs(missing + 1) < 0.25) cause = "root's travel is in the shapes twice, ";
    constexpr const char* kSpace = " at most: are they in the space of an object that moves?";
    found_.push_back(
        {cause + rounded(lacking.rowwise().norm().maxCoeff()) + " m" + kSpace, std::sqrt(moved2) / distance_, 2});
    found_.push_back(
        {"shapes are moved and turned in each frame by another way, " + rounded(turned) + " degrees" + kSpace,
         std::sqrt(turned2) / distance_, 3});
  }

  const Thinned thinned_;
  const Clip& clip_;
  const std::vector<int>& frames_;
  double extent_;
  Positions shapes_, skinned_;  // frame by frame
  double distance_;             // root of the sum of squares
  std::vector<Explanation> found_;
};

}  // namespace

std::vector<std::string> shape_doubts(const SampleSet& set) {
  std::vector<std::string> doubts;
  for (std::size_t t = 0; t < set.takes.size(); ++t) {
    const std::vector<const Sample*> samples = samples_of(set, static_cast<int>(t));
    if (samples.size() < 2) continue;
    add_stiff_parts(set, probe(set.character, samples), set.takes[t], doubts);
    if (!set.sparse) add_outliers(set, samples, set.takes[t], doubts);
  }
  return doubts;
}

std::vector<std::string> short_takes(const Dataset& dataset) {
  constexpr std::size_t kFewest = 11;  // the second block of ten may be begun
  std::vector<std::string> sentences;
  for (const DatasetTake& take : dataset.takes) {
    if (take.frames.size() >= kFewest || !take.heldout.empty()) continue;
    sentences.push_back("take '" + take.name + "' has " + count_of(take.frames.size(), "frame", "frames") +
                        ": too short for train --heldout-every to hold any of it out");
  }
  return sentences;
}

std::vector<std::string> coarse_takes(const Dataset& dataset) {
  constexpr double kLearned = 0.5e-3;  // metres, RMS: training comes as near as this to much of what it learns from
  std::vector<std::string> sentences;
  for (const DatasetTake& take : dataset.takes) {
    if (take.shapes_status.empty()) continue;
    double error = 0;
    for (const FrameStatus& frame : read_frame_status(dataset.folder / take.shapes_status)) {
      if (std::isfinite(frame.discretisation_error)) error = std::max(error, frame.discretisation_error);
    }
    if (!(error > kLearned)) continue;
    std::ostringstream sentence;
    sentence << "take '" << take.name << "': finer tets would move the skin by about " << std::fixed
             << std::setprecision(1) << 1e3 * error
             << " mm (RMS, estimated), more than training leaves unlearned of it";
    sentences.push_back(sentence.str());
  }
  return sentences;
}

Misplacement find_misplacement(const Character& character, const Clip& clip, const std::vector<int>& frames,
                               const std::vector<Positions>& shapes) {
  return MisplacedShapes(character, clip, frames, shapes).find();
}

}  // namespace bodyopt::trainer
