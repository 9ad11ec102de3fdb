#include "viewport/scene/character_materials.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "draw/colours.h"
#include "draw/image_decode.h"
#include "geometry/nearest_skin.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "shots/shot_files.h"

namespace bodyopt::viewport {
namespace {

constexpr std::size_t kMostPixels = std::size_t{1} << 28;  // of all images

std::uint32_t two_shares(double low, double high) {
  const auto steps = [](double share) { return static_cast<std::uint32_t>(std::lround(65535 * share)); };
  return steps(high) << 16 | steps(low);
}

VkSamplerAddressMode wrapping_of(const Json& sampler, const char* key) {
  const int wrap = sampler.value(key, 0);
  if (wrap == kClamped) return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  return wrap == kMirrored ? VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT : VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

const SurfaceTexture& texture_of(const SkinSurface& surface, const Json& texture) {
  return surface.textures[texture.at("index").get<std::size_t>()];
}

// Returns the map of glTF's material; null: it has none.
const Json* normal_map(const SurfaceMaterial& material) {
  const auto found = material.gltf.find("normalTexture");
  return found == material.gltf.end() ? nullptr : &*found;
}

const Json* roughness_map(const SurfaceMaterial& material) {
  const auto own = material.gltf.find("pbrMetallicRoughness");
  if (own == material.gltf.end() || !own->contains("metallicRoughnessTexture")) return nullptr;
  return &own->at("metallicRoughnessTexture");
}

double roughness(const SurfaceMaterial& material) {
  const auto own = material.gltf.find("pbrMetallicRoughness");
  return own == material.gltf.end() ? 1 : own->value("roughnessFactor", 1.0);
}

// Reads an image that repeats.
std::uint8_t byte_at(const draw::Image& image, double u, double v, std::size_t channel) {
  const auto place = [](double at, std::uint32_t pixels) {
    return std::min(static_cast<std::size_t>((at - std::floor(at)) * pixels), std::size_t{pixels} - 1);
  };
  const std::size_t k = place(v, image.height) * image.width + place(u, image.width);
  return image.rgba[4 * k + channel];
}

// A share of light.
double pixel(const draw::Image& image, double u, double v, std::size_t channel) {
  return static_cast<double>(draw::linear(byte_at(image, u, v, channel)));
}

// See SurfacePart::detail. Null: none.
draw::Image detail_of(const draw::Image* normals, double scale, const draw::Image* rough, double factor) {
  const auto side = [&](std::uint32_t draw::Image::*length) {
    return std::max({1u, normals ? normals->*length : 1u, rough ? rough->*length : 1u});
  };
  draw::Image detail{side(&draw::Image::width), side(&draw::Image::height), {}};
  detail.rgba.reserve(std::size_t{4} * detail.width * detail.height);
  for (std::uint32_t y = 0; y < detail.height; ++y) {
    for (std::uint32_t x = 0; x < detail.width; ++x) {
      const double u = (x + 0.5) / detail.width, v = (y + 0.5) / detail.height;
      for (const std::size_t channel : {0, 1}) {
        const double along = normals ? scale * (byte_at(*normals, u, v, channel) - 128.0) : 0;
        detail.rgba.push_back(static_cast<std::uint8_t>(std::lround(128 + std::clamp(along, -127.0, 127.0))));
      }
      detail.rgba.push_back(static_cast<std::uint8_t>(std::lround(factor * (rough ? byte_at(*rough, u, v, 1) : 255))));
      detail.rgba.push_back(255);
    }
  }
  return detail;
}

bool says_something(const SkinSurface& surface) {
  const auto is_dark = [](double share) { return share < 1; };
  return std::ranges::any_of(surface.colours, is_dark) ||
         std::ranges::any_of(surface.materials, [&](const SurfaceMaterial& material) {
           return material.texture() != nullptr || normal_map(material) != nullptr || roughness(material) < 1 ||
                  roughness_map(material) != nullptr || std::ranges::any_of(material.colour(), is_dark);
         });
}

class MaterialsMaker {
 public:
  MaterialsMaker(const vulkan::Device& device, const std::string& own)
      : device_(device), own_(own), made_(std::make_shared<CharacterMaterials>()) {}

  // `places`: of the vertices of the surface among the positions; empty: they are the same.
  draw::SurfaceDraw make(const SkinSurface& surface, std::span<const std::uint32_t> corners,
                         std::span<const std::uint32_t> places, std::size_t count) {
    draw::SurfaceDraw draw;
    if (!says_something(surface)) return draw;
    const auto [split, own_corners, own_places] = split_corners(surface, corners, count);
    const std::vector<double> at = image_coordinates(split, own_corners);
    std::vector<draw::SurfaceVertex> vertices;
    for (std::size_t v = 0; v < own_places.size(); ++v) {
      const std::uint32_t place = own_places[v];
      draw::SurfaceVertex& vertex =
          vertices.emplace_back(draw::SurfaceVertex{places.empty() ? place : places[place], 0, 0, ~0u, ~0u});
      if (!at.empty()) {
        vertex.u = static_cast<float>(at[2 * v]);
        vertex.v = static_cast<float>(at[2 * v + 1]);
      }
      if (split.colours.empty()) continue;
      vertex.red_green = two_shares(split.colours[3 * v], split.colours[3 * v + 1]);
      vertex.blue = two_shares(split.colours[3 * v + 2], 0);
    }
    std::vector<std::vector<std::uint32_t>> own(std::max<std::size_t>(1, surface.materials.size()));
    for (std::size_t c = 0; c < corners.size(); ++c) {
      own[surface.materials.empty() ? 0 : surface.material_of[c / 3]].push_back(own_corners[c]);
    }
    std::vector<std::uint32_t> sorted;
    for (std::size_t m = 0; m < own.size(); ++m) {
      draw::SurfacePart& part = draw.parts.emplace_back(
          part_of(surface, surface.materials.empty() ? SurfaceMaterial() : surface.materials[m]));
      part.first_corner = static_cast<std::uint32_t>(sorted.size());
      part.corner_count = static_cast<std::uint32_t>(own[m].size());
      std::ranges::copy(own[m], std::back_inserter(sorted));
    }
    draw.corners = vulkan::upload(device_, sorted, "the triangles by material");
    draw.vertices = vulkan::upload(device_, vertices, "coordinates in images");
    return draw;
  }

  // Returns colours for the vertices of the finest level, V x 3, linear.
  Positions colours_of(const SkinSurface& surface, const MeshTable& mesh) {
    Positions colours = Positions::Ones(mesh.vertex_count(), 3);
    const std::vector<double> at = image_coordinates(surface, mesh.output_triangles);
    std::vector<const draw::Image*> images;  // of the materials; null: none
    const auto factors = transformed(surface.materials, &SurfaceMaterial::colour);
    for (const SurfaceMaterial& material : surface.materials) {
      const bool has_image = !at.empty() && material.texture() != nullptr;
      images.push_back(has_image ? &shown_of(texture_of(surface, *material.texture())).image : nullptr);
    }
    for (std::size_t c = 0; c < mesh.output_triangles.size(); ++c) {
      const std::size_t v = mesh.output_triangles[c], m = surface.materials.empty() ? 0 : surface.material_of[c / 3];
      const std::size_t row = surface.row(mesh.output_triangles, c);
      auto colour = colours.row(mesh.output_vertex[v]);
      for (std::size_t k = 0; k < 3; ++k) {
        double& share = colour[static_cast<Eigen::Index>(k)] = surface.colours.empty() ? 1 : surface.colours[3 * v + k];
        if (m >= images.size()) continue;
        share *= factors[m][k];
        if (images[m] != nullptr && images[m]->width > 0) share *= pixel(*images[m], at[2 * row], at[2 * row + 1], k);
      }
    }
    return colours;
  }

  draw::SurfaceDraw make_coarser(const Positions& colours, const NearestSkin& finest, const MeshTable& mesh) {
    SkinSurface surface;
    const Positions rest = rows_of(mesh.rest);
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const auto colour = at_point(colours, finest(rest.row(v)));
      surface.colours.insert(surface.colours.end(), colour.begin(), colour.end());
    }
    return make(surface, mesh.triangles, {}, mesh.vertex_count());
  }

  const std::shared_ptr<CharacterMaterials>& made() const { return made_; }

 private:
  draw::SurfacePart part_of(const SkinSurface& surface, const SurfaceMaterial& material) {
    draw::SurfacePart part{};
    std::ranges::transform(material.colour(), part.colour.begin(), [](double x) { return static_cast<float>(x); });
    if (material.alpha_mode() == "BLEND") part.least_alpha = 0;
    if (material.alpha_mode() == "MASK") part.least_alpha = static_cast<float>(material.number("alphaCutoff", 0.5));
    const auto given = [&](const Json* texture) { return surface.texture.empty() ? nullptr : texture; };
    VkImageView view = VK_NULL_HANDLE;
    if (const Json* colour = given(material.texture())) {
      Shown& shown = shown_of(texture_of(surface, *colour));
      if (shown.view == VK_NULL_HANDLE && shown.image.width > 0) shown.view = upload(shown.image);
      view = shown.view;
    }
    part.image = {view != VK_NULL_HANDLE ? view : white(), sampler_of(surface, given(material.texture()))};
    const Json *normal = given(normal_map(material)), *rough = given(roughness_map(material));
    part.detail = {detail_view(surface, material, normal, rough), sampler_of(surface, normal ? normal : rough)};
    return part;
  }

  VkSampler sampler_of(const SkinSurface& surface, const Json* texture) {
    draw::Sampling sampling;
    if (texture) {
      const Json& given = texture_of(surface, *texture).sampler;
      sampling = {wrapping_of(given, "wrapS"), wrapping_of(given, "wrapT"),
                  given.value("magFilter", kLinear) == kLinear};
    }
    const auto [sampler, is_new] = made_->samplers.try_emplace(sampling);
    if (is_new) sampler->second = draw::make_sampler(device_, sampling);
    return sampler->second.get();
  }

  VkImageView detail_view(const SkinSurface& surface, const SurfaceMaterial& material, const Json* normal,
                          const Json* rough) {
    const auto image = [&](const Json* texture) {
      const draw::Image* found = texture ? &shown_of(texture_of(surface, *texture)).image : nullptr;
      return found && found->width > 0 ? found : nullptr;
    };
    const double scale = normal ? normal->value("scale", 1.0) : 1;
    const draw::Image *normals = image(normal), *roughs = image(rough);
    const auto [known, is_new] = details_.try_emplace({normals, scale, roughs, roughness(material)}, VK_NULL_HANDLE);
    if (is_new) {
      const double factor = std::clamp(roughness(material), 0.0, 1.0);
      draw::Image detail = detail_of(normals, scale, roughs, factor);
      pixels_ += std::size_t{detail.width} * detail.height;
      if (pixels_ > kMostPixels) detail = detail_of(nullptr, 1, nullptr, factor);
      known->second = upload(detail, VK_FORMAT_R8G8B8A8_UNORM);
    }
    return known->second;
  }

  VkImageView upload(const draw::Image& image, VkFormat format = draw::kColourFormat) {
    return made_->images.emplace_back(draw::make_texture(device_, image, format)).view.get();
  }

  VkImageView white() {
    if (white_ == VK_NULL_HANDLE) white_ = upload({1, 1, {255, 255, 255, 255}});
    return white_;
  }

  struct Shown {
    draw::Image image;                  // no pixels: it cannot be shown
    VkImageView view = VK_NULL_HANDLE;  // where it is of a colour, and was asked for
  };

  Shown& shown_of(const SurfaceTexture& texture) {
    const auto [known, is_new] = known_.try_emplace(*texture.bytes);
    if (!is_new) return known->second;
    try {
      draw::Image image = draw::decode_image(std::as_bytes(std::span(*texture.bytes)));
      pixels_ += std::size_t{image.width} * image.height;
      if (pixels_ > kMostPixels) throw Error(ErrorKind::file, "is more than can be shown, with those before it");
      known->second.image = std::move(image);
    } catch (const Error& error) {
      made_->notes.push_back(own_ + ": image '" + texture.name + "' " + error.what() +
                             "; its material's colour is shown");
    }
    return known->second;
  }

  const vulkan::Device& device_;
  const std::string& own_;
  std::shared_ptr<CharacterMaterials> made_;
  std::map<std::string, Shown> known_;  // by what is in its file
  std::size_t pixels_ = 0;
  VkImageView white_ = VK_NULL_HANDLE;
  std::map<std::tuple<const draw::Image*, double, const draw::Image*, double>, VkImageView>
      details_;  // see detail_of()
};

}  // namespace

std::shared_ptr<const CharacterMaterials> make_character_materials(const vulkan::Device& device, const std::string& own,
                                                                   const std::vector<const Basis*>& levels,
                                                                   const Attachments& attached) {
  MaterialsMaker maker(device, own);
  CharacterMaterials& made = *maker.made();
  const MeshTable& mesh = levels.front()->mesh;
  const shots::Tell tell = [&](const std::string& note) { made.notes.push_back(note); };
  const SkinSurface skin = shots::surface_if_any(own, mesh, tell);
  made.files = skin.files;
  made.skin.push_back(maker.make(skin, mesh.output_triangles, mesh.output_vertex, mesh.output_count()));
  made.skin.resize(levels.size());
  if (levels.size() > 1 && !made.skin.front().parts.empty()) {
    const Positions rest = rows_of(mesh.rest), colours = maker.colours_of(skin, mesh);
    const Triangles triangles = rows_of(mesh.triangles);
    const NearestSkin finest(rest, triangles);
    for (std::size_t k = 1; k < levels.size(); ++k) made.skin[k] = maker.make_coarser(colours, finest, levels[k]->mesh);
  }
  const std::vector<SkinSurface> worn = shots::attached_surfaces(own, *levels.front(), attached, tell);
  for (std::size_t m = 0; m < worn.size(); ++m) {
    const AttachedMesh& own_mesh = attached.meshes[m];
    std::ranges::copy(worn[m].files, std::back_inserter(made.files));
    made.worn.push_back(maker.make(worn[m], own_mesh.triangles, {}, own_mesh.vertex_count()));
  }
  return maker.made();
}

}  // namespace bodyopt::viewport
