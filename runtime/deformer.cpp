#include "runtime/deformer.h"

#include <algorithm>
#include <chrono>

#include "runtime/basis/error.h"
#include "runtime/rig.h"

namespace bodyopt {
namespace {

std::unique_ptr<Backend> make_backend(const Basis& basis, const DeviceChoice& choice) {
  if (choice.name == "cpu") {
    if (choice.require_device) {
      throw Error(ErrorKind::device, "the device 'cpu' was asked for together with a required Vulkan device");
    }
    return make_cpu_backend(basis);
  }
  if (choice.name != "auto" || choice.require_device) return make_vulkan_backend(basis, choice);
  if (!has_vulkan_device()) return make_cpu_backend(basis);
  return make_vulkan_backend(basis, choice);
}

Batch make_batch(const Basis& basis, std::span<const Pose> poses) {
  Batch batch;
  batch.frame_count = static_cast<std::uint32_t>(poses.size());
  const std::size_t controls = basis.residual.controls.size();
  for (const Pose& pose : poses) {
    const RigFrame rig = pose_rig(basis.skeleton, pose);
    batch.skinning.insert(batch.skinning.end(), rig.skinning.begin(), rig.skinning.end());
    batch.origins.insert(batch.origins.end(), {rig.origin[0], rig.origin[1], rig.origin[2], 0.0f});
    batch.joint_features.insert(batch.joint_features.end(), rig.joint_features.begin(), rig.joint_features.end());
    if (!pose.controls.empty() && pose.controls.size() != controls) {
      throw Error(ErrorKind::mismatch, "a pose has " + std::to_string(pose.controls.size()) +
                                           " control values, the basis has " + std::to_string(controls) + " controls");
    }
    std::vector<float> values = pose.controls;
    values.resize(controls, 0.0f);
    batch.controls.insert(batch.controls.end(), values.begin(), values.end());
  }
  return batch;
}

// Frame-major V x 3 in runtime order to O x 3 in output order, appended.
void append_output(const MeshTable& mesh, std::span<const float> values, std::vector<float>& out) {
  const std::size_t stride = 3 * std::size_t{mesh.vertex_count()};
  for (std::size_t begin = 0; stride > 0 && begin < values.size(); begin += stride) {
    for (const std::uint32_t v : mesh.output_vertex) {
      const float* x = values.data() + begin + 3 * std::size_t{v};
      out.insert(out.end(), x, x + 3);
    }
  }
}

}  // namespace

std::string feature_name(const Basis& basis, std::uint32_t feature) {
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  if (feature < 9 * joints.size()) return "joint " + basis.skeleton.joints[joints[feature / 9]].name;
  const std::size_t strain = feature - 9 * joints.size();
  if (strain < basis.strain.fibre_count()) return "strain " + basis.strain.names[strain];
  return "control " + basis.residual.controls.at(strain - basis.strain.fibre_count());
}

Deformer::Deformer(Basis basis, const DeviceChoice& choice) : basis_(std::move(basis)) {
  validate(basis_, "the basis");
  backend_ = make_backend(basis_, choice);
  // The rest coefficients come from the kernels that will run, so that rest gives rest exactly.
  const Pose rest = bind_pose(basis_.skeleton);
  backend_->set_rest_coefficients(backend_->run(make_batch(basis_, {&rest, 1})).coefficients);
}

Deformer::~Deformer() = default;

std::string Deformer::device_name() const { return backend_->name(); }

Evaluation Deformer::evaluate(std::span<const Pose> poses) {
  Evaluation evaluation;
  const std::size_t limit = std::max<std::size_t>(1, backend_->batch_limit());
  const std::size_t features = basis_.residual.feature_count();
  for (std::size_t begin = 0; begin < poses.size(); begin += limit) {
    const auto part = poses.subspan(begin, std::min(limit, poses.size() - begin));
    const auto start = std::chrono::steady_clock::now();
    const Batch batch = make_batch(basis_, part);
    evaluation.stage_seconds["rig"] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const BatchResult result = backend_->run(batch);
    append_output(basis_.mesh, result.positions, evaluation.positions);
    append_output(basis_.mesh, result.normals, evaluation.normals);
    evaluation.strains.insert(evaluation.strains.end(), result.strains.begin(), result.strains.end());
    for (std::size_t f = 0; f < part.size(); ++f) {
      const auto begin_excess = result.excess.begin() + static_cast<std::ptrdiff_t>(f * features);
      const auto worst = std::max_element(begin_excess, begin_excess + static_cast<std::ptrdiff_t>(features));
      evaluation.outside.push_back(features > 0 ? *worst : 0.0f);
      evaluation.outside_feature.push_back(static_cast<std::uint32_t>(worst - begin_excess));
    }
    for (const auto& [stage, seconds] : result.stage_seconds) evaluation.stage_seconds[stage] += seconds;
  }
  return evaluation;
}

}  // namespace bodyopt
