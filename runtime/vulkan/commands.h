// Work for the device: recorded once, run any number of times; long work is run piece by piece as it is recorded. What
// is recorded sees what was recorded before: barriers stand where kernels, copies and fills use a buffer that needs
// them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "runtime/vulkan/buffer.h"
#include "runtime/vulkan/device.h"
#include "runtime/vulkan/functions.h"
#include "runtime/vulkan/make.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

// Descriptor sets from pools that are kept: one pool while the sets are few.
class DescriptorSets {
 public:
  explicit DescriptorSets(const Device& device) : device_(device) {}
  // Forgets all sets; nothing that uses them may be running.
  void reset();
  // A set holds storage buffers, as many as any kernel has, and two sampled images. Throws Error(device).
  VkDescriptorSet allocate(VkDescriptorSetLayout layout);

 private:
  using Pool = Owned<VkDescriptorPool, vkDestroyDescriptorPool>;

  Pool make_pool() const;

  const Device& device_;
  std::vector<Pool> pools_;  // made when those before are used up
  std::size_t made_ = 0;     // sets
};

// A compute kernel: its pipeline and the layout of its bindings (storage buffers 0, 1, ... of set 0).
class Kernel {
 public:
  // The bindings are those that the shader declares; `written`: a bit for each, of those that it writes, and the others
  // it reads. `frames`: what its constant 0 is, where it has one. Throws Error(device).
  Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t written, std::uint32_t push_bytes,
         std::uint32_t frames = 1);

  VkPipeline pipeline() const { return pipeline_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  std::uint32_t binding_count() const { return binding_count_; }
  bool writes(std::uint32_t binding) const { return written_ >> binding & 1; }

 private:
  std::uint32_t binding_count_, written_;
  SetLayout set_layout_;
  PipelineLayout layout_;
  Owned<VkPipeline, vkDestroyPipeline> pipeline_;
};

// How a kernel, copy or fill uses a range of a buffer.
struct BufferUse {
  BufferRange range;
  bool writes = false;
};

// Ranges that work without a barrier between has used. What one kernel or copy does with a range twice is no hazard.
class Hazards {
 public:
  // Whether work with these uses needs a barrier before it.
  bool before(std::span<const BufferUse> next) const;
  void add(std::span<const BufferUse> uses);
  void clear() { used_.clear(); }  // a barrier stands here

 private:
  std::vector<BufferUse> used_;
};

// A kernel that has no windows runs so many threads at once, one for each of `name`. Throws Error(device), naming it,
// where a device of these limits starts fewer.
void require_threads(std::uint64_t threads, const char* name, const DeviceInfo& limits);

// Copies on the device's queue for copies.
class Downloads {
 public:
  explicit Downloads(const Device& device);
  void begin();  // forgets what was recorded before
  void copy(const BufferRange& from, const BufferRange& to);
  void end();

  VkCommandBuffer handle() const { return commands_; }
  VkSemaphore ready() const { return ready_.get(); }  // is signalled once what they copy is there

 private:
  const Device& device_;
  CommandPool pool_;
  VkCommandBuffer commands_;
  Semaphore ready_;
};

class Commands {
 public:
  // Dispatches of a submission, so that a software device on a busy machine ends well before the time-out.
  static constexpr std::uint32_t kMostDispatches = 4096;

  explicit Commands(const Device& device, std::uint32_t most_dispatches = kMostDispatches);
  // Records into command buffers of the host program, which begins, ends and submits them: record_into() says which.
  // Only functions below that record may be called. Descriptor sets stay until forget_sets().
  enum class OfHost { yes };
  Commands(const Device& device, OfHost);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  // Recording. begin() forgets what was recorded before; descriptor sets may be kept where all buffers of that still
  // exist. Buffers and kernels must outlive the last run(). What is recorded by way of handle() has barriers of its
  // own.
  enum class Sets { anew, kept };
  void begin(Sets sets = Sets::anew);
  void copy(const BufferRange& from, const BufferRange& to);  // the size of `from`
  void fill(const BufferRange& range, std::uint32_t word);
  void update(const BufferRange& range, std::span<const std::byte> bytes);  // as many as the range has; multiples of 4
  // Copies as copy(). Where the device has a queue for copies that does it once all that is recorded has run, and what
  // is submitted next runs beside it. `from` is of Memory::fetched.
  void download(const BufferRange& from, const BufferRange& to);
  void record_into(VkCommandBuffer host);
  void forget_sets();
  // Splits long work: once kMostDispatches are recorded they run, and recording goes on after them. What was recorded
  // before is then not run again. Throws as run().
  void cut();
  // Runs a kernel over (elements, frames). Throws Error(device) when the device cannot run as many workgroups at once.
  template <typename Push>
  void dispatch(const Kernel& kernel, std::span<const BufferRange> bindings, const Push& push, std::uint32_t elements,
                std::uint32_t frames) {
    static_assert(sizeof(Push) <= 128);
    record_dispatch(kernel, bindings, std::as_bytes(std::span(&push, 1)), elements, frames);
  }
  void timestamp();
  VkCommandBuffer handle() const { return commands_; }  // to record what is not here: drawing
  void end();

  // Submits what cut() has not, and waits; afterwards the host sees what was copied to staging buffers. Throws
  // Error(device) when the device is lost or does not finish.
  void run();
  // run() of several of one device, which have ended, in two halves: one submission, and one wait.
  static void submit_together(std::span<Commands* const> all);
  static void wait_together(std::span<Commands* const> all);
  bool has_run() const { return has_run_; }  // to its end, the last time
  const Device& device() const { return device_; }

  // Submissions since begin().
  std::uint32_t submission_count() const { return submission_count_; }

  // Seconds between consecutive timestamps of the last run(), those between its submissions included; empty when the
  // device has none.
  std::vector<double> seconds() const;

 private:
  void open();
  void close();
  void barrier();
  // A barrier, where work that does this needs one before it.
  void wait_for(std::span<const BufferUse> uses);
  void record_dispatch(const Kernel& kernel, std::span<const BufferRange> bindings, std::span<const std::byte> push,
                       std::uint32_t elements, std::uint32_t frames);
  VkDescriptorSet bind(const Kernel& kernel, std::span<const BufferRange> bindings);
  VkDescriptorSet make_set(const Kernel& kernel, std::span<const BufferRange> bindings);

  const Device& device_;
  CommandPool pool_;
  Owned<VkQueryPool, vkDestroyQueryPool> queries_;
  Fence fence_;
  Hazards hazards_;
  DescriptorSets allocated_sets_;
  // Sets of the same bindings are used again: the steps of many frames need few.
  struct InOrder {
    using is_transparent = void;  // to be found by a span
    bool operator()(const auto& a, const auto& b) const {
      return a.first != b.first ? a.first < b.first : std::ranges::lexicographical_compare(a.second, b.second);
    }
  };
  std::map<std::pair<VkDescriptorSetLayout, std::vector<BufferRange>>, VkDescriptorSet, InOrder> sets_;
  VkCommandBuffer commands_;
  const std::uint32_t most_dispatches_;
  std::uint32_t dispatch_count_ = 0;  // since the last submission
  std::uint32_t submission_count_ = 0;
  std::uint32_t timestamp_count_ = 0;
  bool pending_ = false, has_run_ = false;
  std::optional<Downloads> downloads_;  // made when first wanted
  enum class DownloadState { none, open, ended } download_state_ = DownloadState::none;
};

class AttachedMeshes;

// Three numbers of each vertex, four of a tangent, in output order, bytes; strides and offset are multiples of 4.
struct PlacedOutput {
  VkBuffer buffer = VK_NULL_HANDLE;  // none: not wanted
  VkDeviceSize size = 0, offset = 0, element_stride = 0, frame_stride = 0;
};

// The outputs of some frames that are recorded for a host program: into its command buffer, to its buffers.
struct Recording {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  PlacedOutput positions, normals, tangents;
  const AttachedMeshes* attached = nullptr;    // that follow the skin, where one of them is wanted
  std::vector<PlacedOutput> attached_to = {};  // of each of them
  std::uint32_t most_frames = 1;               // of this recording and those that follow: the first one's counts
};

}  // namespace bodyopt::vulkan
