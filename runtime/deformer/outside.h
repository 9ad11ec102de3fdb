// What is said of poses outside the trained range.
#pragma once

namespace bodyopt {

// Standard deviations beyond the trained range (Evaluation::outside) that are worth telling: less is written as 0.0.
constexpr float kOutsideWorthTelling = 0.05f;

}  // namespace bodyopt
