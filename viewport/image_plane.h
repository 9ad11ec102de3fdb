// An image, or a sequence of them, behind the characters: what a shot was filmed on, or is drawn after.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "draw/texture.h"
#include "draw/view.h"
#include "viewport/commands/controls.h"

namespace bodyopt::viewport {

class ImagePlane {
 public:
  explicit ImagePlane(std::shared_ptr<const vulkan::Device> device) : device_(std::move(device)) {}

  // Puts the frame's image behind what the views show. Images that cannot be read are reported, of missing ones the
  // first. Throws Error(device).
  void look(Controls& controls, std::vector<draw::View>& views);

 private:
  void read(const std::string& file, Controls& controls);

  std::shared_ptr<const vulkan::Device> device_;
  std::optional<draw::Sampler> sampler_;
  std::optional<draw::Attachment> image_;  // of the file that was read last, if it could be
  float aspect_ = 1;
  std::string file_, told_;  // of the last look; of the plane whose missing images were reported
};

}  // namespace bodyopt::viewport
