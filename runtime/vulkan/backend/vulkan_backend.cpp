// A Vulkan device as a backend: tables uploaded once; one command buffer per batch. For the quasi-static skin it is
// recorded when the number of frames changes, and submitted again otherwise. Every batch that jiggles is recorded
// according to a plan of its own. The next batch is recorded and sent while one runs.
#include "runtime/vulkan/backend/vulkan_backend.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/host/output_steps.h"
#include "runtime/host/stages.h"
#include "runtime/vulkan/backend/attached_meshes.h"
#include "runtime/vulkan/backend/batch_buffers.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_dynamics.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace vulkan {
namespace {

// Bytes of a batch's buffers, enough vertices to fill a device; of one that stays there, a crowd.
constexpr std::uint64_t kBatchBytes = 64u << 20;

class VulkanBackend final : public Backend, private SplitRun {
 public:
  VulkanBackend(std::shared_ptr<const DeviceModel> model, const std::optional<JiggleOptions>& jiggle)
      : model_(std::move(model)),
        device_(model_->device()),
        counts_(model_->counts()),
        tables_(model_->tables()),
        kernels_(model_->kernels()),
        has_blend_(!model_->model().basis.residual.blend.empty()) {
    if (jiggle) dynamics_.emplace(*model_, *jiggle);
    set_rest_coefficients(std::vector<float>(counts_.coefficients, 0.0f));
  }

  std::string name() const override { return device_.info().name; }

  // Of a large body as many frames as read a table together, where there is memory for them.
  std::uint32_t batch_limit() const override {
    const std::uint32_t most = most_frames(std::max(kBatchBytes, kFramesTogether * frame_bytes()));
    return most < kFramesTogether ? most : most / kFramesTogether * kFramesTogether;
  }
  std::uint32_t largest_batch() const override { return most_frames(UINT64_MAX); }

  void set_rest_coefficients(std::span<const float> coefficients) override {
    rest_coefficients_ = upload_bytes(device_, std::as_bytes(coefficients), "the coefficients at rest");
    forget_buffers();
  }

  void set_weights(const Weights& weights) override {
    if (weights == weights_) return;
    weights_ = weights;
    for (auto& slot : slots_) {
      if (slot) slot->is_recorded = false;
    }
  }

  DeviceSkin device_skin() const override {
    if (!buffers_) return {};
    return {skin_, &buffers_->normals.buffer};
  }

  void set_motion(const NodeMotion& motion) override {
    if (failed_) return;  // so that the first failure is the one reported
    dynamics_->set_motion(motion);
    forget_buffers();  // of the motion before
    forget_recorded_buffers();
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
    if (batch.frame_count > (records() ? buffers_->frames : recording.most_frames)) {
      throw Error(ErrorKind::usage, "a recording of ", batch.frame_count, " frames is more than the ",
                  records() ? buffers_->frames : recording.most_frames, " that the first one made room for");
    }
    failed_ = true;  // until this frame went well: the motion has gone on
    become_recorder(recording.most_frames);
    commands_ = &*host_commands_;
    commands_->record_into(recording.commands);
    record_inputs(batch);
    host_stages_ = stages_of(model_->model().basis, batch, std::move(host_stages_));
    host_steps_ = output_steps(model_->model().basis, batch, std::move(host_steps_));
    record_stages(batch, host_stages_, host_steps_);
    record_place(*skin_, recording.positions, batch.frame_count);
    record_place(buffers_->normals.buffer, recording.normals, batch.frame_count);
    record_tangents_into(recording.tangents, batch.frame_count);
    record_attached(recording, batch.frame_count);
    failed_ = false;
  }

  void forget_recorded_buffers() override {
    if (records()) host_commands_->forget_sets();
  }

  SplitRun* split() override { return this; }

  const BatchResult& run(const Batch& batch) override {
    if (batch.frame_count == 0) return result_ = {};
    Commands& commands = start(batch, false);
    failed_ = true;  // until they have run
    commands.run();
    failed_ = false;
    BatchSlot& slot = finish_slot();
    for (const Download& download : slot.downloads) {
      const std::span<const float> values = download.values();
      if (download.is_of_skin()) (result_.*download.to).assign(values.begin(), values.end());
    }
    return result_;
  }

 private:
  bool records() const { return host_commands_.has_value(); }

  std::uint64_t frame_bytes() const {
    const FrameCounts& n = counts_;
    const std::uint64_t skin = std::uint64_t{3} * n.vertices;
    return sizeof(float) *
           std::max<std::uint64_t>(1, 3 * skin + 2 * (std::uint64_t{6} * n.outputs + n.tangents) + 3 * n.finished +
                                          6 * n.boxes + n.components + std::uint64_t{24} * n.joints +
                                          std::uint64_t{3} * n.strain_vertices + n.coordinates + n.centres +
                                          3 * n.features + (dynamics_ ? dynamics_->frame_floats() : 0));
  }

  // Frames of a batch whose buffers have so many bytes, if the device has.
  std::uint32_t most_frames(std::uint64_t bytes) const {
    const FrameCounts& n = counts_;
    const std::uint64_t largest = std::max<std::uint64_t>(
        {1, std::uint64_t{3} * n.vertices, std::uint64_t{3} * n.outputs, std::uint64_t{12} * n.joints,
         std::uint64_t{3} * n.strain_vertices, n.tangents, n.coordinates, n.centres, n.features});
    const std::uint64_t by_range = model_->limits().max_storage_buffer_range / (sizeof(float) * largest);
    const std::uint64_t by_memory = std::min(bytes, model_->limits().memory_bytes / 8) / frame_bytes();
    const std::uint64_t by_groups = device_.info().max_groups_y;
    const std::uint64_t by_dynamics = dynamics_ ? dynamics_->batch_limit() : by_groups;
    return static_cast<std::uint32_t>(
        std::max<std::uint64_t>(1, std::min({by_range, by_memory, by_groups, by_dynamics})));
  }

  // Of what is recorded some exist no more.
  void forget_buffers() {
    for (auto& slot : slots_) {
      if (!slot) continue;
      slot->has_new_buffers = true;
      slot->is_recorded = false;
    }
  }

  Commands& start(const Batch& batch) override { return start(batch, true); }

  // The slots take turns where a batch is under way.
  Commands& start(const Batch& batch, bool is_ordered) {
    refuse_failed();
    if (records()) {
      throw Error(ErrorKind::usage, "the instance records for the host program: make another one to evaluate");
    }
    failed_ = true;  // until this batch is recorded
    if (under_way_ == 0) first_ = 0;
    auto& place = slots_[(first_ + under_way_) % slots_.size()];
    BatchSlot& slot = place ? *place : place.emplace(device_);
    const RecordedBatch wanted{batch.frame_count,
                               batch.stays_on_device,
                               batch.keeps_posed,
                               batch.wants_normals,
                               batch.wants_tangents,
                               is_ordered,
                               output_steps(model_->model().basis, batch)};
    allocate(batch.frame_count);
    if (make_room(slot.staging_in, buffers_->frames * buffers_->input_bytes())) slot.is_recorded = false;
    send(batch, slot.staging_in);  // first: recording runs what is long
    if (!slot.is_recorded || !batch.jiggle.empty() || slot.recorded != wanted) {
      slot.recorded = wanted;
      record(batch, slot);
    }
    ++under_way_;
    failed_ = false;
    return slot.commands;
  }

  const BatchResult& finish() override {
    finish_slot();
    return result_;
  }

  BatchSlot& finish_slot() {
    BatchSlot& slot = *slots_[finished_ = first_];
    first_ = (first_ + 1) % slots_.size();
    --under_way_;
    const bool next_failed = std::exchange(failed_, true);  // until this batch went well
    if (!slot.commands.has_run()) refuse_failed();
    receive(slot);
    refuse_validation_messages();
    failed_ = next_failed;
    return slot;
  }

  SkinValues skin() const override {
    SkinValues skin;
    for (const Download& download : slots_[finished_]->downloads) {
      if (download.to == &BatchResult::positions) skin.positions = download.values();
      if (download.to == &BatchResult::normals) skin.normals = download.values();
      if (download.to == &BatchResult::tangents) skin.tangents = download.values();
    }
    return skin;
  }

  void record(const Batch& batch, BatchSlot& slot) {
    slot.is_recorded = false;
    commands_ = &slot.commands;
    commands_->begin(std::exchange(slot.has_new_buffers, false) ? Commands::Sets::anew : Commands::Sets::kept);
    record_upload(slot);
    slot.stages = stages_of(model_->model().basis, batch, std::move(slot.stages));
    record_stages(batch, slot.stages, slot.recorded.output_steps);
    record_download(slot);
    commands_->end();
    slot.is_recorded = batch.jiggle.empty();
  }

  void record_stages(const Batch& batch, std::span<const Stage> stages, std::span<const OutputStep> steps) {
    // No residual: un-posed displacements of zero.
    if (!has_blend_) commands_->fill(buffers_->displacements.buffer, 0);
    commands_->timestamp();
    for (const Stage stage : stages) {
      record_stage(stage, batch, steps);
      commands_->timestamp();
    }
  }

  void record_stage(Stage stage, const Batch& batch, std::span<const OutputStep> steps) {
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
        return record_output(batch, steps);
    }
  }

  void record_pose(std::uint32_t frames) {
    const BatchBuffers& b = *buffers_;
    record_pose_skin(*commands_, kernels_.pose_skin,
                     {tables_.ddm, b.skinning.buffer, b.origins.buffer, b.displacements.buffer, b.positions.buffer},
                     counts_.vertices, counts_.joints, frames);
    skin_ = &b.positions.buffer;
  }

  void record_output(const Batch& batch, std::span<const OutputStep> steps) {
    record_finish(steps, batch.frame_count);
    if (batch.wants_normals || batch.wants_tangents) record_normals(batch.frame_count);
  }

  void record_normals(std::uint32_t frames) {
    record_output_normals(*commands_, kernels_.output_normals, {tables_.fans, *skin_, buffers_->normals.buffer},
                          counts_.vertices, frames);
  }

  void record_tangents(const BufferRange& to, const OutputTangentsPush& push, std::uint32_t frames) {
    kernels_.output_tangents.record(
        *commands_, {tables_.tangents.vertices, tables_.tangents.corners, *skin_, buffers_->normals.buffer, to}, push,
        frames);
  }

  // Records the modifiers that move the posed skin.
  void record_finish(std::span<const OutputStep> steps, std::uint32_t frames) {
    const Buffer* unfinished = nullptr;
    for (const OutputStep& step : steps) {
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

  // From now on it records for the host, `most_frames` at a time. Buffers of an earlier recording are never freed.
  void become_recorder(std::uint32_t most_frames) {
    if (records()) return;
    host_commands_.emplace(device_, Commands::OfHost::yes);
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
    const HostRange host = host_range(to, counts_.outputs, 3, frames);
    kernels_.output_place.record(
        *commands_, {tables_.output_vertex, values, host.range},
        {counts_.outputs, counts_.vertices, host.first_word, host.element_words, host.frame_words}, frames);
  }

  void record_tangents_into(const PlacedOutput& to, std::uint32_t frames) {
    if (to.buffer == VK_NULL_HANDLE) return;
    const HostRange host = host_range(to, counts_.outputs, 4, frames);
    record_tangents(host.range,
                    {counts_.outputs, counts_.vertices, host.first_word, host.element_words, host.frame_words}, frames);
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
  // Nothing is under way then: no batch of a call is longer than the first.
  void allocate(std::uint32_t frames) {
    if (buffers_ && buffers_->frames >= frames) return;
    forget_buffers();
    buffers_.reset();  // before the next ones are allocated
    buffers_ = std::make_unique<BatchBuffers>(device_, counts_, frames);
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
    if (!records()) dynamics_->record_motion(*commands_);
    skin_ = &dynamics_->moved();
  }

  void record_upload(const BatchSlot& slot) {
    VkDeviceSize offset = 0;
    for (const Values* values : buffers_->inputs()) {
      const BufferRange to = values->of(slot.recorded.frames);
      commands_->copy({slot.staging_in, offset, to.size}, to);
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

  void record_download(BatchSlot& slot) {
    const RecordedBatch& batch = slot.recorded;
    const std::uint32_t frames = batch.frames;
    slot.downloads.clear();
    if (!batch.stays_on_device && (batch.is_ordered || batch.wants_tangents)) {
      order(slot);
      slot.stages.push_back(Stage::output);
      commands_->timestamp();
    }
    const BatchBuffers& b = *buffers_;
    VkDeviceSize staged = 0;
    const auto add = [&](const Buffer& from, const Values& values, std::vector<float> BatchResult::*to) {
      const VkDeviceSize size = values.of(frames).size;
      slot.downloads.push_back({{from, 0, size}, &slot.staging_out, staged, to});
      staged += size;
    };
    if (!batch.stays_on_device && !batch.is_ordered) {
      add(*skin_, b.positions, &BatchResult::positions);
      if (batch.wants_normals) add(b.normals.buffer, b.normals, &BatchResult::normals);
    }
    if (batch.keeps_posed) add(b.positions.buffer, b.positions, &BatchResult::posed);
    add(b.strains.buffer, b.strains, &BatchResult::strains);
    add(b.excess.buffer, b.excess, &BatchResult::excess);
    add(b.coordinates.buffer, b.coordinates, &BatchResult::coordinates);
    add(b.coefficients.buffer, b.coefficients, &BatchResult::coefficients);
    make_room(slot.staging_out, staged);
    for (const Download& download : slot.downloads) {
      const BufferRange to{*download.staging, download.staged, download.from.size};
      if (download.staging == &slot.staging_out) {
        commands_->copy(download.from, to);
      } else {
        commands_->download(download.from, to);
      }
    }
  }

  // The skin into output order, from where it is fetched.
  void order(BatchSlot& slot) {
    const RecordedBatch& batch = slot.recorded;
    if (!slot.skin || slot.skin->frames < batch.frames) {
      slot.skin.reset();
      slot.skin.emplace(device_, counts_, buffers_->frames);
    }
    VkDeviceSize staged = 0;
    const auto add = [&](const Values& values, std::vector<float> BatchResult::*to) {
      const BufferRange from = values.of(batch.frames);
      slot.downloads.push_back({from, &slot.skin->staging, staged, to});
      staged += from.size;
    };
    const auto place = [&](const Buffer& from, const Values& to, std::vector<float> BatchResult::*result) {
      kernels_.output_place.record(*commands_, {tables_.output_vertex, from, to.buffer},
                                   {counts_.outputs, counts_.vertices, 0, 3, 3 * counts_.outputs}, batch.frames);
      add(to, result);
    };
    if (batch.is_ordered) place(*skin_, slot.skin->positions, &BatchResult::positions);
    if (batch.is_ordered && batch.wants_normals) {
      place(buffers_->normals.buffer, slot.skin->normals, &BatchResult::normals);
    }
    if (!batch.wants_tangents) return;
    record_tangents(slot.skin->tangents.buffer, {counts_.outputs, counts_.vertices, 0, 4, 4 * counts_.outputs},
                    batch.frames);
    add(slot.skin->tangents, &BatchResult::tangents);
  }

  // Whether it is another buffer then.
  bool make_room(Buffer& staging, VkDeviceSize bytes) const {
    if (staging.size() >= bytes) return false;
    staging = Buffer(device_, bytes, Memory::staging, "staging");
    return true;
  }

  void send(const Batch& batch, const Buffer& staging) const {
    std::byte* to = staging.mapped();
    const auto values = buffers_->inputs();
    const auto from = BatchBuffers::inputs_of(batch);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const VkDeviceSize bytes = values[k]->of(batch.frame_count).size;
      if (bytes == 0) continue;
      std::memcpy(to, from[k].data(), bytes);
      to += bytes;
    }
  }

  // All but the skin, which is large, and read where it is.
  void receive(BatchSlot& slot) {
    for (const auto skin :
         {&BatchResult::positions, &BatchResult::normals, &BatchResult::tangents, &BatchResult::posed}) {
      (result_.*skin).clear();
    }
    for (const Download& download : slot.downloads) {
      if (download.is_of_skin()) continue;
      const std::span<const float> values = download.values();
      (result_.*download.to).assign(values.begin(), values.end());
    }
    result_.stage_seconds = {};
    const std::vector<double> seconds = slot.commands.seconds();
    for (std::size_t s = 0; s < seconds.size(); ++s) result_.stage_seconds.add(slot.stages[s], seconds[s]);
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
  std::size_t first_ = 0, under_way_ = 0;  // slots with batches that are not finished
  std::size_t finished_ = 0;               // the slot that was last
  Commands* commands_ = nullptr;           // that are being recorded
  BatchResult result_;
  std::optional<VulkanDynamics> dynamics_;
  std::optional<Commands> host_commands_;  // where it records for the host program
  std::vector<Stage> host_stages_;
  std::vector<OutputStep> host_steps_;
  std::vector<AttachedMeshes::Target> attached_targets_;  // of the last recording, kept for their memory
  Weights weights_;
  const Buffer* skin_ = nullptr;  // of the last batch
  mutable bool failed_ = false;
  std::array<std::optional<BatchSlot>, 2> slots_;  // made when first wanted; last: they wait before all else goes
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
