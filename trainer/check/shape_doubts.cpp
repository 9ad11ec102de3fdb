#include "trainer/check/shape_doubts.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

#include "assets/wording.h"
#include "base/spread_evenly.h"
#include "geometry/extent.h"
#include "runtime/host/rig.h"
#include "trainer/train/data/stray_vertices.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/skinning/linear_blend.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr std::size_t kProbes = 48;  // frames of a take, that show what is stiff
constexpr std::size_t kBlock = 64;   // frames held at a time where all are looked at
constexpr double kMainWeight = 0.8;  // of a vertex that is a joint's own
constexpr std::size_t kFewestVertices = 5;
constexpr double kNotable = 0.01;  // of the character's longest extent
// Skin of real bodies follows its joint by 74 % and more; fingers that a coarser skin holds together, by 68 %.
constexpr double kLeastFollowing = 0.7;
constexpr std::size_t kShown = 5;  // strays of a take

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

// In every frame, by frame and vertex. Every so-many-th frame of the take makes a block: what is usual is known from
// all of the motion, and a vertex that is off for some frames in a row is in the minority in each.
std::vector<StrayVertex> strays_in(const Character& character, const std::vector<const Sample*>& samples) {
  const StrayVertices neighbours(character);
  std::vector<std::uint32_t> all(static_cast<std::size_t>(character.vertices.rows()));
  std::iota(all.begin(), all.end(), 0u);
  std::vector<StrayVertex> strays;
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
    const std::vector<StrayVertex> found = neighbours.mend(displacements, numbers, all);
    strays.insert(strays.end(), found.begin(), found.end());
  }
  std::stable_sort(strays.begin(), strays.end(),
                   [](const StrayVertex& a, const StrayVertex& b) { return a.frame < b.frame; });
  return strays;
}

void add_strays(const SampleSet& set, const std::vector<const Sample*>& samples, const std::string& take,
                std::vector<std::string>& doubts) {
  const std::vector<StrayVertex> strays = strays_in(set.character, samples);
  const std::vector<std::uint32_t>& output = set.character.output_vertex;
  for (std::size_t k = 0; k < std::min(strays.size(), kShown); ++k) {
    const auto vertex = std::find(output.begin(), output.end(), strays[k].vertex) - output.begin();
    doubts.push_back("take '" + take + "', frame " + std::to_string(samples[strays[k].frame]->frame) + ": vertex " +
                     std::to_string(vertex) + " flies " + std::to_string(std::lround(1e3 * strays[k].distance)) +
                     " mm away from its neighbours");
  }
  if (strays.size() > kShown) {
    doubts.push_back("take '" + take + "': so do vertices " +
                     count_of(strays.size() - kShown, "more time", "more times"));
  }
}

}  // namespace

std::vector<std::string> shape_doubts(const SampleSet& set) {
  std::vector<std::string> doubts;
  for (std::size_t t = 0; t < set.takes.size(); ++t) {
    const std::vector<const Sample*> samples = samples_of(set, static_cast<int>(t));
    if (samples.size() < 2) continue;
    add_stiff_parts(set, probe(set.character, samples), set.takes[t], doubts);
    if (!set.sparse) add_strays(set, samples, set.takes[t], doubts);
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

}  // namespace bodyopt
