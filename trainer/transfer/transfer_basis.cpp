#include "trainer/transfer/transfer_basis.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/caches/shape_reader.h"
#include "assets/clips/matched_joints.h"
#include "base/frame_range.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "dataset/modifier.h"
#include "dataset/regions_file.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/basis/output_order.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/host/rig.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/features/features.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/provenance.h"
#include "trainer/train/skinning/unpose.h"
#include "trainer/transfer/carry_parts.h"
#include "trainer/transfer/skin_transfer.h"
#include "trainer/transfer/transfer_columns.h"

namespace bodyopt::trainer {
namespace {

// Gives the fibres' points places on the target's skin.
class FibreCarrier {
 public:
  FibreCarrier(const TransferPair& pair, const StrainTable& source)
      : pair_(pair),
        source_(source),
        triangles_(rows_of(pair.target.mesh.triangles)),
        places_on_target_(sure_places(pair)),
        nearest_(pair.correspondence.target, triangles_) {
    target_vertex_.resize(pair.source.mesh.vertex_count());
    if (!pair.correspondence.same_topology) return;
    const MeshTable &from = pair.source.mesh, &to = pair.target.mesh;
    for (std::uint32_t o = 0; o < from.output_count(); ++o) target_vertex_[from.output_vertex[o]] = to.output_vertex[o];
  }

  StrainTable carry() {
    StrainTable result = source_;
    result.vertices.clear();
    if (pair_.correspondence.same_topology) {
      for (const std::uint32_t vertex : source_.vertices) result.vertices.push_back(target_vertex_[vertex]);
      return result;
    }
    for (FibrePoint& point : result.points) point = carried(point, result.vertices);
    return result;
  }

 private:
  FibrePoint carried(const FibrePoint& point, std::vector<std::uint32_t>& vertices) {
    const auto corner = [&](std::uint32_t k) -> Eigen::Vector3d { return places_on_target_.row(source_.vertices[k]); };
    const SkinPoint at = nearest_(double{point.wa} * corner(point.a) + double{point.wb} * corner(point.b) +
                                  double{point.wc} * corner(point.c));
    std::uint32_t place[3];
    for (std::size_t k = 0; k < 3; ++k) place[k] = place_of(at.vertices[k], vertices);
    return {place[0],
            place[1],
            place[2],
            static_cast<float>(at.weights[0]),
            static_cast<float>(at.weights[1]),
            static_cast<float>(at.weights[2])};
  }

  std::uint32_t place_of(std::uint32_t vertex, std::vector<std::uint32_t>& vertices) {
    const auto [entry, added] = places_.emplace(vertex, static_cast<std::uint32_t>(vertices.size()));
    if (added) vertices.push_back(vertex);
    return entry->second;
  }

  const TransferPair& pair_;
  const StrainTable& source_;
  const Triangles triangles_;
  const Positions places_on_target_;  // of the source's vertices
  const NearestSkin nearest_;
  std::vector<std::uint32_t> target_vertex_;       // of each source vertex, for the same topology
  std::map<std::uint32_t, std::uint32_t> places_;  // of the target's vertices in the table's list
};

std::vector<float> strains_at_target_rest(const TransferPair& pair) {
  if (!pair.match.is_aligned()) return std::vector<float>(pair.source.strain.fibre_count(), 0.0f);
  return measure_strains(pair.source, pose_at_target_rest(pair.match, pair.source.skeleton));
}

// The fibres are strained at the target's rest as the source's are where it stands so. Lengths are what the run-time
// kernels measure: with a rest length of 1 m the strain is the length less one. A collapsed fibre keeps 1 m.
void measure_rest_lengths(const TransferPair& pair, Basis& basis) {
  const std::vector<float> strain_at_rest = strains_at_target_rest(pair);
  basis.strain.rest_length.assign(basis.strain.rest_length.size(), 1.0f);
  for (std::size_t k = 0; const float strain : measure_strains(basis, bind_pose(basis.skeleton))) {
    const float length = (1 + strain) / (1 + strain_at_rest[k]);
    basis.strain.rest_length[k++] = length > 1e-6f ? length : 1;
  }
}

// The source's coverage with the target's joints and number of vertices; the errors are those of the source.
CoverageTable carried_coverage(const TransferPair& pair) {
  const CoverageTable& source = pair.source.coverage;
  CoverageTable carried = source;
  if (source.empty()) return carried;
  const float share =
      static_cast<float>(pair.target.mesh.vertex_count()) / static_cast<float>(pair.source.mesh.vertex_count());
  for (float& size : carried.sizes) size *= share;
  for (float& growth : carried.growth) growth *= share;
  carried.joint_begin = {0};
  carried.joints.clear();
  for (std::size_t r = 0; r < source.sizes.size(); ++r) {
    for (std::uint32_t k = source.joint_begin[r]; k < source.joint_begin[r + 1]; ++k) {
      const int joint = pair.match.target_joint[source.joints[k]];
      if (joint >= 0) carried.joints.push_back(static_cast<std::uint32_t>(joint));
    }
    if (carried.joints.size() == carried.joint_begin.back()) carried.joints.push_back(0);  // the root moves all
    carried.joint_begin.push_back(static_cast<std::uint32_t>(carried.joints.size()));
  }
  return carried;
}

void carry_metadata(const TransferPair& pair, Basis& basis) {
  add_source(pair.source.metadata, basis.metadata);
  basis.metadata[kMatchedJoints] = to_json(pair.match, pair.source.skeleton, pair.target.skeleton)
                                       .dump(-1, ' ', false, Json::error_handler_t::replace);
  basis.coverage = carried_coverage(pair);
  const auto report = pair.source.metadata.find("report");
  if (report != pair.source.metadata.end()) basis.metadata["report"] = report->second;
}

constexpr std::size_t kFramesToSimulate = 20;

namespace fs = std::filesystem;

constexpr std::size_t kBatch = 32;  // frames in memory

// x_i = t_i + R_i (d_i + delta d_i) + origin, in output order; O x 3.
std::vector<float> posed_output(const Basis& basis, const Pose& pose, const Positions& displacements) {
  const RigFrame rig = pose_rig(basis.skeleton, pose);
  const std::uint32_t count = basis.mesh.vertex_count();
  std::vector<float> skin(3 * std::size_t{count});
  const std::vector<float> frames = cpu::vertex_frames(basis.ddm, count, rig.skinning.data());
  for (std::uint32_t v = 0; v < count; ++v) {
    const float *r = &frames[12 * std::size_t{v}], *t = r + 9;
    const DdmVertex& vertex = basis.ddm.vertices[v];
    const double local[3] = {vertex.offset_x + displacements(v, 0), vertex.offset_y + displacements(v, 1),
                             vertex.offset_z + displacements(v, 2)};
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = double{t[i]} + double{rig.origin[i]};
      for (std::size_t k = 0; k < 3; ++k) sum += double{r[3 * i + k]} * local[k];
      skin[3 * v + i] = static_cast<float>(sum);
    }
  }
  return output_of(basis.mesh, skin);
}

void copy_into(const fs::path& from, const fs::path& to) {
  constexpr std::uint64_t kMost = 1ull << 28;
  const std::string bytes = read_file(from, kMost, "a part of a dataset");
  write_file_atomically(to, std::as_bytes(std::span(bytes)));
}

class DatasetTransfer {
 public:
  DatasetTransfer(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                  const TransferTarget& target, const fs::path& out)
      : dataset_(dataset),
        source_character_(source_character),
        order_(morton_order(source_character.vertices)),
        pair_(pair),
        target_(target),
        out_(out) {
    result_.folder = out;
    result_.character = fs::proximate(fs::absolute(target.file), fs::absolute(out)).string();
    result_.unit = target.unit;
    result_.selections = carried_selections(dataset, pair);
  }

  TransferredDataset run() {
    std::error_code error;
    fs::create_directories(out_, error);
    if (error) throw Error(ErrorKind::file, out_, ": cannot be made: ", error.message());
    // One dataset, one character: what differs is refused before anything is written.
    there_ = open_dataset(with_names(), out_ / "dataset.json");
    require_no_own_takes(dataset_, out_);
    switch_off_refinements();
    write_anatomy();
    for (const DatasetTake& take : dataset_.takes) transfer_take(take);
    write_modifiers();
    return std::move(told_);
  }

 private:
  Dataset with_names() {
    if (!dataset_.muscles.empty()) result_.muscles = "muscles.json";
    if (!dataset_.materials.empty()) result_.materials = "materials.json";
    result_.body_fat = dataset_.body_fat;
    result_.kind = dataset_.kind;
    if (!dataset_.regions.empty()) result_.regions = "regions.json";
    return result_;
  }

  // A modifier of 'refine' belongs only over the shapes that it was made of, which are replaced.
  void switch_off_refinements() {
    const auto is_of_a_take = [&](const Modifier& modifier) {
      return modifier.enabled && std::ranges::any_of(dataset_.takes, [&](const DatasetTake& take) {
               return modifier.name == refinement_of(take.name);
             });
    };
    if (std::ranges::none_of(there_.modifiers, is_of_a_take)) return;
    edit_modifiers(out_ / "dataset.json", [&](const Dataset&, std::vector<Modifier>& modifiers) {
      for (Modifier& modifier : modifiers) {
        if (!is_of_a_take(modifier)) continue;
        modifier.enabled = false;
        told_.notes.push_back("the modifier '" + modifier.name +
                              "' is switched off: it is of the shapes that this transfer replaced; 'bodyopt transfer "
                              "refine' makes it anew");
      }
    });
  }

  // Parts that frames of the target's own were made with stay.
  bool is_to_write(const std::string& part) {
    const bool has_own = std::ranges::any_of(there_.takes, [](const DatasetTake& take) { return !take.carried; });
    if (part.empty() || !has_own || !fs::exists(out_ / part)) return !part.empty();
    told_.notes.push_back("its own " + part + " is kept: takes of its own go with it");
    return false;
  }

  void write_anatomy() {
    if (is_to_write(result_.muscles)) {
      const auto muscles = read_muscles(dataset_.folder / dataset_.muscles, source_character_.skeleton);
      write_muscles(carried_muscles(pair_, muscles, told_.notes), target_.character.skeleton, out_ / result_.muscles);
    }
    if (is_to_write(result_.materials)) copy_into(dataset_.folder / dataset_.materials, out_ / result_.materials);
    if (is_to_write(result_.regions)) write_carried_regions();
  }

  void write_carried_regions() {
    std::vector<RegionWeights> regions =
        carried_regions(pair_, renumbered(read_regions(dataset_, source_character_), inverse_of(order_)));
    regions = renumbered(regions, morton_order(target_.character.vertices));
    write_regions(regions, target_.character, out_ / result_.regions);
  }

  // Curation that is there already, of an earlier transfer or of the target's own, stays.
  void write_modifiers() {
    if (dataset_.modifiers.empty()) return;
    const std::vector<Modifier> carried =
        carried_modifiers(dataset_, source_character_, target_.character, pair_, out_, told_.notes);
    const Dataset there = read_dataset(out_ / "dataset.json");
    if (there.modifiers == carried) return;
    if (!there.modifiers.empty()) {
      told_.notes.push_back("the dataset has modifiers already: those of the source are not put into it");
      return;
    }
    edit_modifiers(out_ / "dataset.json",
                   [&](const Dataset&, std::vector<Modifier>& modifiers) { modifiers = carried; });
  }

  void transfer_take(const DatasetTake& take) {
    const Clip clip = read_clip(dataset_, take, source_character_.skeleton);
    DatasetTake carried = take;
    carried.clip = take.name + ".glb";
    carried.carried = true;
    carried.joint_map.clear();
    carried.up.clear();
    carried.shapes = take.name + ".pc2";
    carried.shapes_status = take.shapes_status.empty() ? "" : take.name + ".status.json";
    carried.controls = take.controls.empty() ? "" : take.name + ".controls.json";
    const Clip moved = moved_clip(clip);
    const TakeLock lock(out_ / carried.shapes);  // until dataset.json names what the shapes are of
    write_clip(moved, target_.character.skeleton, target_.unit, out_ / carried.clip);
    if (!take.controls.empty()) copy_into(dataset_.folder / take.controls, out_ / carried.controls);
    write_shapes(take, clip, moved, out_ / carried.shapes);
    if (!take.shapes_status.empty()) write_status(take, out_ / carried.shapes_status);
    put_take(result_, carried, out_ / "dataset.json");
    ++told_.takes;
    told_.frames += take.frames.size();
  }

  Clip moved_clip(const Clip& clip) const {
    Clip moved = clip;
    for (Pose& pose : moved.poses) {
      pose = transferred_pose(pair_.match, source_character_.skeleton, target_.character.skeleton, pose);
    }
    return moved;
  }

  void write_shapes(const DatasetTake& take, const Clip& clip, const Clip& moved, const fs::path& path) {
    const ShapeReader shapes(dataset_.folder / take.shapes);
    const auto count = static_cast<std::uint32_t>(take.frames.size());
    Pc2Writer writer(path, target_.character.output_count(), count,
                     take.frames.empty() ? 1 : static_cast<float>(take.frames.front()), frame_spacing(take.frames));
    Progress progress("transfer: " + take.name, take.frames.size());
    for (std::size_t first = 0; first < count; first += kBatch) {
      std::vector<std::vector<float>> batch(std::min(kBatch, count - first));
      parallel_for(batch.size(), [&](std::size_t k) {
        const auto frame = static_cast<std::size_t>(take.frames[first + k] - clip.first_frame);
        const std::vector<float> sample = shapes.sample(static_cast<std::uint32_t>(first + k));
        const Positions shape = in_order(welded_from_output(source_character_, sample.data()), order_);
        batch[k] = posed_output(pair_.target, moved.poses.at(frame),
                                pair_.skin(unpose_ddm(pair_.source, clip.poses.at(frame), shape)));
        progress.advance();
      });
      for (const std::vector<float>& frame : batch) writer.append(frame);
    }
    writer.close();
  }

  // No longer of these inputs: shapes from elsewhere, which simulate does not replace.
  void write_status(const DatasetTake& take, const fs::path& path) const {
    std::vector<FrameStatus> status = read_frame_status(dataset_.folder / take.shapes_status);
    for (FrameStatus& frame : status) frame.inputs = 0;
    write_frame_status(status, path);
  }

  const Dataset& dataset_;
  const Character& source_character_;
  const std::vector<std::uint32_t> order_;
  const TransferPair& pair_;
  const TransferTarget& target_;
  const fs::path out_;
  Dataset result_, there_;  // what is written; what was there before
  TransferredDataset told_;
};

}  // namespace

Basis transfer_basis(const TransferPair& pair, const TransferOptions& options, std::vector<std::string>& notes) {
  Basis result = pair.target;
  result.strain = FibreCarrier(pair, pair.source.strain).carry();
  result.residual = pair.source.residual;
  result.skeleton.features = carried_features(pair.source.skeleton, pair.target.skeleton, pair.match);
  measure_rest_lengths(pair, result);
  ResidualTable columns = pair.source.residual;
  transfer_columns(pair.skin, pair.source.mesh.vertex_count(), pair.target.mesh.vertex_count(), options.tolerance,
                   columns);
  result.residual.blend = std::move(columns.blend);
  result.residual.blend_begin = std::move(columns.blend_begin);
  carry_metadata(pair, result);
  if (!pair.source.modifiers.empty()) {
    notes.emplace_back(
        "the modifiers of the source are left out: they were made of its body; 'bodyopt modifiers' makes them of the "
        "target's");
  }
  validate(result, "the transferred basis");
  return result;
}

double relative_volume(const MeshTable& mesh, std::span<const float> output) {
  const Triangles triangles = rows_of(mesh.triangles);
  return enclosed_volume(rows_of(vertices_of(mesh, output)), triangles) /
         enclosed_volume(rows_of(mesh.rest), triangles);
}

std::string frames_to_simulate(std::span<const int> frames, const std::vector<double>& expected_mm) {
  std::vector<int> chosen;
  for (const std::size_t k :
       worth_simulating(expected_mm, kFramesToSimulate, spreading_gap(frames.size(), kFramesToSimulate))) {
    if (expected_mm[k] > 0) chosen = unite_frames(chosen, {frames[k]});
  }
  return format_frame_range(chosen);
}

std::string frames_to_simulate(const Basis& basis, const Clip& clip) {
  if (basis.coverage.empty()) return "";
  std::vector<int> frames;
  std::vector<double> expected;
  for (const ExpectedError& error : expected_errors(basis, clip.poses)) {
    frames.push_back(clip.first_frame + static_cast<int>(frames.size()));
    expected.push_back(error.rms_mm);
  }
  return frames_to_simulate(frames, expected);
}

void require_no_own_takes(const Dataset& dataset, const fs::path& out) {
  const fs::path path = out / "dataset.json";
  if (!fs::exists(path)) return;
  for (const DatasetTake& there : read_dataset(path).takes) {
    const auto has_its_name = [&](const DatasetTake& take) { return take.name == there.name; };
    if (there.carried || std::ranges::none_of(dataset.takes, has_its_name)) continue;
    throw Error(ErrorKind::mismatch, path, " has a take '", there.name,
                "' of its own, whose shapes the source's take of that name would replace: give --out another "
                "folder, or the source's take another name");
  }
}

TransferredDataset transfer_dataset(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                                    const TransferTarget& target, const fs::path& out) {
  return DatasetTransfer(dataset, source_character, pair, target, out).run();
}

}  // namespace bodyopt::trainer
