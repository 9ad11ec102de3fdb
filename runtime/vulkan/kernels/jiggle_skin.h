// Vulkan jiggle_skin: the skin goes along with its tets (shaders/kernels/jiggle_skin.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class JiggleSkin {
 public:
  struct Buffers {
    BufferRange tets, skin, positions, displacement, moved;  // positions, moved: of a batch
  };

  explicit JiggleSkin(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const JiggleSkinPush& push) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
