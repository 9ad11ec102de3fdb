#include "viewport/image_plane.h"

#include <filesystem>
#include <span>
#include <utility>

#include "draw/image_decode.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "viewport/picture_files.h"

namespace bodyopt::viewport {

void ImagePlane::look(Controls& controls, std::vector<draw::View>& views) {
  const auto& [pattern, opacity] = controls.image_plane;
  std::string file;
  try {
    if (!pattern.empty()) file = FrameSequenceName(pattern, 1)(controls.playback.frame()).string();
  } catch (const Error& error) {  // two places for the frame
    if (told_ != std::exchange(told_, pattern)) controls.warn(error.what());
  }
  if (file != std::exchange(file_, file)) read(file, controls);
  if (!image_) return;
  for (draw::View& view : views) {
    view.backdrop = draw::Backdrop{{image_->view.get(), sampler_->get()}, aspect_, static_cast<float>(opacity)};
  }
}

void ImagePlane::read(const std::string& file, Controls& controls) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 30;  // bytes
  image_.reset();
  if (file.empty()) return;
  std::error_code absent;
  if (!std::filesystem::exists(file, absent)) {
    if (told_ != std::exchange(told_, controls.image_plane.file))
      controls.warn(file + ": is not there, nor shown behind");
    return;
  }
  std::string bytes;
  try {
    bytes = read_file(file, kMost, "an image");
  } catch (const Error& error) {  // which names the file
    return controls.warn(error.what());
  }
  try {
    const draw::Image image = draw::decode_image(std::as_bytes(std::span(bytes)));
    image_ = draw::make_texture(*device_, image);
    aspect_ = static_cast<float>(image.width) / static_cast<float>(image.height);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::device) throw;
    return controls.warn(file + ": " + error.what());
  }
  constexpr VkSamplerAddressMode kEdge = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  if (!sampler_) sampler_ = draw::make_sampler(*device_, {kEdge, kEdge});
}

}  // namespace bodyopt::viewport
