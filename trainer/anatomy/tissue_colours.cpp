#include "trainer/anatomy/tissue_colours.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "assets/joint_roles.h"
#include "assets/wording.h"

namespace bodyopt {
namespace {

constexpr Rgb kOtherLeanColour{222, 150, 138}, kShortenedColour{250, 148, 40}, kStretchedColour{98, 88, 196};
// They are in the order of TissueKind; muscles have colours of their own.
constexpr Rgb kColours[] = {kOtherLeanColour, {236, 228, 204}, {232, 196, 92},  {112, 128, 148},
                            kOtherLeanColour, {250, 250, 246}, kOtherLeanColour};

bool same_tissue(const TissueAt& a, const TissueAt& b) { return a.kind == b.kind && a.muscle == b.muscle; }

// Spread evenly in two directions at once, whatever their number (Roberts 2018, the sequence R2).
Rgb muscle_colour(std::size_t number) {
  const auto share = [&](double step) { return std::fmod(0.5 + step * static_cast<double>(number), 1.0); };
  const double warmth = share(0.7548776662), light = share(0.5698402910);
  const double value = 105 + 95 * light;
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value * (0.18 + 0.34 * warmth)),
          static_cast<std::uint8_t>(value * (0.22 + 0.10 * (1 - warmth)))};
}

Rgb tinted(const Rgb& colour, double stretch) {
  constexpr double kFullStretch = 1.0 / 3;
  const double share = std::clamp((stretch - 1) / kFullStretch, -1.0, 1.0);
  const Rgb& end = share < 0 ? kShortenedColour : kStretchedColour;
  Rgb result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = static_cast<std::uint8_t>(
        std::lerp(static_cast<double>(colour[i]), static_cast<double>(end[i]), std::abs(share)));
  }
  return result;
}

}  // namespace

TissueColours::TissueColours(const std::vector<Muscle>& muscles) {
  const std::vector<std::string> names = names_of(muscles);
  std::vector<std::string> distinct;
  for (const std::string& name : names) {
    const std::string other = mirrored_name(name, names);
    const auto known = std::ranges::find_if(
        distinct, [&](const std::string& d) { return d == name || (!other.empty() && d == other); });
    muscles_.push_back(muscle_colour(static_cast<std::size_t>(known - distinct.begin())));
    if (known == distinct.end()) distinct.push_back(name);
  }
}

Rgb TissueColours::of(const TissueAt& tissue) const {
  return tissue.kind == TissueKind::muscle ? muscles_[static_cast<std::size_t>(tissue.muscle)]
                                           : kColours[static_cast<std::size_t>(tissue.kind)];
}

std::vector<std::uint8_t> TissueColours::picture(const TissueSection& section, std::span<const double> stretch) const {
  constexpr double kBorder = 0.45;  // of the light that is left there
  std::vector<std::uint8_t> rgba(4 * section.tissue.size());
  const auto width = static_cast<std::size_t>(section.width);
  for (std::size_t pixel = 0; pixel < section.tissue.size(); ++pixel) {
    const TissueAt& tissue = section.tissue[pixel];
    if (tissue.kind == TissueKind::outside) continue;
    const bool last = pixel % width + 1 == width, lowest = pixel + width >= section.tissue.size();
    const bool border = (!last && !same_tissue(tissue, section.tissue[pixel + 1])) ||
                        (!lowest && !same_tissue(tissue, section.tissue[pixel + width]));
    const bool strained = !stretch.empty() && tissue.kind == TissueKind::muscle;
    const Rgb colour = strained ? tinted(of(tissue), stretch[pixel]) : of(tissue);
    for (std::size_t i = 0; i < 3; ++i) {
      rgba[4 * pixel + i] = static_cast<std::uint8_t>(border ? kBorder * colour[i] : colour[i]);
    }
    rgba[4 * pixel + 3] = 255;
  }
  return rgba;
}

}  // namespace bodyopt
