// What training has to say of its data, one sentence each, for the user.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trainer/train/data/contradictions.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/data/stray_vertices.h"

namespace bodyopt {

// Of all regions; a pair of frames may be among them several times.
std::vector<std::string> contradiction_warnings(const SampleSet& set, std::vector<Contradiction> contradictions);

// Vertices are named as the character's file numbers them. `order`: welded vertex of each runtime vertex.
std::vector<std::string> stray_warnings(const SampleSet& set, const std::vector<std::uint32_t>& order,
                                        std::vector<StrayVertex> strays);

std::vector<std::string> constant_control_warnings(const SampleSet& set);

// `features`: how many vary.
std::vector<std::string> few_frames_warnings(const SampleSet& set, std::size_t features);

}  // namespace bodyopt
