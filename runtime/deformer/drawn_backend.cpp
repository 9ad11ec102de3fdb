#include "runtime/deformer/drawn_backend.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "runtime/vulkan/buffer.h"

namespace bodyopt {
namespace {

class DrawnBackend final : public Backend {
 public:
  DrawnBackend(std::unique_ptr<Backend> cpu, std::shared_ptr<const vulkan::Device> device, std::uint64_t skin_bytes)
      : cpu_(std::move(cpu)), device_(std::move(device)), skin_bytes_(std::max<std::uint64_t>(1, skin_bytes)) {}

  std::string name() const override { return cpu_->name(); }
  Executor& threads() const override { return cpu_->threads(); }
  std::uint32_t batch_limit() const override { return cpu_->batch_limit(); }
  std::uint32_t largest_batch() const override {
    const std::uint64_t bytes = std::min(device_->info().max_storage_buffer_range, device_->info().memory_bytes / 64);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(bytes / skin_bytes_, 1, kMostFrames));
  }
  void set_rest_coefficients(std::span<const float> values) override { cpu_->set_rest_coefficients(values); }
  void set_weights(const Weights& weights) override { cpu_->set_weights(weights); }
  void set_motion(const NodeMotion& motion) override { cpu_->set_motion(motion); }
  NodeMotion motion() const override { return cpu_->motion(); }
  DeviceSkin device_skin() const override { return {&positions_, &normals_}; }

  const BatchResult& run(const Batch& batch) override {
    const BatchResult& result = cpu_->run(batch);
    show(result.positions, positions_, "the positions");
    show(result.normals, normals_, "the normals");
    return result;
  }

 private:
  static constexpr std::uint32_t kMostFrames = 1024;  // a frame, its ghosts and copies are one batch

  // All memory of a software device is the host's: what is drawn is read where it is written.
  void show(std::span<const float> values, vulkan::Buffer& buffer, const char* name) const {
    if (buffer.size() < values.size_bytes()) {
      buffer = vulkan::Buffer(*device_, values.size_bytes(), vulkan::Memory::staging, name);
    }
    if (!values.empty()) std::memcpy(buffer.mapped(), values.data(), values.size_bytes());
  }

  std::unique_ptr<Backend> cpu_;
  std::shared_ptr<const vulkan::Device> device_;
  const std::uint64_t skin_bytes_;  // of a frame
  vulkan::Buffer positions_, normals_;
};

}  // namespace

std::unique_ptr<Backend> make_drawn_backend(std::unique_ptr<Backend> cpu, std::shared_ptr<const vulkan::Device> device,
                                            std::uint64_t skin_bytes) {
  return std::make_unique<DrawnBackend>(std::move(cpu), std::move(device), skin_bytes);
}

}  // namespace bodyopt
