// A synthetic limb: a capsule on three joints with two muscles, and a made-up truth to learn.
#pragma once

#include "trainer/train/data/samples.h"

namespace bodyopt {

constexpr int kLimbSides = 16, kLimbRings = 36;
constexpr double kLimbLength = 0.6, kLimbRadius = 0.05;

Skeleton limb_skeleton();

// Of a vertex of the rest skin at this height, the largest first.
std::vector<JointWeight> limb_weights(double z);

// Closed: rings between two poles. One output vertex per welded vertex.
Character limb_character();

std::vector<Muscle> limb_muscles();

Pose limb_pose(const Skeleton& skeleton, double flex, double twist, double wrist);

// Skinning of a skin that bulges along the muscles as they shorten, and slides a little with the wrist.
Positions limb_truth(const Character& character, const std::vector<Muscle>& muscles, const Pose& pose);

// A smooth motion that sweeps all three degrees of freedom at unrelated rates.
trainer::SampleSet limb_samples(int train_frames, int heldout_frames);

}  // namespace bodyopt
