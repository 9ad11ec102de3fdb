#include "assets/caches/usda_materials.h"

#include <cctype>
#include <set>
#include <sstream>

#include "base/content_hash.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr char kImage[] = "asset inputs:file = @./";

// Named by what is in it, so that no other image is written over.
std::string image_file(const SurfaceTexture& texture, const std::string& mesh) {
  return prim_name(mesh) + "_" + prim_name(texture.name).substr(0, 64) + "_" +
         hexadecimal(XXH3_64bits(texture.bytes->data(), texture.bytes->size())).substr(0, 8) + "." +
         texture.type.substr(texture.type.find('/') + 1);
}

// Returns the image of the base colour, in materials that triangles have; null: none.
const SurfaceTexture* base_image(const SkinSurface& surface, const SurfaceMaterial& material) {
  const Json* texture = surface.texture.empty() ? nullptr : material.texture();
  return texture == nullptr ? nullptr : &surface.textures[texture->at("index").get<std::size_t>()];
}

std::string wrapping(const SurfaceTexture& texture, const char* key) {
  const int wrap = texture.sampler.value(key, 0);
  return wrap == kClamped ? "clamp" : wrap == kMirrored ? "mirror" : "repeat";
}

// `prim`: the path of the material.
std::string shaders(const SkinSurface& surface, const SurfaceMaterial& material, const std::string& mesh,
                    const std::string& prim) {
  const SurfaceTexture* image = base_image(surface, material);
  const auto [r, g, b, a] = material.colour();
  const bool is_opaque = material.alpha_mode() == "OPAQUE";
  std::ostringstream text;
  text << "        token outputs:surface.connect = <" << prim << "/surface.outputs:surface>\n"
       << "        def Shader \"surface\"\n        {\n"
       << "            uniform token info:id = \"UsdPreviewSurface\"\n            color3f inputs:diffuseColor";
  if (image != nullptr) {
    text << ".connect = <" << prim << "/image.outputs:rgb>\n";
  } else {
    text << " = (" << r << ", " << g << ", " << b << ")\n";
  }
  if (!is_opaque && image != nullptr) {
    text << "            float inputs:opacity.connect = <" << prim << "/image.outputs:a>\n";
  } else if (!is_opaque) {
    text << "            float inputs:opacity = " << a << '\n';
  }
  if (material.alpha_mode() == "MASK") {
    text << "            float inputs:opacityThreshold = " << material.number("alphaCutoff", 0.5) << '\n';
  }
  text << "            float inputs:metallic = " << material.number("metallicFactor", 1)
       << "\n            float inputs:roughness = " << material.number("roughnessFactor", 1)
       << "\n            token outputs:surface\n        }\n";
  if (image == nullptr) return text.str();
  text << "        def Shader \"image\"\n        {\n            uniform token info:id = \"UsdUVTexture\"\n            "
       << kImage << image_file(*image, mesh) << "@\n            token inputs:sourceColorSpace = \"sRGB\"\n"
       << "            token inputs:wrapS = \"" << wrapping(*image, "wrapS")
       << "\"\n            token inputs:wrapT = \"" << wrapping(*image, "wrapT")
       << "\"\n            float4 inputs:scale = (" << r << ", " << g << ", " << b << ", " << a
       << ")\n            float2 inputs:st.connect = <" << prim << "/st.outputs:result>\n"
       << "            float3 outputs:rgb\n            float outputs:a\n        }\n"
       << "        def Shader \"st\"\n        {\n            uniform token info:id = \"UsdPrimvarReader_float2\"\n"
       << "            string inputs:varname = \"st\"\n            float2 outputs:result\n        }\n";
  return text.str();
}

}  // namespace

std::string prim_name(const std::string& name) {
  std::string prim;
  for (const char c : name) prim += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return prim.empty() || std::isdigit(static_cast<unsigned char>(prim[0])) != 0 ? "_" + prim : prim;
}

std::string usd_materials(const SkinSurface& surface, const std::string& mesh, const std::string& prim) {
  std::string text;
  std::set<std::string> names;
  for (std::size_t m = 0; m < surface.materials.size(); ++m) {
    const SurfaceMaterial& material = surface.materials[m];
    std::string name = prim_name(material.name);
    const auto faces_of = [&] { return "faces_of_" + name; };
    while (names.contains(name) || names.contains(faces_of())) name += "_" + std::to_string(m);
    names.insert({name, faces_of()});
    const std::string path = prim + "/" + name;
    std::string faces;
    for (std::size_t t = 0; t < surface.material_of.size(); ++t) {
      if (surface.material_of[t] == m) faces += (faces.empty() ? "" : ", ") + std::to_string(t);
    }
    text += "    def Material \"" + name + "\"\n    {\n" + shaders(surface, material, mesh, path) + "    }\n";
    text += "    def GeomSubset \"" + faces_of();
    text +=
        "\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n    {\n"
        "        uniform token elementType = \"face\"\n        uniform token familyName = \"materialBind\"\n"
        "        int[] indices = [";
    text += faces;
    text += "]\n        rel material:binding = <" + path + ">\n    }\n";
  }
  return text;
}

void write_usd_images(const SkinSurface& surface, const std::string& mesh, const fs::path& folder) {
  std::set<const std::string*> written;
  for (const SurfaceMaterial& material : surface.materials) {
    const SurfaceTexture* image = base_image(surface, material);
    if (image != nullptr && written.insert(image->bytes.get()).second) {
      write_file_atomically(folder / image_file(*image, mesh), *image->bytes);
    }
  }
}

void copy_usd_images(const std::string& text, const fs::path& from, const fs::path& to) {
  std::set<std::string> copied;
  for (std::size_t at = text.find(kImage); at != std::string::npos; at = text.find(kImage, at)) {
    at += sizeof(kImage) - 1;
    const std::string name = text.substr(at, text.find('@', at) - at);
    if (name.find('/') != std::string::npos || to == from || !copied.insert(name).second) continue;
    write_file_atomically(to / name, read_file(from / name, std::size_t{1} << 30, "an image"));
  }
}

}  // namespace bodyopt
