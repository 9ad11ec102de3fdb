#include "report/section_picture.h"

#include <algorithm>

#include "report/region_picture.h"

namespace bodyopt {
namespace {

constexpr std::uint8_t kGround[] = {28, 28, 30, 255};

Image ground(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, {}};
  image.rgba.reserve(std::size_t{4} * width * height);
  for (std::size_t pixel = 0; pixel < std::size_t{width} * height; ++pixel) {
    image.rgba.insert(image.rgba.end(), std::begin(kGround), std::end(kGround));
  }
  return image;
}

void paste(const Image& picture, std::uint32_t left, std::uint32_t top, Image& onto) {
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    const auto from = picture.rgba.begin() + static_cast<std::ptrdiff_t>(std::size_t{4} * y * picture.width);
    const std::size_t at = std::size_t{4} * (std::size_t{top + y} * onto.width + left);
    std::copy_n(from, std::size_t{4} * picture.width, onto.rgba.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

}  // namespace

Image section_image(const TissueSection& section, const TissueColours& colours) {
  Image image{static_cast<std::uint32_t>(section.width), static_cast<std::uint32_t>(section.height),
              colours.picture(section)};
  for (std::size_t pixel = 0; pixel < image.rgba.size(); pixel += 4) {
    if (image.rgba[pixel + 3] == 0) std::ranges::copy(kGround, image.rgba.begin() + static_cast<std::ptrdiff_t>(pixel));
  }
  return image;
}

Soup standing_section(const SectionPlane& plane, std::span<const std::uint8_t> rgba) {
  const auto vec = [](const Eigen::Vector3d& v) { return Vec3{v.x(), v.y(), v.z()}; };
  return standing_picture({vec(plane.corner), vec(plane.pixel * plane.right), vec(plane.pixel * plane.down),
                           static_cast<std::uint32_t>(plane.width), rgba});
}

Image numbered_sheet(std::span<const Image> pictures, std::uint32_t of_one) {
  constexpr std::uint32_t kColumns = 4, kMargin = 6;
  std::uint32_t width = 1, height = 1;
  for (const Image& picture : pictures) {
    width = std::max(width, picture.width + 2 * kMargin);
    height = std::max(height, picture.height + 2 * kMargin);
  }
  const auto count = static_cast<std::uint32_t>(pictures.size());
  const std::uint32_t columns = std::clamp(count, 1u, kColumns), rows = std::max(1u, (count + kColumns - 1) / kColumns);
  Image sheet = ground(columns * width, rows * height);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Image& picture = pictures[k];
    const std::uint32_t left = k % kColumns * width, top = k / kColumns * height;
    paste(picture, left + (width - picture.width) / 2, top + (height - picture.height) / 2, sheet);
    if (k % of_one != 0) continue;
    draw_number(sheet, static_cast<int>(k / of_one) + 1, static_cast<int>(left) + 16, static_cast<int>(top) + 16);
  }
  return sheet;
}

}  // namespace bodyopt
