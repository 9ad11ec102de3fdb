#include "trainer/simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/pc2.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/spread_evenly.h"
#include "runtime/core/error.h"
#include "trainer/simulate/body_hash.h"
#include "trainer/simulate/check_muscles.h"
#include "trainer/simulate/loose_piece_stretch.h"
#include "trainer/simulate/partial_shapes.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/second_order.h"

namespace bodyopt::trainer {
namespace {

// The middles of edges of tets of second order not counted; those of a lattice are linear. Skins with more vertices
// show more parts, such as fingers, and contact misses folds that are finer than the tets. A human of 13,380 vertices
// keeps 28 mm of skin in skin in one of four frames with 4,000 nodes, 2 mm with 6,000. The arm has half as many
// vertices. With 600, 950, 1,900, 3,000 and 4,000 nodes it is 1.6, 1.1, 0.9, 0.7 and 0.5 mm (RMS) from second-order
// tets in the skin itself. Skins of fewer vertices have as many as their own resolution bears (fill_coarser).
constexpr double kMostNodes = 6000, kFinestSkin = 13000, kFewestNodes = 2000;
constexpr double kDraftNodesOfVertex = 0.15, kFewestOfDraft = 600;

CageLimits limits_of(const Character& character, bool draft) {
  const double vertices = static_cast<double>(character.vertices.rows());
  const double nodes =
      draft ? kDraftNodesOfVertex * vertices : kMostNodes * std::pow(std::min(vertices / kFinestSkin, 1.0), 1.5);
  const auto limit = static_cast<Eigen::Index>(std::clamp(nodes, draft ? kFewestOfDraft : kFewestNodes, kMostNodes));
  if (draft) return {limit, 1500, 1200, 1500};
  return {limit, static_cast<Eigen::Index>(kMostNodes), std::numeric_limits<Eigen::Index>::max(), 5000};
}

const Pose& pose_of(const Clip& clip, int frame) {
  if (frame < clip.first_frame || frame > clip.last_frame()) {
    throw Error(ErrorKind::usage, "frame " + std::to_string(frame) + " is not in clip '" + clip.name +
                                      "', whose frames are " + std::to_string(clip.first_frame) + "-" +
                                      std::to_string(clip.last_frame()));
  }
  return clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
}

void require_distinct(const std::vector<int>& frames) {
  if (frames.empty()) throw Error(ErrorKind::usage, "there are no frames to simulate");
  std::set<int> seen;
  for (const int frame : frames) {
    if (!seen.insert(frame).second) {
      throw Error(ErrorKind::usage, "frame " + std::to_string(frame) + " is to be simulated twice");
    }
  }
}

void require_flexes(const Clip& clip, const Pose& pose, int frame) {
  for (std::size_t c = 0; c < clip.controls.size(); ++c) {
    const float value = pose.controls[c];
    if (value >= 0 && value <= 1) continue;
    throw Error(ErrorKind::mismatch, "control '" + clip.controls[c] + "' is " + std::to_string(value) + " in frame " +
                                         std::to_string(frame) + ": muscles flex by 0 (relaxed) to 1 (all they can)");
  }
}

// A frame to solve; frames of the same key have the same shape.
struct Job {
  std::uint64_t key;
  const Pose* pose;
  std::vector<double> flex;  // per muscle; empty: none
};

// How far a pose's controls flex each muscle: the hardest of those that flex it.
std::vector<double> flex_of(const Pose& pose, const std::vector<std::vector<std::size_t>>& flexed,
                            std::size_t muscles) {
  std::vector<double> flex(flexed.empty() ? 0 : muscles, 0.0);
  for (std::size_t c = 0; c < flexed.size(); ++c) {
    for (const std::size_t m : flexed[c]) flex[m] = std::max(flex[m], static_cast<double>(pose.controls[c]));
  }
  return flex;
}

std::vector<Job> jobs_of(const QuasiStaticBody& body, const std::vector<Muscle>& muscles, const Clip& clip,
                         const std::vector<int>& frames) {
  const std::vector<std::vector<std::size_t>> flexed = flexed_muscles(clip.controls, muscles);
  std::vector<Job> jobs;
  for (const int frame : frames) {
    const Pose& pose = pose_of(clip, frame);
    require_flexes(clip, pose, frame);
    require_unscaled(body.skeleton(), clip, frame);
    const std::vector<double> flex = flex_of(pose, flexed, muscles.size());
    jobs.push_back({pose_hash(body.hash(), pose, flex), &pose, flex});
  }
  return jobs;
}

using NodesOfFrame = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

// A cache keeps the shape of a sample, or a draft's nodes.
std::vector<float> stored_sample(const Pc2Reader& cache, std::uint32_t k) { return cache.sample(k); }
std::vector<float> stored_sample(const NodesReader& cache, std::uint32_t k) {
  const NodesOfFrame nodes = cache.nodes(k).cast<float>();
  return {nodes.data(), nodes.data() + nodes.size()};
}

// Takes the frames of the jobs over from a finished cache.
void adopt_finished(const std::filesystem::path& cache, const std::filesystem::path& status,
                    const SimulateOptions& options, const std::vector<Job>& jobs, std::size_t values,
                    PartialShapes& partial) {
  if (!std::filesystem::exists(cache) || !std::filesystem::exists(status)) return;
  const std::vector<FrameStatus> finished = read_frame_status(status);
  std::set<std::uint64_t> wanted;
  for (const Job& job : jobs) wanted.insert(job.key);
  const auto other = std::count_if(finished.begin(), finished.end(),
                                   [&](const FrameStatus& frame) { return !wanted.contains(frame.inputs); });
  if (other > 0) {
    options.warn(
        std::to_string(other) + " finished frames in " + cache.string() +
        " are of other inputs (character, muscles, materials, body fat, kind, tet size, motion, controls or version) and will be "
        "replaced");
  }
  const auto adopt = [&](const auto& reader) {
    if (reader.sample_count() != finished.size()) return;
    for (std::size_t k = 0; k < finished.size(); ++k) {
      const std::uint64_t key = finished[k].inputs;
      if (!wanted.contains(key) || partial.has(key) || !is_final(finished[k], options.give_up_after)) continue;
      const std::vector<float> sample = stored_sample(reader, static_cast<std::uint32_t>(k));
      if (sample.size() == values) partial.append(key, finished[k], sample);
    }
  };
  if (options.draft) {
    adopt(NodesReader(cache));
  } else {
    adopt(Pc2Reader(cache));
  }
}

// Jobs not solved yet, each once.
std::vector<Job> open_jobs(const std::vector<Job>& jobs, const PartialShapes& partial) {
  std::vector<Job> open;
  std::set<std::uint64_t> seen;
  for (const Job& job : jobs) {
    if (!partial.has(job.key) && seen.insert(job.key).second) open.push_back(job);
  }
  return open;
}

// Solves the jobs on some threads. A pose is solved by one thread alone, so their number changes no bit.
// stored: what the partial file keeps of the nodes.
void solve_all(const QuasiStaticBody& body, const std::vector<Job>& jobs, int threads,
               const std::function<std::vector<float>(const Positions&)>& stored, PartialShapes& partial) {
  Progress progress("simulate", jobs.size(), "the finished frames are kept: run it again to go on");
  std::mutex mutex;  // over partial and progress
  const auto solve = [&](std::size_t k) {
    const SolvedPose solved = body.solve(*jobs[k].pose, jobs[k].flex);
    const std::vector<float> values = stored(solved.nodes);
    const std::lock_guard<std::mutex> lock(mutex);
    partial.append(jobs[k].key, solved.status, values);
    progress.advance();
  };
  parallel_for(jobs.size(), solve, threads);
}

// The places of the output vertices in a cage.
std::vector<EmbeddedPoint> output_embedding(const Character& character, const QuasiStaticBody& body) {
  std::vector<EmbeddedPoint> points;
  for (const std::uint32_t v : character.output_vertex) points.push_back(body.embedding()[v]);
  return points;
}

// `check` foresees the same cage.
std::string solved_in(const Cage& cage) {
  const std::string what = cage.is_lattice        ? "a lattice"
                           : !cage.is_own_skin    ? "a coarser skin"
                           : cage.mending.empty() ? "the skin"
                                                  : "the mended skin";
  return "solved in " + what + " of " + std::to_string(cage.mesh.nodes.rows()) + " nodes";
}

}  // namespace

// Tissue has the size it has; a scaled bone would leave it or tear it.
void require_unscaled(const Skeleton& skeleton, const Clip& clip, int frame) {
  constexpr double kMostScaling = 1e-3;
  const Pose& pose = pose_of(clip, frame);
  for (std::size_t j = 0; j < skeleton.size() && j < pose.joints.size(); ++j) {
    const Vec3 &scale = pose.joints[j].scale, &rest = skeleton.joints[j].bind.scale;
    if (length(scale - rest) < kMostScaling) continue;
    throw Error(ErrorKind::mismatch, "clip '" + clip.name + "': joint '" + skeleton.joints[j].name + "' is scaled by " +
                                         std::to_string(scale[0] / rest[0]) + ", " +
                                         std::to_string(scale[1] / rest[1]) + ", " +
                                         std::to_string(scale[2] / rest[2]) + " in frame " + std::to_string(frame) +
                                         ": bones that change their size cannot be simulated; remove the scale");
  }
}

AnatomyOptions anatomy_options(const Dataset& dataset, const Skeleton& skeleton) {
  AnatomyOptions options;
  if (!dataset.corrections.empty()) {
    options.corrections = read_corrections(dataset.folder / dataset.corrections, skeleton);
    options.body_fat = options.corrections.body_fat.value_or(options.body_fat);
    options.kind = options.corrections.kind;
  }
  if (dataset.body_fat > 0) options.body_fat = dataset.body_fat;
  if (!dataset.kind.empty()) options.kind = body_kind_of(dataset.kind);
  if (!dataset.kind.empty() && !options.kind) {
    throw Error(ErrorKind::file, (dataset.folder / "dataset.json").string() + ": 'kind' is '" + dataset.kind +
                                     "', expected one of " + body_kind_names() + ": misspelt?");
  }
  return options;
}

Cage choose_cage(const Character& of, const SimulateOptions& options) {
  if (!(options.tet_size > 0)) {
    return make_cage(of.vertices, of.triangles, of.weights, limits_of(of, options.draft));
  }
  try {
    return own_cage(of.vertices, of.triangles, of.weights, options.tet_size);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    Cage cage = lattice_cage_of_size(of.vertices, of.triangles, of.weights, options.tet_size);
    cage.why_lattice = error;
    return cage;
  }
}

std::string glued_parts(const Cage& cage, const Character& character) {
  constexpr std::size_t kFewest = 3;  // vertices that make a part
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> counts;
  for (const GluedVertex& glued : cage.glued) {
    ++counts[std::minmax(character.weights[glued.vertex].front().joint, glued.joint)];
  }
  std::vector<std::pair<std::size_t, std::string>> parts;
  for (const auto& [joints, count] : counts) {
    if (count < kFewest) continue;
    parts.emplace_back(count, "'" + character.skeleton.joints[joints.first].name + "' and '" +
                                  character.skeleton.joints[joints.second].name + "' (" + std::to_string(count) +
                                  " vertices)");
  }
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (const auto& [count, part] : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

AnatomyField look_inside(const Character& character, const std::vector<Muscle>& muscles,
                         const SimulateOptions& options) {
  try {
    return {character, muscles, options.anatomy};
  } catch (const Error& error) {
    if (error.cause() != ErrorCause::flat) throw;
    options.warn(std::string(error.what()) + "; it is simulated as fat, held where its skin follows one joint");
    return {};
  }
}

namespace {

// Lattices, and what has more nodes than frames or drafts are to have, stay linear.
QuasiStaticBody body_in(const Cage& cage, const Character& character, const std::vector<Muscle>& muscles,
                        const AnatomyField& anatomy, const SimulateOptions& options) {
  QuasiStaticBody linear(character, muscles, anatomy, cage, options.materials);
  linear.give_up_after(options.give_up_after);
  const CageLimits limits = limits_of(character, options.draft);
  const Eigen::Index most = options.draft ? limits.nodes : limits.finer_nodes;
  if (cage.is_lattice || cage.mesh.nodes.rows() > most) return linear;
  QuasiStaticBody body(character, muscles, anatomy, second_order(cage), options.materials);
  body.give_up_after(options.give_up_after);
  body.walk_in(std::make_unique<QuasiStaticBody>(std::move(linear)));
  return body;
}

// Estimates the discretisation error of some frames of a take.
void add_errors(const QuasiStaticBody& body, const std::vector<Job>& jobs,
                const std::function<Positions(std::size_t)>& skin, std::vector<FrameStatus>& status) {
  constexpr std::size_t kFrames = 3;
  std::vector<std::size_t> converged;
  for (std::size_t k = 0; k < status.size(); ++k) {
    if (status[k].converged) converged.push_back(k);
  }
  for (const std::size_t n : spread_evenly(converged.size(), kFrames)) {
    const std::size_t k = converged[n];
    status[k].discretisation_error = body.discretisation_error(*jobs[k].pose, jobs[k].flex, skin(k));
  }
}

}  // namespace

QuasiStaticBody make_body(const Character& character, const std::vector<Muscle>& muscles,
                          const SimulateOptions& options) {
  return make_body(character, muscles, look_inside(character, muscles, options), options);
}

QuasiStaticBody make_body(const Character& character, const std::vector<Muscle>& muscles, const AnatomyField& anatomy,
                          const SimulateOptions& options) {
  const Cage cage = choose_cage(character, options);
  options.inform(solved_in(cage));
  if (cage.is_lattice) {
    options.warn("it is simulated in a lattice: " + std::string(cage.why_lattice->what()));
  }
  if (!cage.mending.empty()) options.warn("the skin was mended for the simulation alone: " + cage.mending);
  if (const std::string glued = glued_parts(cage, character); !glued.empty()) {
    options.warn("the cage cannot split what nearly touches at rest, and holds together: " + glued);
  }
  return body_in(cage, character, muscles, anatomy, options);
}

QuasiStaticBody make_compared_body(const Character& character, const std::vector<Muscle>& muscles,
                                   const SimulateOptions& options) {
  constexpr Eigen::Index kFewer = 3;
  const AnatomyField anatomy = look_inside(character, muscles, options);
  QuasiStaticBody body = make_body(character, muscles, anatomy, options);
  if (options.tet_size > 0) return body;
  try {
    const Cage coarser =
        filled_cage(character.vertices, character.triangles, character.weights, body.corner_count() / kFewer);
    body.compare_with(std::make_unique<QuasiStaticBody>(body_in(coarser, character, muscles, anatomy, options)));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;  // it is not for the skin
  }
  return body;
}

SolvedPose solve_frame(const QuasiStaticBody& body, const std::vector<Muscle>& muscles, const Clip& clip, int frame) {
  const Job job = jobs_of(body, muscles, clip, {frame}).front();
  return body.solve(*job.pose, job.flex);
}

std::uint64_t frame_key(const QuasiStaticBody& body, const std::vector<Muscle>& muscles, const Clip& clip, int frame) {
  return jobs_of(body, muscles, clip, {frame}).front().key;
}

std::vector<FrameStatus> simulate(const QuasiStaticBody& body, const Character& character,
                                  const std::vector<Muscle>& muscles, const Clip& clip, const std::vector<int>& frames,
                                  const TakeLock& take, const std::filesystem::path& status,
                                  const SimulateOptions& options) {
  require_distinct(frames);
  const std::string thin = check_muscles(character, muscles, body);
  if (!thin.empty()) options.warn(thin);
  const std::filesystem::path& cache = take.cache();
  std::filesystem::path partial_path = cache;
  partial_path += ".partial";
  const Eigen::Index node_count = body.node_count();
  const auto values =
      static_cast<std::size_t>(3 * (options.draft ? node_count : Eigen::Index{character.output_count()}));
  const auto stored = [&](const Positions& nodes) {
    return options.draft ? floats_of(nodes) : output_from_welded(character, body.skin(nodes));
  };
  const std::vector<Job> jobs = jobs_of(body, muscles, clip, frames);
  PartialShapes partial(partial_path, body.hash(), values, options.give_up_after, options.warn);
  adopt_finished(cache, status, options, jobs, values, partial);
  solve_all(body, open_jobs(jobs, partial), options.threads, stored, partial);

  const auto skin_of = [&](const std::vector<float>& sample) {
    return options.draft ? body.skin(Eigen::Map<const NodesOfFrame>(sample.data(), node_count, 3).cast<double>())
                         : welded_from_output(character, sample.data());
  };
  LoosePieceStretch stretch(character, body.riding());
  std::vector<FrameStatus> result;
  const auto write_frames = [&](auto& writer, const auto& append) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      FrameStatus& of_frame = result.emplace_back();
      const std::vector<float> sample = partial.read(jobs[k].key, of_frame);
      append(sample);
      if (!body.riding().empty()) stretch.add(frames[k], skin_of(sample));
      of_frame.frame = frames[k];
      of_frame.converged = is_converged(of_frame);
      of_frame.inputs = jobs[k].key;
    }
    add_errors(
        body, jobs,
        [&](std::size_t k) {
          FrameStatus unused;
          return skin_of(partial.read(jobs[k].key, unused));
        },
        result);
    // A side-car never stands beside shapes that it does not describe. After a kill in between, the unfinished file
    // still has every frame.
    std::filesystem::remove(status);
    writer.close();
    write_frame_status(result, status);
  };
  if (options.draft) {
    NodesWriter writer(cache, body.carriers(), output_embedding(character, body), body.hash(), frames);
    write_frames(writer, [&](const std::vector<float>& nodes) {
      writer.append(Eigen::Map<const NodesOfFrame>(nodes.data(), node_count, 3).cast<double>());
    });
  } else {
    Pc2Writer writer(cache, character.output_count(), static_cast<std::uint32_t>(frames.size()),
                     static_cast<float>(frames.front()), frame_spacing(frames));
    write_frames(writer, [&](const std::vector<float>& shape) { writer.append(shape); });
  }
  partial.remove();
  if (const std::string stretched = stretch.warning(); !stretched.empty()) options.warn(stretched);
  return result;
}

}  // namespace bodyopt::trainer
