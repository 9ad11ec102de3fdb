// Files of what an animator made, beside the session: clips and skins for other programs, poses, markers.
#pragma once

#include <string>

#include "viewport/commands/controls.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Throws Error(usage) for a file that the cast is read from. All that write throw it, and Error(file).
void refuse_input(const Scene& scene, const std::string& file);

// Exports the range as it is posed and keyed, before modifiers: .glb, .bvh or .usda; controls go to FILE.controls.json.
void export_clip(const Scene& scene, Controls& controls, const std::string& file);
// Exports the skin of the range, with attached meshes: .pc2, .mdd, .usda or .glb.
void export_skin(const Scene& scene, Controls& controls, const std::string& file);

// Saves the pose in hand as a state. Loads one, or a session's.
void save_pose(const Scene& scene, Controls& controls, const std::string& file);
void load_pose(const PoseRequest& request, Controls& controls);

// Markers are pairs of vertices of the two characters that stand first in the cast.
void save_markers(const Scene& scene, Controls& controls, const std::string& file);
void load_markers(const std::string& file, Controls& controls);

}  // namespace bodyopt::viewport
