#include "cli/curate/shape_pictures.h"

#include <vector>

#include "geometry/table_rows.h"
#include "report/pictures.h"

namespace bodyopt::cli {

void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path) {
  constexpr std::uint32_t kWidth = 500, kHeight = 700;
  const std::vector<float> first = floats_of(before), second = floats_of(after);
  const PosePair drawn{
      {character.triangles.data(), static_cast<std::size_t>(character.triangles.size())}, first, second};
  Renderer renderer;
  const Camera camera = frame_pose(drawn, towards_worst(drawn), float{kWidth} / kHeight);
  write_png(comparison(renderer, drawn, scale_mm, camera, kWidth, kHeight), path);
}

}  // namespace bodyopt::cli
