// How active a muscle is in a pose, and which muscles a control flexes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/characters/muscles.h"

namespace bodyopt::trainer {

double rest_length(const Muscle& muscle);  // of its path, metres

// Length of a muscle's path with its points moved by their joints' skinning matrices, metres.
double path_length(const Muscle& muscle, std::span<const Affine> skinning);

// A muscle's effect on its fibres in a pose, beyond its tone at rest, which is part of the rest shape.
struct FibreDrive {
  double activation;  // 0 .. max_activation
  double slack;       // stretch: to it active fibres shorten, and no further
};

// Per muscle. The activation depends, smoothly, only on how much shorter its path is than at rest. It is zero at rest
// and when stretched, full when shortened by a fifth. Bones hold the ends of the path. The belly shortens by as much as
// the path, and as tendon and aponeurosis in series stretch at the largest force. That is 4 % of the path (Zajac 1989).
// `least_slack` of its length is left at least. `bellies`: lengths at rest, metres; 0: the whole path.
std::vector<FibreDrive> fibre_drives(const std::vector<Muscle>& muscles, std::span<const double> bellies,
                                     std::span<const Affine> skinning, double least_slack);

// Whether a pattern means a name: it is the name or, where it ends with '*', how the name begins.
bool matches_pattern(const std::string& pattern, const std::string& name);

// The muscles that each control flexes: the one of its name or, where it ends with '*', all whose names begin like it.
// Throws Error(mismatch) for a control that flexes none.
std::vector<std::vector<std::size_t>> flexed_muscles(const std::vector<std::string>& controls,
                                                     const std::vector<Muscle>& muscles);

}  // namespace bodyopt::trainer
