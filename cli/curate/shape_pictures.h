// Two shapes of a skin and how far they are apart.
#pragma once

#include <string>

#include "assets/character.h"

namespace bodyopt::cli {

inline constexpr double kFinestScale = 0.1;  // mm: of less nothing is to be seen

// Two shapes in one pose, and the second in the colours of how far it is from the first (hottest at scale_mm), from the
// side where that is most.
void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path);

}  // namespace bodyopt::cli
