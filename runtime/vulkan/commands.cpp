#include "runtime/vulkan/commands.h"

#include <algorithm>
#include <array>
#include <utility>

#include "runtime/core/error.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {
namespace {

constexpr std::uint32_t kSetsOfAPool = 256;

// Returns how many bindings a shader declares, numbered from 0. Instructions follow a header of five words. Each begins
// with a word of its length (upper half) and its opcode (SPIR-V 1.0, 2.3 and 3.32.3).
std::uint32_t count_bindings(std::span<const std::uint32_t> spirv) {
  constexpr std::uint32_t kHeader = 5, kDecorate = 71, kBinding = 33;
  std::uint32_t count = 0;
  for (std::size_t i = kHeader; i < spirv.size(); i += spirv[i] >> 16) {
    if ((spirv[i] & 0xffff) == kDecorate && spirv[i + 2] == kBinding) count = std::max(count, spirv[i + 3] + 1);
  }
  return count;
}

// Once `ready` is signalled. Where it fails, what signals that has ended, as nothing waits for it.
void submit_copies(const Device& device, std::span<const VkCommandBuffer> copies, VkSemaphore ready, VkFence fence) {
  const VkPipelineStageFlags copying = VK_PIPELINE_STAGE_TRANSFER_BIT;
  auto submit = structure<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.waitSemaphoreCount = 1;
  submit.pWaitSemaphores = &ready;
  submit.pWaitDstStageMask = &copying;
  submit.commandBufferCount = static_cast<std::uint32_t>(copies.size());
  submit.pCommandBuffers = copies.data();
  const VkResult result = vkQueueSubmit(device.copy_queue(), 1, &submit, fence);
  if (result != VK_SUCCESS) vkDeviceWaitIdle(device.handle());
  check(result, "vkQueueSubmit");
}

bool overlap(const BufferRange& a, const BufferRange& b) {
  return a.buffer == b.buffer && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

bool conflict(const BufferUse& a, const BufferUse& b) { return (a.writes || b.writes) && overlap(a.range, b.range); }

// The host sees what was copied.
void end_for_host(VkCommandBuffer commands) {
  auto memory = structure<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &memory, 0, nullptr,
                       0, nullptr);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
}

constexpr std::uint32_t kMaxTimestamps = 16;
constexpr std::size_t kMostUpdate = 65536;           // bytes of one vkCmdUpdateBuffer
constexpr std::uint64_t kTimeout = 300'000'000'000;  // nanoseconds; a software device on a busy machine is slow

}  // namespace

void DescriptorSets::reset() {
  for (const Pool& pool : pools_) {
    check(vkResetDescriptorPool(device_.handle(), pool.get(), 0), "vkResetDescriptorPool");
  }
  made_ = 0;
}

VkDescriptorSet DescriptorSets::allocate(VkDescriptorSetLayout layout) {
  if (made_ == kSetsOfAPool * pools_.size()) pools_.push_back(make_pool());
  auto info = structure<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pools_[made_ / kSetsOfAPool].get();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(vkAllocateDescriptorSets(device_.handle(), &info, &set), "vkAllocateDescriptorSets");
  ++made_;
  return set;
}

DescriptorSets::Pool DescriptorSets::make_pool() const {
  const std::array sizes = {
      VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsOfAPool * BODYOPT_MOST_BINDINGS},
      VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * kSetsOfAPool}};
  auto info = structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = kSetsOfAPool;
  info.poolSizeCount = sizes.size();
  info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &pool), "vkCreateDescriptorPool");
  return {device_.handle(), pool};
}

Kernel::Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t written,
               std::uint32_t push_bytes, std::uint32_t frames)
    : binding_count_(count_bindings(spirv)), written_(written) {
  const VkDevice handle = device.handle();
  std::vector<VkDescriptorSetLayoutBinding> bindings(binding_count_);
  for (std::uint32_t b = 0; b < binding_count_; ++b) {
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  set_layout_ = make_set_layout(handle, bindings);
  layout_ = make_pipeline_layout(handle, set_layout_.get(), {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes});
  const ShaderModule shader = make_shader(handle, spirv);

  auto info = structure<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, shader);
  const VkSpecializationMapEntry constant{0, 0, sizeof(frames)};
  const VkSpecializationInfo constants{1, &constant, sizeof(frames), &frames};
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(handle, device.pipeline_cache(), 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  pipeline_ = {handle, pipeline};
}

bool Hazards::before(std::span<const BufferUse> next) const {
  return std::ranges::any_of(next, [&](const BufferUse& use) {
    return std::ranges::any_of(used_, [&](const BufferUse& earlier) { return conflict(earlier, use); });
  });
}

void Hazards::add(std::span<const BufferUse> uses) { used_.insert(used_.end(), uses.begin(), uses.end()); }

void require_threads(std::uint64_t threads, const char* name, const DeviceInfo& limits) {
  const std::uint64_t most = std::uint64_t{limits.max_groups_x} * kWorkgroupSize;
  if (threads <= most) return;
  throw Error(ErrorKind::device, name, ": ", threads, " threads, which a kernel runs at once, are more than the ", most,
              " that '", limits.name, "' can start; the CPU has no such limit");
}

Downloads::Downloads(const Device& device)
    : device_(device),
      pool_(make_command_pool(device, device.copy_family())),
      commands_(allocate_commands(device.handle(), pool_.get())),
      ready_(make_semaphore(device.handle())) {}

void Downloads::begin() {
  check(vkResetCommandPool(device_.handle(), pool_.get(), 0), "vkResetCommandPool");
  const auto info = structure<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
}

void Downloads::copy(const BufferRange& from, const BufferRange& to) {
  if (from.size == 0) return;
  const VkBufferCopy region{from.offset, to.offset, from.size};
  vkCmdCopyBuffer(commands_, from.buffer, to.buffer, 1, &region);
}

void Downloads::end() { end_for_host(commands_); }

Commands::Commands(const Device& device, std::uint32_t most_dispatches)
    : device_(device),
      pool_(make_command_pool(device, device.queue_family())),
      fence_(make_fence(device.handle())),
      allocated_sets_(device),
      commands_(allocate_commands(device.handle(), pool_.get())),
      most_dispatches_(most_dispatches) {
  if (device.timestamp_mask() == 0) return;
  auto query_info = structure<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  query_info.queryCount = kMaxTimestamps;
  VkQueryPool queries = VK_NULL_HANDLE;
  check(vkCreateQueryPool(device.handle(), &query_info, nullptr, &queries), "vkCreateQueryPool");
  queries_ = {device.handle(), queries};
}

Commands::Commands(const Device& device, OfHost)
    : device_(device), allocated_sets_(device), commands_(VK_NULL_HANDLE), most_dispatches_(UINT32_MAX) {}

Commands::~Commands() {
  if (pending_) vkDeviceWaitIdle(device_.handle());  // returns at once when the device is lost
}

void Commands::begin(Sets sets) {
  open();
  if (sets == Sets::anew) forget_sets();
  submission_count_ = 0;
  timestamp_count_ = 0;
  download_state_ = DownloadState::none;
  if (queries_.get() != VK_NULL_HANDLE) vkCmdResetQueryPool(commands_, queries_.get(), 0, kMaxTimestamps);
}

void Commands::forget_sets() {
  sets_.clear();
  allocated_sets_.reset();
}

void Commands::open() {
  check(vkResetCommandPool(device_.handle(), pool_.get(), 0), "vkResetCommandPool");
  dispatch_count_ = 0;
  const auto info = structure<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
  barrier();  // the end of an earlier submission alone does not make what it wrote seen
}

void Commands::record_into(VkCommandBuffer host) {
  commands_ = host;
  dispatch_count_ = 0;  // nothing of the host's is cut
  barrier();            // after the frame before
}

void Commands::copy(const BufferRange& from, const BufferRange& to) {
  if (from.size == 0) return;
  const BufferUse uses[] = {{from, false}, {{to.buffer, to.offset, from.size}, true}};
  wait_for(uses);
  const VkBufferCopy region{from.offset, to.offset, from.size};
  vkCmdCopyBuffer(commands_, from.buffer, to.buffer, 1, &region);
}

void Commands::download(const BufferRange& from, const BufferRange& to) {
  if (device_.copy_family() == device_.queue_family()) return copy(from, to);
  if (!downloads_) downloads_.emplace(device_);
  if (std::exchange(download_state_, DownloadState::open) == DownloadState::none) downloads_->begin();
  downloads_->copy(from, to);
}

void Commands::fill(const BufferRange& range, std::uint32_t word) {
  const BufferUse use{range, true};
  wait_for({&use, 1});
  vkCmdFillBuffer(commands_, range.buffer, range.offset, range.size, word);
}

void Commands::update(const BufferRange& range, std::span<const std::byte> bytes) {
  const BufferUse use{range, true};
  wait_for({&use, 1});
  for (std::size_t at = 0; at < bytes.size(); at += kMostUpdate) {
    const std::size_t size = std::min(kMostUpdate, bytes.size() - at);
    vkCmdUpdateBuffer(commands_, range.buffer, range.offset + at, size, bytes.data() + at);
  }
}

void Commands::barrier() {
  auto memory = structure<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                         VK_ACCESS_TRANSFER_WRITE_BIT;
  const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  vkCmdPipelineBarrier(commands_, stages, stages, 0, 1, &memory, 0, nullptr, 0, nullptr);
  hazards_.clear();
}

void Commands::wait_for(std::span<const BufferUse> uses) {
  if (hazards_.before(uses)) barrier();
  hazards_.add(uses);
}

void Commands::cut() {
  if (dispatch_count_ < most_dispatches_) return;
  close();
  run();
  open();
}

VkDescriptorSet Commands::bind(const Kernel& kernel, std::span<const BufferRange> bindings) {
  const auto bound = sets_.find(std::pair(kernel.set_layout(), bindings));
  if (bound != sets_.end()) return bound->second;
  const std::pair key(kernel.set_layout(), std::vector<BufferRange>(bindings.begin(), bindings.end()));
  return sets_.emplace(key, make_set(kernel, bindings)).first->second;
}

VkDescriptorSet Commands::make_set(const Kernel& kernel, std::span<const BufferRange> bindings) {
  const VkDescriptorSet set = allocated_sets_.allocate(kernel.set_layout());
  std::vector<VkDescriptorBufferInfo> buffers;
  for (const BufferRange& range : bindings) {
    if (range.size > device_.info().max_storage_buffer_range) {
      throw Error(ErrorKind::device, "a table of ", range.size, " bytes is larger than the ",
                  device_.info().max_storage_buffer_range, " bytes that a binding of '", device_.info().name,
                  "' can see");
    }
    buffers.push_back({range.buffer, range.offset, range.size});
  }
  auto write = structure<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.descriptorCount = kernel.binding_count();  // runs on over consecutive bindings of one type
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = buffers.data();
  vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
  return set;
}

void Commands::record_dispatch(const Kernel& kernel, std::span<const BufferRange> bindings,
                               std::span<const std::byte> push, std::uint32_t elements, std::uint32_t frames) {
  if (elements == 0 || frames == 0) return;
  const std::uint32_t groups = (elements - 1) / kWorkgroupSize + 1;
  if (groups > device_.info().max_groups_x || frames > device_.info().max_groups_y) {
    throw Error(ErrorKind::device, "the Vulkan device '", device_.info().name, "' runs at most ",
                device_.info().max_groups_x, " x ", device_.info().max_groups_y, " workgroups at once, ", groups, " x ",
                frames, " are needed; the CPU has no such limit");
  }
  const VkDescriptorSet set = bind(kernel, bindings);
  std::array<BufferUse, BODYOPT_MOST_BINDINGS> uses;
  for (std::uint32_t b = 0; b < kernel.binding_count(); ++b) uses[b] = {bindings[b], kernel.writes(b)};
  wait_for(std::span(uses).first(kernel.binding_count()));
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                     static_cast<std::uint32_t>(push.size()), push.data());
  vkCmdDispatch(commands_, groups, frames, 1);
  ++dispatch_count_;
}

void Commands::timestamp() {
  if (queries_.get() == VK_NULL_HANDLE) return;
  vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_.get(), timestamp_count_++);
}

void Commands::close() { end_for_host(commands_); }

void Commands::end() {
  close();
  if (download_state_ == DownloadState::none) return;
  downloads_->end();
  download_state_ = DownloadState::ended;
}

void Commands::run() {
  Commands* const alone = this;
  submit_together({&alone, 1});
  wait_together({&alone, 1});
}

void Commands::submit_together(std::span<Commands* const> all) {
  const Device& device = all.front()->device_;
  const VkFence fence = all.front()->fence_.get();
  for (Commands* commands : all) commands->has_run_ = false;
  std::vector<VkCommandBuffer> work, copies;
  VkSemaphore ready = VK_NULL_HANDLE;  // one is enough: it is signalled when all work is done
  for (const Commands* commands : all) {
    work.push_back(commands->commands_);
    if (commands->download_state_ != DownloadState::ended) continue;
    copies.push_back(commands->downloads_->handle());
    ready = commands->downloads_->ready();
  }
  check(vkResetFences(device.handle(), 1, &fence), "vkResetFences");
  const std::lock_guard lock(device.queue_mutex());
  auto submit = structure<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = static_cast<std::uint32_t>(work.size());
  submit.pCommandBuffers = work.data();
  submit.signalSemaphoreCount = copies.empty() ? 0 : 1;
  submit.pSignalSemaphores = &ready;
  check(vkQueueSubmit(device.queue(), 1, &submit, copies.empty() ? fence : VK_NULL_HANDLE), "vkQueueSubmit");
  if (!copies.empty()) submit_copies(device, copies, ready, fence);
  for (Commands* commands : all) {
    commands->pending_ = true;
    ++commands->submission_count_;
  }
}

void Commands::wait_together(std::span<Commands* const> all) {
  const Commands& front = *all.front();
  if (!front.pending_) return;  // it could not be submitted
  const VkFence fence = front.fence_.get();
  check(vkWaitForFences(front.device_.handle(), 1, &fence, VK_TRUE, kTimeout), "vkWaitForFences");
  for (Commands* commands : all) {
    commands->pending_ = false;
    commands->has_run_ = true;
  }
}

std::vector<double> Commands::seconds() const {
  std::vector<std::uint64_t> ticks(timestamp_count_);
  std::vector<double> seconds;
  if (ticks.empty()) return seconds;
  check(vkGetQueryPoolResults(device_.handle(), queries_.get(), 0, timestamp_count_, ticks.size() * sizeof(ticks[0]),
                              ticks.data(), sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const std::uint64_t difference = (ticks[i] - ticks[i - 1]) & device_.timestamp_mask();
    seconds.push_back(static_cast<double>(difference) * device_.timestamp_period());
  }
  return seconds;
}

}  // namespace bodyopt::vulkan
