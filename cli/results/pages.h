// The state of a show on a farm, as a page for people.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "draw/renderer.h"
#include "farm/task_run.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::cli {

// Self-contained HTML. The frames worth a look are drawn from the caches, on a Vulkan device. Where there is none, or a
// cache is gone, the page says so.
std::string show_page(const farm::FarmPlan& plan, const farm::ShowSummary& summary);

// The page's facts for programs, without pictures.
Json to_json(const farm::FarmPlan& plan, const farm::ShowSummary& summary);

// The options of `simulate` that name these frames, quoted for a shell.
std::string simulate_options(const farm::FramesToSimulate& next);

// How a transfer went, as a page for people.

// Source and target in one pose, and what each skin encloses there, over what it does at rest.
struct ComparedPose {
  int frame = 0;
  std::vector<float> source, target;  // O x 3, output vertex order, metres; empty where it is not drawn
  double source_volume = 1, target_volume = 1;
  double expected_rms_mm = 0;  // of the target; 0: not known
};

// The frames of a clip of the source, and of the target posed as transferred_pose() says. Throws as Deformer::evaluate.
std::vector<ComparedPose> compare_poses(const trainer::TransferPair& pair, const Basis& carried, const Clip& clip,
                                        const std::vector<int>& frames);

// The match and, if there are any, the poses, as the page takes them. `carried`: of which the poses are. Throws
// Error(device) where nothing can be drawn.
Json transfer_pictures(const trainer::TransferPair& pair, const MeshTable& carried,
                       const std::vector<ComparedPose>& poses);

// Facts of one target: of the match (`alike`: likeness() of the pair), and of the parts and poses.
Json to_json(const trainer::TransferPair& pair, double alike);
Json to_json(const std::vector<trainer::TransferPart>& parts, const std::vector<ComparedPose>& poses);

// A picture of which point is which. The source is coloured by place, each point of the target in the colour of its
// match. The target again is clay where the match is sure, and hot where it is not. Both are in the common pose, each
// as large as the other. Throws Error(device).
draw::Image transfer_picture(const trainer::TransferPair& pair);

}  // namespace bodyopt::cli
