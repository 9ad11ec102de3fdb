// Disagreements between a dataset's shapes of like poses.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "trainer/curate/local_models.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {

struct DisagreeingPair {
  std::size_t first = 0, second = 0;  // frames of the database
  std::string region;
  double apart_mm = 0;      // RMS over the region, of what their local models do not explain
  double pose_degrees = 0;  // how far their poses are apart there
  // The largest such difference of one vertex, times its weight in the region: what in_one_pose() shows.
  double most_mm = 0;
  Eigen::RowVectorXf difference{};  // 3 per vertex of the region, metres, un-posed: the second less the first
};

// How well the poses of a part of the skin are covered, and how well its shapes agree.
struct RegionAgreement {
  std::string region;
  double neighbours = 0;  // frames near a frame, the median
  double single = 0;      // the share of frames that no other motion passes by: nothing to compare them with
  // The share of the other frames that have one of another motion in the same pose. Where none has, nothing tells
  // whether shapes disagree, or are others in other poses.
  double same_pose = 0;
  double deviation_mm = 0;  // RMS over its skin and the other frames, from their local models
};

struct ConsistencyReport {
  std::vector<DisagreeingPair> pairs;  // the worst first; of those a few frames apart one, in its worst region
  std::vector<RegionAgreement> regions;
  std::vector<double> frame_mm;  // of every frame: deviation, RMS over the skin
};

// `degrees`: how far frames are near; at most `most` pairs. Shows progress. Throws Error(mismatch) of a dataset without
// frames.
ConsistencyReport report_consistency(const ShapeStack& stack, double degrees, std::size_t most);

// V x 3 each, metres. `first` is the first frame's shape. `second` is what it would be in the pair's region with what
// poses do not explain of the second frame.
struct PairInOnePose {
  Positions first, second;
};
PairInOnePose in_one_pose(const ShapeStack& stack, const DisagreeingPair& pair);

// N x 3 part vertices, of every frame, un-posed, metres: what its pass alone has there. `displacements`: N x 3V. Zero
// where nothing else passes by.
Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models);

// The displacements of every frame, N x 3V. Shows progress under a title.
Displacements all_displacements(const PoseDatabase& database, const std::string& title,
                                const std::function<Positions(std::size_t frame)>& offsets);

}  // namespace bodyopt::trainer
