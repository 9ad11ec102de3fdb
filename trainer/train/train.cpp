#include "trainer/train/train.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "runtime/basis/error.h"
#include "trainer/train/ddm.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/residual.h"
#include "trainer/train/strain.h"
#include "trainer/train/unpose.h"

namespace bodyopt {
namespace {

constexpr std::size_t kFewestFrames = 10;

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

double smoothing_radius(const Character& character, const TrainOptions& options) {
  return options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(character.vertices);
}

// `character` in runtime order.
Basis ddm_basis(const Character& character, const TrainOptions& options) {
  if (character.vertices.rows() == 0 || character.skeleton.size() == 0) {
    throw Error(ErrorKind::mismatch, "character '" + character.name + "' has no skin or no joints: nothing to train");
  }
  if (options.smoothing_steps < 1 || options.components < 1 || options.centres < 0) {
    throw Error(ErrorKind::usage, "training needs at least one smoothing step, one component and no negative count");
  }
  Basis basis;
  basis.skeleton = character.skeleton;
  basis.mesh = make_mesh_table(character);
  basis.ddm = pack_ddm(ddm_moments(character.vertices, character.triangles, character.weights,
                                   {.radius = smoothing_radius(character, options), .steps = options.smoothing_steps}));
  basis.strain.fibre_begin = {0};
  basis.residual.blend_begin.assign(std::size_t{basis.mesh.vertex_count()} + 1, 0u);
  basis.metadata["units"] = "metres, radians";
  basis.metadata["topology_hash"] = hex(topology_hash(basis.mesh));
  basis.metadata["skeleton_hash"] = hex(skeleton_hash(basis.skeleton));
  return basis;
}

nlohmann::json provenance(const Character& character, const TrainOptions& options) {
  return {{"character", character.name},
          {"smoothing_radius", smoothing_radius(character, options)},
          {"smoothing_steps", options.smoothing_steps}};
}

void check_samples(const SampleSet& set) {
  if (set.train.size() < kFewestFrames) {
    throw Error(ErrorKind::mismatch, "training needs at least " + std::to_string(kFewestFrames) +
                                         " converged frames that are not held out, found " +
                                         std::to_string(set.train.size()) + ": simulate more frames or hold out fewer");
  }
  for (const Sample& sample : set.train) {
    if (sample.shape.rows() != set.character.vertices.rows()) {
      throw Error(ErrorKind::mismatch, "the shape of frame " + std::to_string(sample.frame) + " has " +
                                           std::to_string(sample.shape.rows()) + " vertices, the character has " +
                                           std::to_string(set.character.vertices.rows()) +
                                           ": it was made from another mesh");
    }
  }
}

// RMS length of displacements, millimetres.
class RootMeanSquare {
 public:
  void add(const Positions& delta) {
    squares_ += delta.squaredNorm();
    count_ += static_cast<double>(delta.rows());
  }
  double millimetres() const { return count_ > 0 ? 1000 * std::sqrt(squares_ / count_) : 0; }

 private:
  double squares_ = 0, count_ = 0;
};

}  // namespace

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  Basis basis = ddm_basis(in_order(character, morton_order(character.vertices)), options);
  basis.metadata["provenance"] = provenance(character, options).dump();
  return basis;
}

Basis train(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  const Character character = in_order(set.character, order);
  Basis basis = ddm_basis(character, options);
  std::vector<std::string> notes;
  if (!options.joint_only_linear) {
    basis.strain = make_strain_table(basis.mesh, basis.ddm, basis.skeleton, set.muscles, notes);
  }
  train_residual(basis, character, order, set.train, options);

  nlohmann::json record = provenance(set.character, options);
  record["components"] = options.components;
  record["centres"] = options.centres;
  record["seed"] = options.seed;
  record["joint_only_linear"] = options.joint_only_linear;
  record["train_frames"] = set.train.size();
  record["heldout_frames"] = set.heldout.size();
  record["unconverged_frames"] = set.unconverged;
  record["notes"] = notes;
  basis.metadata["provenance"] = record.dump();
  return basis;
}

UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  RootMeanSquare lbs, ddm;
  for (const Sample& sample : set.train) {
    lbs.add(unpose_linear(set.character, sample.pose, sample.shape));
    ddm.add(unpose_ddm(basis, sample.pose, in_order(sample.shape, order)));
  }
  return {lbs.millimetres(), ddm.millimetres()};
}

}  // namespace bodyopt
