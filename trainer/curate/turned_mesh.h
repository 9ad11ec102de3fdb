// Meshes that come back with another axis up.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>

#include "trainer/curate/frame_files.h"

namespace bodyopt {

// The rotation between coordinate axes that brings a mesh (`given`: N x 3, metres, in any order) to where one of the
// skins lies that it may be of: none where its extent is theirs as it is, or is theirs in no turn. Half of its vertices
// or more then lie where that skin has them; where fewer do, but its extent is that of the skin turned, throws
// Error(mismatch): which way is up is not to be told.
Eigen::Matrix3d turn_back(std::span<const WrittenSkin> written, const Positions& given,
                          const std::filesystem::path& path);

}  // namespace bodyopt
