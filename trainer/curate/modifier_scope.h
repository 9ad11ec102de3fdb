// Where a modifier acts: which frames, and which part of the skin.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "assets/json_file.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt {

// Of every frame of the database, whether a list of selections names it; an empty list names all. A selection is
// {"take", "frames"}, either of them alone, {"near": {"take", "frame", "degrees", "joints"}} (joints: all that bend
// skin, where not named), or {"list"} of the dataset's "selections". Throws Error(mismatch), naming `place`, at an
// unknown take, joint or list, one that names itself, and where no frame is left; Error(file) at what is malformed.
std::vector<char> selected_frames(const PoseDatabase& database, const Json& selections, const std::string& place);

// V, of welded vertices, from 0 to 1: the largest of what "joints" (their skin weights), "regions" (painted ones, of
// the dataset's file) and "muscles" (1 within 1.5 of their radius at rest, 0 from 3 on) say; 1 everywhere where none of
// these is named. Throws Error(mismatch) at an unknown name and where nothing is left.
Eigen::VectorXd skin_mask(const PoseDatabase& database, const Json& mask, const std::string& place);

}  // namespace bodyopt
