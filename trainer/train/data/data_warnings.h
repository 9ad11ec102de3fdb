// Warnings of training about its data, one sentence each, for the user.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/region_weights.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {

// Training frames of one pose whose shapes differ: where the data says two things, training can only learn their mean.

// Indices of training frames, the first below the second.
struct FramePair {
  std::size_t first = 0, second = 0;
};

// Frames whose features (N x F, standardised) are the same to about 1e-4 of their range, each with the first of them.
std::vector<FramePair> frames_of_one_pose(const Eigen::MatrixXd& features);

struct Contradiction {
  FramePair frames;
  double distance = 0;  // metres, root mean square over the region
  std::string region;
};

// Returns pairs whose shapes differ in the region by more than their pose explains. That is 1/900 of the character's
// `size` (2 mm of 1.8 m) or, if more, 5 % of `motion`. `motion`: metres, RMS over the region's vertices and all frames.
// `displacements`: of the frames that the pairs name, those of the region's vertices numbered as its own are.
std::vector<Contradiction> contradictions(const std::vector<FramePair>& pairs, const Displacements& displacements,
                                          const RegionWeights& region, double size, double motion);

// `contradictions`: of all regions; a pair of frames may be among them several times.
std::vector<std::string> contradiction_warnings(const SampleSet& set, std::vector<Contradiction> contradictions);

// Vertices are named as the character's file numbers them. `order`: welded vertex of each runtime vertex.
std::vector<std::string> outlier_warnings(const SampleSet& set, const std::vector<std::uint32_t>& order,
                                          std::vector<OutlierVertex> outliers);

std::vector<std::string> constant_control_warnings(const SampleSet& set);

// `features`: how many vary.
std::vector<std::string> few_frames_warnings(const SampleSet& set, std::size_t features);

}  // namespace bodyopt::trainer
