#include "trainer/check/check.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "assets/caches/shape_reader.h"
#include "assets/clips/clip.h"
#include "base/wording.h"
#include "dataset/modifier.h"
#include "dataset/regions_file.h"
#include "geometry/mesh.h"
#include "geometry/surface_topology.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/check/shape_doubts.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

// A shape further than this share of the character's size from its skinned rest cannot be a simulation of it.
constexpr double kBelongs = 0.04;

double rms_distance(const Positions& a, const Positions& b) {
  return std::sqrt((a - b).rowwise().squaredNorm().mean());
}

// How far a pose turns the joints away from bind, radians, summed; the root does not count.
double distance_from_bind(const Skeleton& skeleton, const Pose& pose) {
  double sum = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent < 0) continue;
    const Quat q = normalized(pose.joints[j].rotation) * conjugate(normalized(skeleton.joints[j].bind.rotation));
    sum += 2 * std::acos(std::min(1.0, std::abs(q[3])));
  }
  return sum;
}

// The problem that keeps a take's controls from flexing muscles in its frames; empty: there is none.
std::string control_problem(const Clip& clip, const std::vector<int>& frames, const std::vector<Muscle>& muscles) {
  try {
    flexed_muscles(clip.controls, muscles);
  } catch (const Error& error) {
    return error.what();
  }
  for (const int frame : frames) {
    if (frame < clip.first_frame || frame > clip.last_frame()) continue;  // check_counts says so
    const Pose& pose = clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
    for (std::size_t c = 0; c < clip.controls.size(); ++c) {
      const float value = pose.controls[c];
      if (value >= 0 && value <= 1) continue;
      std::ostringstream problem;
      problem << "the control '" << clip.controls[c] << "' is " << value << " in frame " << frame
              << ", expected 0 (relaxed) to 1 (all a muscle can): in per cent?";
      return problem.str();
    }
  }
  return "";
}

class TakeChecker {
 public:
  TakeChecker(const Dataset& dataset, const Character& character, const std::vector<Muscle>& muscles,
              const DatasetTake& take)
      : character_(character), muscles_(muscles), take_(take), reader_(dataset.folder / take.shapes) {
    clip_ = read_clip(dataset, take, character.skeleton);
    std::set<int> wrecks = unconverged_frames(dataset, take);
    result_.unconverged = static_cast<std::uint32_t>(wrecks.size());
    wrecks.merge(replaced_frames(dataset, take));
    for (std::size_t k = 0; k < take.frames.size(); ++k) {
      if (!wrecks.contains(take.frames[k])) solved_.push_back(k);
    }
    result_.name = take.name;
    result_.points = reader_.point_count();
    result_.samples = reader_.sample_count();
    result_.compared = static_cast<std::uint32_t>(solved_.size());
  }

  TakeCheck run() {
    check_counts();
    if (result_.problems.empty()) {
      for (const std::size_t k : solved_) reader_.sample(static_cast<std::uint32_t>(k));  // throws at a NaN
      check_fit();
    }
    check_controls();
    return result_;
  }

 private:
  void check_counts() {
    if (result_.points != character_.output_count()) {
      std::string cause = "the shapes are of another mesh";
      if (result_.points == static_cast<std::uint32_t>(character_.vertices.rows())) {
        cause = "the shapes were exported after merging the vertices along UV seams";
      } else if (result_.points == 3 * static_cast<std::uint32_t>(character_.output_triangles.rows())) {
        cause = "the shapes were exported with three vertices of its own for every triangle";
      }
      result_.problems.push_back("the cache has " + std::to_string(result_.points) + " points, the character " +
                                 std::to_string(character_.output_count()) + " vertices: " + cause);
    }
    if (result_.samples != take_.frames.size()) {
      result_.problems.push_back("the cache has " + std::to_string(result_.samples) + " samples, the take names " +
                                 std::to_string(take_.frames.size()) +
                                 " frames: the frame range is not that of the cache");
    }
    for (const int frame : take_.frames) {
      if (frame >= clip_.first_frame && frame <= clip_.last_frame()) continue;
      result_.problems.push_back("frame " + std::to_string(frame) + " lies outside the clip (" +
                                 std::to_string(clip_.first_frame) + " to " + std::to_string(clip_.last_frame()) +
                                 "): wrong fps or first frame?");
      break;
    }
  }

  // Without muscles controls may mean anything.
  void check_controls() {
    if (muscles_.empty() || take_.controls.empty()) return;
    const std::string problem = control_problem(clip_, take_.frames, muscles_);
    if (!problem.empty()) result_.problems.push_back(take_.controls + ": " + problem);
  }

  Positions shape(std::size_t sample) const {
    return welded_from_output(character_, reader_.sample(static_cast<std::uint32_t>(sample)).data());
  }

  Positions skinned(int frame) const {
    return skin_linear(character_, clip_.poses[static_cast<std::size_t>(frame - clip_.first_frame)]);
  }

  void check_fit() {
    if (solved_.empty()) return;
    constexpr std::size_t kProbes = 12;
    std::vector<int> frames;
    std::vector<Positions> shapes;
    double sum = 0;
    for (std::size_t n = 0; n < kProbes; ++n) {
      const std::size_t k = solved_[n * (solved_.size() - 1) / (kProbes - 1)];
      if (!frames.empty() && take_.frames[k] == frames.back()) continue;
      frames.push_back(take_.frames[k]);
      shapes.push_back(shape(k));
      sum += std::pow(rms_distance(shapes.back(), skinned(frames.back())), 2);
    }

    std::size_t nearest = solved_.front();
    double nearest_distance = 1e300;
    for (const std::size_t k : solved_) {
      const Pose& pose = clip_.poses[static_cast<std::size_t>(take_.frames[k] - clip_.first_frame)];
      const double distance = distance_from_bind(character_.skeleton, pose);
      if (distance < nearest_distance) {
        nearest_distance = distance;
        nearest = k;
      }
    }
    result_.rest_frame = take_.frames[nearest];
    result_.rest_fit_mm = 1e3 * rms_distance(shape(nearest), skinned(take_.frames[nearest]));
    const double found = std::sqrt(sum / static_cast<double>(frames.size()));
    result_.fit_mm = 1e3 * found;
    if (!take_.as_given) judge(found, find_misplacement(character_, clip_, frames, shapes));
  }

  void judge(double found, const Misplacement& misplacement) {
    constexpr const char* kMeant = " (if they are meant so, \"as_given\": true in the take says it)";
    const double limit = kBelongs * box_diagonal(character_.vertices);
    std::string problem = "the shapes lie " + rounded(1e3 * found) + " mm from the skinned character (RMS";
    if (!misplacement.cause.empty()) {
      problem += "; " + rounded(1e3 * misplacement.left * found) + " mm without this): " + misplacement.cause;
    } else if (found > limit) {
      problem += "; expected below " + rounded(1e3 * limit) +
                 " mm): the shapes are of another motion, or their vertices stand in another order";
    } else {
      return;
    }
    result_.problems.push_back(problem + kMeant);
  }

  const Character& character_;
  const std::vector<Muscle>& muscles_;
  const DatasetTake& take_;
  ShapeReader reader_;
  Clip clip_;
  std::vector<std::size_t>
      solved_;  // samples, without those that training leaves out or does not see: they may be wrecks
  TakeCheck result_;
};

}  // namespace

std::vector<TakeCheck> check_dataset(const Dataset& dataset) {
  const Character character = read_character(dataset.folder / dataset.character, dataset.unit);
  std::vector<Muscle> muscles;
  if (!dataset.muscles.empty()) muscles = read_muscles(dataset.folder / dataset.muscles, character.skeleton);
  if (!dataset.materials.empty()) read_materials(dataset.folder / dataset.materials);
  anatomy_options(dataset, character.skeleton);
  read_regions(dataset, character);
  std::vector<TakeCheck> checks;
  for (const DatasetTake& take : dataset.takes) checks.push_back(TakeChecker(dataset, character, muscles, take).run());
  const bool sound = std::all_of(checks.begin(), checks.end(), [](const auto& take) { return take.problems.empty(); });
  if (sound && !dataset.modifiers.empty()) const ShapeStack fits(read_pose_database(dataset));
  return checks;
}

std::string first_problem(const std::vector<TakeCheck>& takes, const std::filesystem::path& path) {
  if (takes.empty()) return path.string() + " names no takes: nothing to train on";
  for (const TakeCheck& take : takes) {
    if (!take.problems.empty()) return path.string() + ", take '" + take.name + "': " + take.problems.front();
  }
  const auto is_unsolved = [](const TakeCheck& take) { return take.unconverged == take.samples; };
  if (!std::ranges::all_of(takes, is_unsolved)) return "";
  std::uint32_t frames = 0;
  for (const TakeCheck& take : takes) frames += take.samples;
  return path.string() + ": not one of its " + count_of(frames, "frame is", "frames is") +
         " solved, nothing to train on: they did not converge, or are not simulated yet; is the character as large as "
         "it should be?";
}

std::string describe_surface(const Character& character) {
  const Triangles once = each_once(character.triangles);
  const BadEdges bad = find_bad_edges(once);
  const std::size_t open = bad.open.size(), crowded = bad.shared.size();
  const int pieces = surface_pieces(character.vertices.rows(), character.triangles).count;
  std::string text = open == 0 ? "closed" : "open (" + std::to_string(open) + " boundary edges)";
  if (crowded > 0) text += ", not manifold (" + std::to_string(crowded) + " edges with more than two triangles)";
  const std::size_t twice = static_cast<std::size_t>(character.triangles.rows() - once.rows());
  if (twice > 0) text += ", " + count_of(twice, "triangle", "triangles") + " there twice";
  return text + ", " + std::to_string(pieces) + (pieces == 1 ? " piece" : " pieces");
}

}  // namespace bodyopt::trainer
