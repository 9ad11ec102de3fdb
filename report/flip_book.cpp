#include "report/flip_book.h"

#include <array>

#include "report/pictures.h"

namespace bodyopt {
namespace {

Image draw(Renderer& renderer, std::span<const std::uint32_t> triangles, std::span<const float> skin,
           std::span<const float> colours, const Panel& panel) {
  const std::vector<float> normals = smooth_normals(triangles, skin);
  const DrawMesh mesh{skin, normals, triangles, colours};
  return renderer.draw(std::span(&mesh, 1), panel.camera, panel.width, panel.height);
}

}  // namespace

std::vector<Image> flip_book_frames(Renderer& renderer, const FlipBook& book, const Panel& panel) {
  std::vector<Image> frames;
  for (std::size_t k = 0; k < book.still.size(); ++k) {
    const std::array panels{draw(renderer, book.triangles, book.still[k], {}, panel),
                            draw(renderer, book.triangles, book.jiggling[k], {}, panel)};
    frames.push_back(side_by_side(panels));
  }
  return frames;
}

Image flip_book_strip(Renderer& renderer, const FlipBook& book, std::span<const std::size_t> frames, double scale_mm,
                      const Panel& panel) {
  std::vector<Image> still, jiggling;
  for (const std::size_t k : frames) {
    still.push_back(draw(renderer, book.triangles, book.still[k], {}, panel));
    const std::vector<float> colours = heat_map({book.triangles, book.still[k], book.jiggling[k]}, scale_mm);
    jiggling.push_back(draw(renderer, book.triangles, book.jiggling[k], colours, panel));
  }
  Image strip = side_by_side(still);
  const Image below = side_by_side(jiggling);
  strip.height += below.height;
  strip.rgba.insert(strip.rgba.end(), below.rgba.begin(), below.rgba.end());
  return strip;
}

}  // namespace bodyopt
