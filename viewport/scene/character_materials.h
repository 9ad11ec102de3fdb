// The materials of a character on the device: of its skin and attached meshes, with the images that they share.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "draw/texture.h"
#include "draw/view.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/basis.h"

namespace bodyopt::viewport {

// Plain white materials without an image have no parts.
struct CharacterMaterials {
  std::vector<draw::SurfaceDraw>
      skin;  // of each level of detail; coarser ones have the colours that the finest has there
  std::vector<draw::SurfaceDraw> worn;       // of each attached mesh
  std::vector<std::string> notes;            // of what cannot be read, one sentence each
  std::vector<std::filesystem::path> files;  // their images beside the character's own file, if they are there
  std::vector<draw::Attachment> images;
  std::map<draw::Sampling, draw::Sampler> samplers;
};

// `own`: the character's own file; `levels`: finest first. Throws Error(device).
std::shared_ptr<const CharacterMaterials> make_character_materials(const vulkan::Device& device, const std::string& own,
                                                                   const std::vector<const Basis*>& levels,
                                                                   const Attachments& attached);

}  // namespace bodyopt::viewport
