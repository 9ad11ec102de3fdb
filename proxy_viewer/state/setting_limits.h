// How far settings go: in commands, sliders and the state file alike.
#pragma once

namespace bodyopt {

inline constexpr int kMostGhosts = 12, kLongestGhostStep = 1000;   // either way; frames
inline constexpr int kMostCopies = 100, kLongestCopyDelay = 1000;  // frames
inline constexpr int kCoarsestLevel = 15;
inline constexpr int kFurthestAhead = 100000;                      // frames, either way
inline constexpr double kMostJiggle = 4;                           // times what is simulated
inline constexpr double kFinestHeat = 0.01, kCoarsestHeat = 1000;  // mm, of the hottest colour
inline constexpr double kFinestBrush = 0.1, kWidestBrush = 1e4;    // mm, of its radius
inline constexpr double kWidestSpread = 360;                       // degrees, of what is brushed over poses
inline constexpr double kMostTurn = 360;                           // degrees, either way
inline constexpr double kMostControl = 1e6;                        // either way

}  // namespace bodyopt
