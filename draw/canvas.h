// The picture of the window: views of the scene and the panels over them, in an image that is shown or read back. So a
// screenshot, a picture without a window and the window have the same pixels.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "draw/graphics_pipeline.h"
#include "draw/view.h"

namespace bodyopt::draw {

// quick: one sample a pixel, where a software device must keep up.
enum class Edges { smooth, quick };

constexpr VkFormat kPictureFormat = VK_FORMAT_R8G8B8A8_UNORM;  // its bytes are sRGB

inline constexpr std::uint32_t kMostCanvasPixels = 8192;  // a side

class Canvas {
 public:
  // The device must outlive it, and draw. Throws Error(device).
  explicit Canvas(const vulkan::Device& device);
  ~Canvas();

  // Draws the views, then what `panels` records into panel_pass(), and waits for it. Throws Error(usage) for a picture
  // of no pixel or more than most_pixels() a side, Error(device).
  void draw(std::span<const View> views, std::uint32_t width, std::uint32_t height, Edges edges,
            const std::function<void(VkCommandBuffer)>& panels = {});

  // A side of a picture: kMostCanvasPixels, or fewer where the device has no such images.
  std::uint32_t most_pixels() const;
  VkRenderPass panel_pass() const;  // one colour attachment of kPictureFormat, no depth
  // The image of the last draw, ready to be copied from.
  VkImage image() const;
  VkExtent2D size() const;
  Image picture() const;  // waits for a copy

  // Returns the device's time of the last draw, seconds; 0 where the device has no clock.
  double seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bodyopt::draw
