// Poses as they are copied, pasted and flipped: all of what an animator set, or what of it some joints have.
#pragma once

#include <string>
#include <vector>

#include "viewport/commands/controls.h"

namespace bodyopt::viewport {

// Axes of the joint limits that turn the joint first.
std::vector<std::string> axes_turning(const Controls& controls, const std::string& joint);

// Returns these joints' part of a pose: turns, moves, pins.
shots::ViewSettings::PoseKey part_of(const Controls& controls, const shots::ViewSettings::PoseKey& pose,
                                     const std::vector<std::string>& joints);

// Replaces these joints' part of `into`; none: all of it.
void put_pose(const Controls& controls, const shots::ViewSettings::PoseKey& pose,
              const std::vector<std::string>& joints, shots::ViewSettings::PoseKey& into);

// Blends a share of a file's pose over the pose that was in hand, for the selected joints.
void blend_in(Controls& controls, const shots::ViewSettings::PoseKey& pose, double share,
              const shots::ViewSettings::PoseKey& before);
// Throws Error(mismatch) where no joint that the file's pose turns is the lead's.
void require_own_pose(const Controls& controls, const shots::ViewSettings::PoseKey& pose, const std::string& file);

// The mirror image at the plane across x in which the lead's root stands in the frame. Joints, axes and controls of a
// side become those of the other, by their names.
shots::ViewSettings::PoseKey flipped(const Controls& controls, const shots::ViewSettings::PoseKey& pose, int frame);

// Returns the joints of the other side; one in the middle is its own.
std::vector<std::string> flipped(const Controls& controls, const std::vector<std::string>& joints);

}  // namespace bodyopt::viewport
