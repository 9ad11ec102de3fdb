// A brush that sculpts a skin.
#pragma once

#include <array>

namespace bodyopt {

enum class BrushKind { grab, smooth, inflate, flatten, erase };
inline constexpr std::array kBrushKindNames{"grab", "smooth", "inflate", "flatten", "erase"};

struct Brush {
  BrushKind kind = BrushKind::grab;
  double radius = 0.05;   // along the skin: there it does nothing any more
  double strength = 0.5;  // 0 to 1; a grab follows the hand at 1
};

}  // namespace bodyopt
