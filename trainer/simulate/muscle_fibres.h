// Which tets are muscle, where their fibres run, and how active a muscle is in a pose.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/muscles.h"
#include "trainer/simulate/tissue.h"
#include "trainer/tets/cage.h"

namespace bodyopt {

// Tets whose centroid lies in a muscle's belly: within radius sqrt(sin(pi u)) of its path, u from origin (0) to
// insertion (1). Where muscles overlap, the one whose path is nearest relative to its radius there takes the tet. A
// muscle that no tet falls to (thinner than they are) is a further one of the tet whose centroid is nearest to its
// path's middle, with its volume's share of it: so a muscle never acts on one side of the body alone.
std::vector<FibreTet> label_muscles(const TetMesh& mesh, const std::vector<Muscle>& muscles);

// The same by the cage's samples: a tet goes to the muscle with the largest share of it, whose mean direction it takes;
// a muscle that has none is a further one of the tet whose sample is nearest.
std::vector<FibreTet> label_muscles(const Cage& cage, const std::vector<Muscle>& muscles);

// Length of a muscle's path with its points carried by their joints' skinning matrices, metres.
double path_length(const Muscle& muscle, std::span<const Affine> skinning);

// Activation per muscle, 0 .. max_activation: what a muscle does beyond its tone at rest, which is part of the rest
// shape. A smooth function of how much shorter its path is than at rest, and of nothing else: zero at rest and when
// stretched, full when shortened by a fifth.
std::vector<double> activations(const std::vector<Muscle>& muscles, std::span<const Affine> skinning);

// Whether a pattern means a name: it is the name or, where it ends with '*', how the name begins.
bool matches_pattern(const std::string& pattern, const std::string& name);

// The muscles that each control flexes: the one of its name or, where it ends with '*', all whose names begin like it.
// Throws Error(mismatch) for a control that flexes none.
std::vector<std::vector<std::size_t>> flexed_muscles(const std::vector<std::string>& controls,
                                                     const std::vector<Muscle>& muscles);

}  // namespace bodyopt
