// The frames and the part of the skin that a modifier acts on.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/json_file.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::trainer {

// Whether a list of selections names each frame of the database; an empty list names all. A selection is {"take",
// "frames"}, either of them alone, {"near": {"take", "frame", "degrees", "joints"}}, or {"list"} of the dataset's
// "selections". Without "joints", all that bend skin count. Throws Error(mismatch), naming `place`, at an unknown take,
// joint or list, a list that names itself, and where no frame is left. Throws Error(file) at what is malformed.
std::vector<char> selected_frames(const PoseDatabase& database, const Json& selections, const std::string& place);

// V, of welded vertices, from 0 to 1: the largest of what "joints", "regions" and "muscles" say; all 1 where none is
// named. Joints count by skin weights, regions (painted, of the dataset's file) by theirs. Muscles count 1 within 1.5
// of their radius at rest, 0 from 3 on. Throws Error(mismatch) at an unknown name and where nothing is left.
Eigen::VectorXd skin_mask(const PoseDatabase& database, const Json& mask, const std::string& place);

}  // namespace bodyopt::trainer
