// Motion capture in BVH files carried to a skeleton.
#pragma once

#include <filesystem>

#include "trainer/dataset/clip.h"

namespace bodyopt {

// Joints are matched by name, exactly or else without regard to case. The rest pose of the file (all rotations zero)
// may differ from the skeleton's bind pose (arms down in one, stretched out in the other):
//   world rotation of a joint = its world rotation in the BVH * alignment * its world rotation in the bind pose,
// where the alignment lays the joint's bones at bind along the same bones of the BVH at rest, with as little twist as
// it takes, and the BVH is turned to the skeleton's axes first. That turn is the one of the 24 between coordinate axes
// that lays the offsets between matched joints best along the skeleton's own; it settles Z-up, Y-up and the facing. The
// unit makes the offsets between matched joints as long, in total, as the skeleton's, unless the options state it.
// Topmost matched joints take their position from the file, too; joints without a match keep their bind transform.
Clip read_bvh_clip(const std::filesystem::path& path, const Skeleton& skeleton, const ClipOptions& options);

}  // namespace bodyopt
