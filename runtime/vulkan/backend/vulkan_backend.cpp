// A Vulkan device as a backend: tables uploaded once; one command buffer per batch. For the quasi-static skin it is
// recorded when the number of frames changes, and submitted again otherwise. Every batch that jiggles is recorded
// according to a plan of its own.
#include "runtime/vulkan/backend/vulkan_backend.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/host/output_steps.h"
#include "runtime/host/stages.h"
#include "runtime/vulkan/backend/attached_meshes.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_dynamics.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace vulkan {
namespace {

constexpr std::uint64_t kBatchBytes = 64u << 20;  // of per-frame buffers; enough vertices to fill a device

// Values of a batch: a buffer of F x count floats, on the device. Batches of fewer frames use its beginning.
struct Values {
  Values(const Device& device, std::uint32_t frames, std::uint64_t count, const char* name)
      : frame_bytes(count * sizeof(float)), buffer(device, frames * frame_bytes, Memory::device, name) {}

  BufferRange of(std::uint32_t frames) const { return {buffer, 0, frames * frame_bytes}; }

  VkDeviceSize frame_bytes;
  Buffer buffer;
};

// For so many frames at most.
struct BatchBuffers {
  // `records`: for the host program, whose command buffer brings what a batch brings, and whose buffers take the
  // result.
  BatchBuffers(const Device& device, const FrameCounts& n, std::uint32_t frames_, bool records)
      : frames(frames_),
        skinning(device, frames, std::uint64_t{12} * n.joints, "the skinning matrices"),
        origins(device, frames, 4, "the origins"),
        joint_features(device, frames, n.joint_features, "the joint features"),
        controls(device, frames, n.controls, "the controls"),
        fades(device, frames, n.regions, "the fades"),
        modifiers(device, frames, n.components, "the modifiers' weights"),
        learned_skinning(device, frames, std::uint64_t{12} * n.turned_joints, "the skinning matrices of the strains"),
        strain_positions(device, frames, std::uint64_t{3} * n.strain_vertices, "the strain positions"),
        strains(device, frames, n.fibres, "the strains"),
        features(device, frames, n.features, "the features"),
        excess(device, frames, n.features, "the features' excess"),
        coordinates(device, frames, n.coordinates, "the coordinates"),
        kernels(device, frames, n.centres, "the kernels"),
        coefficients(device, frames, n.coefficients, "the coefficients"),
        displacements(device, frames, std::uint64_t{3} * n.vertices, "the displacements"),
        positions(device, frames, std::uint64_t{3} * n.vertices, "the positions"),
        finished{Values(device, frames, n.finished, "the finished skin"),
                 Values(device, frames, n.finished, "the finished skin"),
                 Values(device, frames, n.finished, "the finished skin")},
        boxes(device, frames, std::uint64_t{6} * n.boxes, "the boxes of triangles"),
        normals(device, frames, std::uint64_t{3} * n.vertices, "the normals"),
        tangents(device, frames, records ? 0 : n.tangents, "the tangents"),
        staging_in(device, records ? 0 : frames * frame_bytes(inputs()), Memory::staging, "staging"),
        staging_out(device, records ? 0 : frames * frame_bytes(outputs()), Memory::staging, "staging") {}

  // The inputs of a batch, in the order in which they are staged.
  std::array<const Values*, 7> inputs() const {
    return {&skinning, &origins, &joint_features, &controls, &fades, &modifiers, &learned_skinning};
  }
  static std::array<std::span<const float>, 7> inputs_of(const Batch& b) {
    return {b.skinning, b.origins, b.joint_features, b.controls, b.fades, b.modifiers, b.learned_skinning};
  }
  // All outputs that a batch can have.
  std::array<const Values*, 8> outputs() const {
    return {&positions, &normals, &tangents, &positions, &strains, &excess, &coordinates, &coefficients};
  }
  // Strains are of the pose before modifiers turned joints.
  const Buffer& skinning_of_strains() const {
    return learned_skinning.frame_bytes > 0 ? learned_skinning.buffer : skinning.buffer;
  }

  static VkDeviceSize frame_bytes(std::span<const Values* const> parts) {
    VkDeviceSize sum = 0;
    for (const Values* part : parts) sum += part->frame_bytes;
    return sum;
  }

  std::uint32_t frames;
  Values skinning, origins, joint_features, controls, fades, modifiers, learned_skinning;
  Values strain_positions, strains, features, excess, coordinates, kernels, coefficients, displacements;
  Values positions;
  std::array<Values, 3> finished;  // before a modifier, and by one of its steps and the next
  Values boxes;
  Values normals;
  Values tangents;  // of output vertices; none where they are recorded into the host's buffer
  Buffer staging_in, staging_out;
};

class VulkanBackend final : public Backend, private SplitRun {
 public:
  VulkanBackend(std::shared_ptr<const DeviceModel> model, const std::optional<JiggleOptions>& jiggle)
      : model_(std::move(model)),
        device_(model_->device()),
        counts_(model_->counts()),
        tables_(model_->tables()),
        kernels_(model_->kernels()),
        has_blend_(!model_->model().basis.residual.blend.empty()),
        commands_(std::in_place, device_) {
    if (jiggle) dynamics_.emplace(*model_, *jiggle);
    set_rest_coefficients(std::vector<float>(counts_.coefficients, 0.0f));
  }

  std::string name() const override { return device_.info().name; }

  std::uint32_t batch_limit() const override {
    const FrameCounts& n = counts_;
    const std::uint64_t skin = std::uint64_t{3} * n.vertices, skinning = std::uint64_t{12} * n.joints;
    const std::uint64_t strain = std::uint64_t{3} * n.strain_vertices;
    const std::uint64_t largest =
        std::max<std::uint64_t>({skin, skinning, strain, n.tangents, n.coordinates, n.centres, n.features});
    const std::uint64_t all = 3 * skin + n.tangents + 3 * n.finished + 6 * n.boxes + n.components + 2 * skinning +
                              strain + n.coordinates + n.centres + 3 * n.features +
                              (dynamics_ ? dynamics_->frame_floats() : 0);
    const std::uint64_t by_range =
        model_->limits().max_storage_buffer_range / (sizeof(float) * std::max<std::uint64_t>(1, largest));
    // Of a large body as many frames as read a table together, where there is memory for them.
    const std::uint64_t frame_bytes = sizeof(float) * std::max<std::uint64_t>(1, all);
    const std::uint64_t by_memory =
        std::min(std::max(kBatchBytes, kFramesTogether * frame_bytes), device_.info().memory_bytes / 8) / frame_bytes;
    const std::uint64_t by_groups = device_.info().max_groups_y;
    const std::uint64_t by_dynamics = dynamics_ ? dynamics_->batch_limit() : by_groups;
    return static_cast<std::uint32_t>(
        std::max<std::uint64_t>(1, std::min({by_range, by_memory, by_groups, by_dynamics})));
  }

  void set_rest_coefficients(std::span<const float> coefficients) override {
    rest_coefficients_ = upload_bytes(device_, std::as_bytes(coefficients), "the coefficients at rest");
    recorded_ = false;
    has_new_buffers_ = true;
  }

  void set_weights(const Weights& weights) override {
    if (weights == weights_) return;
    weights_ = weights;
    recorded_ = false;
  }

  DeviceSkin device_skin() const override {
    if (!buffers_) return {};
    return {skin_, &buffers_->normals.buffer};
  }

  void set_motion(const NodeMotion& motion) override {
    if (failed_) return;  // so that the first failure is the one reported
    dynamics_->set_motion(motion);
    has_new_buffers_ = true;
    forget_recorded_buffers();  // of the motion before
  }

  NodeMotion motion() const override {
    refuse_failed();
    failed_ = true;  // until it was read: what the host submits may have lost the device
    NodeMotion motion = dynamics_->motion();
    failed_ = false;
    return motion;
  }

  void record(const Batch& batch, const Recording& recording) override {
    refuse_failed();
    if (batch.frame_count > (records_ ? buffers_->frames : recording.most_frames)) {
      throw Error(ErrorKind::usage, "a recording of ", batch.frame_count, " frames is more than the ",
                  records_ ? buffers_->frames : recording.most_frames, " that the first one made room for");
    }
    failed_ = true;  // until this frame went well: the motion has gone on
    become_recorder(recording.most_frames);
    commands_->record_into(recording.commands);
    record_inputs(batch);
    record_stages(batch);
    record_place(*skin_, recording.positions, batch.frame_count);
    record_place(buffers_->normals.buffer, recording.normals, batch.frame_count);
    record_tangents_into(recording.tangents, batch.frame_count);
    record_attached(recording, batch.frame_count);
    failed_ = false;
  }

  void forget_recorded_buffers() override {
    if (records_) commands_->forget_sets();
  }

  SplitRun* split() override { return this; }

  const BatchResult& run(const Batch& batch) override {
    if (batch.frame_count == 0) return result_ = {};
    start(batch).run();
    finish();
    for (const Download& download : downloads()) {
      if (!is_of_skin(download)) continue;
      const std::span<const float> values = downloaded(download);
      (result_.*download.to).assign(values.begin(), values.end());
    }
    return result_;
  }

 private:
  Commands& start(const Batch& batch) override {
    refuse_failed();
    if (records_) {
      throw Error(ErrorKind::usage, "the instance records for the host program: make another one to evaluate");
    }
    failed_ = true;  // until this batch went well
    const bool recorded = recorded_ && frames_ == batch.frame_count && batch.jiggle.empty() &&
                          batch.stays_on_device == stays_on_device_ && batch.keeps_posed == keeps_posed_ &&
                          batch.wants_normals == wants_normals_ && batch.wants_tangents == wants_tangents_ &&
                          output_steps(model_->model().basis, batch) == output_steps_;
    frames_ = batch.frame_count;
    if (!recorded) allocate(frames_);
    send(batch);  // first: recording runs what is long
    if (!recorded) record(batch);
    return *commands_;
  }

  const BatchResult& finish() override {
    receive();
    refuse_validation_messages();
    failed_ = false;
    return result_;
  }

  SkinValues skin() const override {
    SkinValues skin;
    for (const Download& download : downloads()) {
      if (download.to == &BatchResult::positions) skin.positions = downloaded(download);
      if (download.to == &BatchResult::normals) skin.normals = downloaded(download);
      if (download.to == &BatchResult::tangents) skin.tangents = downloaded(download);
    }
    return skin;
  }

  void record(const Batch& batch) {
    commands_->begin(std::exchange(has_new_buffers_, false) ? Commands::Sets::anew : Commands::Sets::kept);
    record_upload();
    stays_on_device_ = batch.stays_on_device;
    keeps_posed_ = batch.keeps_posed;
    wants_normals_ = batch.wants_normals;
    wants_tangents_ = batch.wants_tangents;
    record_stages(batch);
    record_download();
    commands_->end();
    recorded_ = batch.jiggle.empty();
  }

  void record_stages(const Batch& batch) {
    output_steps_ = output_steps(model_->model().basis, batch, std::move(output_steps_));
    // No residual: un-posed displacements of zero.
    if (!has_blend_) commands_->fill(buffers_->displacements.buffer, 0);
    commands_->timestamp();
    stages_ = stages_of(model_->model().basis, batch, std::move(stages_));
    for (const Stage stage : stages_) {
      record_stage(stage, batch);
      commands_->timestamp();
    }
  }

  void record_stage(Stage stage, const Batch& batch) {
    const std::uint32_t frames = batch.frame_count;
    switch (stage) {
      case Stage::rig:
        return;  // on the host
      case Stage::strain:
        return record_strain(frames);
      case Stage::residual:
        return record_residual(frames);
      case Stage::modify:
        return record_modify(frames);
      case Stage::pose:
        return record_pose(frames);
      case Stage::diffuse:
        return record_diffuse(frames);
      case Stage::jiggle:
        return record_jiggle(batch.jiggle);
      case Stage::output:
        return record_output(batch);
    }
  }

  void record_pose(std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    record_pose_skin(*commands_, kernels_.pose_skin,
                     {tables_.ddm, b.skinning.buffer, b.origins.buffer, b.displacements.buffer, b.positions.buffer},
                     counts_.vertices, counts_.joints, frames);
    skin_ = &b.positions.buffer;
  }

  void record_output(const Batch& batch) {
    record_finish(batch.frame_count);
    if (batch.wants_normals || batch.wants_tangents) record_normals(batch.frame_count);
    if (batch.wants_tangents && !records_) record_tangents(batch.frame_count);
  }

  void record_normals(std::uint32_t frames) {
    record_output_normals(*commands_, kernels_.output_normals, {tables_.fans, *skin_, buffers_->normals.buffer},
                          counts_.vertices, frames);
  }

  void record_tangents(std::uint32_t frames) {
    record_tangents(buffers_->tangents.buffer, {output_count(), counts_.vertices, 0, 4, 4 * output_count()}, frames);
  }

  void record_tangents(const BufferRange& to, const OutputTangentsPush& push, std::uint32_t frames) {
    kernels_.output_tangents.record(
        *commands_, {tables_.tangents.vertices, tables_.tangents.corners, *skin_, buffers_->normals.buffer, to}, push,
        frames);
  }

  // Records the modifiers that move the posed skin.
  void record_finish(std::uint32_t frames) {
    const Buffer* unfinished = nullptr;
    for (const OutputStep& step : output_steps_) {
      if (step.number == 0) unfinished = skin_;
      const auto unused = std::ranges::find_if(
          buffers_->finished, [&](const Values& v) { return &v.buffer != skin_ && &v.buffer != unfinished; });
      const Buffer& to = unused->buffer;
      switch (step.kind) {
        case PosedSkinStep::relax:
          record_relax(step, to, frames);
          break;
        case PosedSkinStep::separate:
          record_separate(step, *unfinished, to, frames);
          break;
      }
      skin_ = &to;
    }
  }

  void record_relax(const OutputStep& step, const Buffer& to, std::uint32_t frames) {
    record_output_relax(*commands_, kernels_.output_relax,
                        {tables_.fans, tables_.rest, buffers_->modifiers.buffer, *skin_, to},
                        relax_push(model_->model().basis, step), frames);
  }

  void record_separate(const OutputStep& step, const Buffer& unfinished, const Buffer& to, std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    const SkinTables& t = tables_;
    const Basis& basis = model_->model().basis;
    if (step.number == 0) record_normals(frames);  // those of the skin as it was posed
    kernels_.output_bound.record(*commands_, {t.folds.triangles, *skin_, b.boxes.buffer}, bound_push(basis), frames);
    kernels_.output_separate.record(*commands_,
                                    {t.folds.triangles, t.folds.sides, b.boxes.buffer, b.modifiers.buffer,
                                     b.normals.buffer, unfinished, *skin_, to},
                                    separate_push(basis, step), frames);
  }

  std::uint32_t output_count() const { return model_->model().basis.mesh.output_count(); }

  // From now on it records for the host, `most_frames` at a time. Buffers of an earlier recording are never freed.
  void become_recorder(std::uint32_t most_frames) {
    if (records_) return;
    records_ = true;
    commands_.emplace(device_, Commands::OfHost::yes);
    buffers_.reset();
    allocate(most_frames);
  }

  void record_inputs(const Batch& batch) {
    const auto to = buffers_->inputs();
    const auto from = BatchBuffers::inputs_of(batch);
    for (std::size_t k = 0; k < to.size(); ++k) {
      const BufferRange range = to[k]->of(batch.frame_count);
      if (range.size > 0) commands_->update(range, std::as_bytes(from[k]).first(range.size));
    }
  }

  // The part of the host's buffer to bind, which begins at the device's alignment, and where an output begins in it.
  struct HostRange {
    BufferRange range;
    std::uint32_t first_word, element_words, frame_words;
  };
  HostRange host_range(const PlacedOutput& to, std::uint32_t elements, std::uint32_t numbers,
                       std::uint32_t frames) const {
    const VkDeviceSize begin = to.offset / device_.info().storage_alignment * device_.info().storage_alignment;
    const auto word = [](VkDeviceSize bytes) { return static_cast<std::uint32_t>(bytes / sizeof(float)); };
    const VkDeviceSize end =
        to.offset + (frames - 1) * to.frame_stride + (elements - 1) * to.element_stride + numbers * sizeof(float);
    return {BufferRange(to.buffer, begin, end - begin), word(to.offset - begin), word(to.element_stride),
            word(to.frame_stride)};
  }

  void record_place(const Buffer& values, const PlacedOutput& to, std::uint32_t frames) {
    if (to.buffer == VK_NULL_HANDLE) return;
    const HostRange host = host_range(to, output_count(), 3, frames);
    kernels_.output_place.record(
        *commands_, {tables_.output_vertex, values, host.range},
        {output_count(), counts_.vertices, host.first_word, host.element_words, host.frame_words}, frames);
  }

  void record_tangents_into(const PlacedOutput& to, std::uint32_t frames) {
    if (to.buffer == VK_NULL_HANDLE) return;
    const HostRange host = host_range(to, output_count(), 4, frames);
    record_tangents(host.range,
                    {output_count(), counts_.vertices, host.first_word, host.element_words, host.frame_words}, frames);
  }

  void record_attached(const Recording& recording, std::uint32_t frames) {
    attached_targets_.clear();
    for (std::uint32_t mesh = 0; mesh < recording.attached_to.size(); ++mesh) {
      const PlacedOutput& to = recording.attached_to[mesh];
      if (to.buffer == VK_NULL_HANDLE) continue;
      const HostRange host = host_range(to, recording.attached->vertex_count(mesh), 3, frames);
      attached_targets_.push_back({host.range, mesh, host.first_word, host.element_words, host.frame_words});
    }
    if (attached_targets_.empty()) return;
    const BatchBuffers& b = *buffers_;
    recording.attached->record(*commands_,
                               {*skin_, b.skinning.buffer, b.origins.buffer, counts_.vertices, counts_.joints},
                               attached_targets_, frames);
  }

  // Keeps buffers that are large enough: to allocate anew, as for the last part of a clip, costs more than any batch.
  void allocate(std::uint32_t frames) {
    recorded_ = false;
    if (buffers_ && buffers_->frames >= frames) return;
    has_new_buffers_ = true;
    buffers_.reset();  // before the next ones are allocated
    buffers_ = std::make_unique<BatchBuffers>(device_, counts_, frames, records_);
  }

  VulkanDynamics::Inputs dynamics_inputs(std::uint32_t frames) const {
    const BatchBuffers& b = *buffers_;
    return {b.positions.buffer,
            b.origins.buffer,
            b.strains.buffer,
            b.controls.buffer,
            counts_.fibres,
            counts_.controls,
            frames};
  }

  void record_diffuse(std::uint32_t frames) {
    dynamics_->prepare(buffers_->frames);
    dynamics_->record_diffuse(*commands_, dynamics_inputs(frames));
  }

  void record_jiggle(std::span<const JiggleFrame> frames) {
    dynamics_->record_jiggle(*commands_, dynamics_inputs(static_cast<std::uint32_t>(frames.size())), frames,
                             weights_.jiggle);
    if (!records_) dynamics_->record_motion(*commands_);
    skin_ = &dynamics_->moved();
  }

  void record_upload() {
    VkDeviceSize offset = 0;
    for (const Values* values : buffers_->inputs()) {
      const BufferRange to = values->of(frames_);
      commands_->copy({buffers_->staging_in, offset, to.size}, to);
      offset += to.size;
    }
  }

  void record_strain(std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    const SkinTables& t = tables_;
    record_strain_skin(*commands_, kernels_.strain_skin,
                       {t.ddm, b.skinning_of_strains(), t.strain_vertices, b.strain_positions.buffer},
                       counts_.strain_vertices, counts_.joints, frames);
    kernels_.strain_measure.record(
        *commands_, {t.points, t.fibre_begin, t.rest_length, b.strain_positions.buffer, b.strains.buffer},
        {counts_.fibres, counts_.strain_vertices}, frames);
  }

  void record_residual(std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    const SkinTables& t = tables_;
    const FrameCounts& n = counts_;
    kernels_.residual_features.record(
        *commands_,
        {t.ranges, b.joint_features.buffer, b.strains.buffer, b.controls.buffer, b.features.buffer, b.excess.buffer},
        {n.joint_features, n.features == 0 ? 0 : n.fibres, n.controls}, frames);
    kernels_.residual_project.record(
        *commands_,
        {t.regions, t.region_features, t.coordinate_region, t.projections, b.features.buffer, b.coordinates.buffer},
        {n.coordinates, n.features}, frames);
    if (weights_.kernels) {
      kernels_.residual_kernels.record(*commands_,
                                       {t.regions, t.centre_region, t.centres, b.coordinates.buffer, b.kernels.buffer},
                                       {n.centres, n.coordinates}, frames);
    } else {
      commands_->fill(b.kernels.buffer, 0);
    }
    kernels_.residual_coefficients.record(
        *commands_,
        {t.regions, t.coefficient_region, t.weights, rest_coefficients_, b.coordinates.buffer, b.kernels.buffer,
         b.fades.buffer, b.coefficients.buffer},
        {n.coefficients, n.coordinates, n.centres, n.regions}, frames);
    if (!has_blend_) return;
    record_residual_blend(*commands_, kernels_.residual_blend, {t.blend, b.coefficients.buffer, b.displacements.buffer},
                          n.vertices, n.coefficients, weights_.correction, frames);
  }

  void record_modify(std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    record_modify_blend(*commands_, kernels_.modify_blend,
                        {tables_.modifiers, b.modifiers.buffer, b.displacements.buffer}, counts_.vertices,
                        counts_.components, frames);
  }

  // An output that goes to the host, and where it is staged, bytes.
  struct Download {
    BufferRange from;
    VkDeviceSize staged = 0;
    std::vector<float> BatchResult::*to;
  };
  std::vector<Download> downloads() const {
    const BatchBuffers& b = *buffers_;
    std::vector<Download> all;
    VkDeviceSize staged = 0;
    const auto add = [&](const Buffer& buffer, const Values& values, std::vector<float> BatchResult::*to) {
      const VkDeviceSize size = values.of(frames_).size;
      all.push_back({{buffer, 0, size}, staged, to});
      staged += size;
    };
    if (!stays_on_device_) {
      add(*skin_, b.positions, &BatchResult::positions);
      if (wants_normals_) add(b.normals.buffer, b.normals, &BatchResult::normals);
      if (wants_tangents_) add(b.tangents.buffer, b.tangents, &BatchResult::tangents);
    }
    if (keeps_posed_) add(b.positions.buffer, b.positions, &BatchResult::posed);
    add(b.strains.buffer, b.strains, &BatchResult::strains);
    add(b.excess.buffer, b.excess, &BatchResult::excess);
    add(b.coordinates.buffer, b.coordinates, &BatchResult::coordinates);
    add(b.coefficients.buffer, b.coefficients, &BatchResult::coefficients);
    return all;
  }

  static bool is_of_skin(const Download& download) {
    return download.to == &BatchResult::positions || download.to == &BatchResult::normals ||
           download.to == &BatchResult::tangents || download.to == &BatchResult::posed;
  }

  std::span<const float> downloaded(const Download& download) const {
    const std::byte* from = buffers_->staging_out.mapped() + download.staged;
    return {reinterpret_cast<const float*>(from), download.from.size / sizeof(float)};
  }

  void record_download() {
    for (const Download& download : downloads()) {
      commands_->copy(download.from, {buffers_->staging_out, download.staged, download.from.size});
    }
  }

  void send(const Batch& batch) {
    std::byte* to = buffers_->staging_in.mapped();
    const auto values = buffers_->inputs();
    const auto from = BatchBuffers::inputs_of(batch);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const VkDeviceSize bytes = values[k]->of(frames_).size;
      if (bytes == 0) continue;
      std::memcpy(to, from[k].data(), bytes);
      to += bytes;
    }
  }

  // All but the skin, which is large, and read where it is.
  void receive() {
    for (const auto skin :
         {&BatchResult::positions, &BatchResult::normals, &BatchResult::tangents, &BatchResult::posed}) {
      (result_.*skin).clear();
    }
    for (const Download& download : downloads()) {
      if (is_of_skin(download)) continue;
      const std::span<const float> values = downloaded(download);
      (result_.*download.to).assign(values.begin(), values.end());
    }
    result_.stage_seconds = {};
    const std::vector<double> seconds = commands_->seconds();
    for (std::size_t s = 0; s < seconds.size(); ++s) result_.stage_seconds.add(stages_[s], seconds[s]);
  }

  void refuse_failed() const {
    if (!failed_) return;
    throw Error(ErrorKind::device, "the Vulkan device '", name(), "' failed earlier and is not used again");
  }

  void refuse_validation_messages() const {
    const std::vector<std::string> messages = device_.validation_messages();
    if (messages.empty()) return;
    throw Error(ErrorKind::device, "Vulkan validation reported ", messages.size(), " messages on '", name(),
                "', first: ", messages.front());
  }

  std::shared_ptr<const DeviceModel> model_;
  const Device& device_;
  const FrameCounts& counts_;
  const SkinTables& tables_;
  const SkinKernels& kernels_;
  bool has_blend_;
  Buffer rest_coefficients_;
  std::unique_ptr<BatchBuffers> buffers_;
  std::uint32_t frames_ = 0;  // of the last batch
  BatchResult result_;
  std::optional<VulkanDynamics> dynamics_;
  std::optional<Commands> commands_;
  std::vector<Stage> stages_;             // recorded
  std::vector<OutputStep> output_steps_;  // recorded
  bool has_new_buffers_ = true;           // that no descriptor set is of
  bool recorded_ = false;                 // the quasi-static skin, for as many frames as there are buffers
  std::vector<AttachedMeshes::Target> attached_targets_;  // of the last recording, kept for their memory
  Weights weights_;
  const Buffer* skin_ = nullptr;                        // of the last batch
  bool stays_on_device_ = false, keeps_posed_ = false;  // as recorded
  bool wants_normals_ = true, wants_tangents_ = false;
  mutable bool failed_ = false;
  bool records_ = false;  // for the host program
};

}  // namespace
}  // namespace vulkan

namespace {

template <typename Suits>
bool has_device(const Suits& suits) {
  try {
    const std::vector<vulkan::DeviceInfo> devices = vulkan::list_devices();
    return std::ranges::any_of(
        devices, [&](const vulkan::DeviceInfo& device) { return device.problem.empty() && suits(device); });
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool has_vulkan_device() {
  return has_device([](const vulkan::DeviceInfo&) { return true; });
}

bool has_gpu() {
  return has_device([](const vulkan::DeviceInfo& device) { return device.type != "cpu"; });
}

std::unique_ptr<Backend> make_vulkan_backend(std::shared_ptr<const vulkan::DeviceModel> model,
                                             const std::optional<JiggleOptions>& jiggle) {
  return std::make_unique<vulkan::VulkanBackend>(std::move(model), jiggle);
}

}  // namespace bodyopt
