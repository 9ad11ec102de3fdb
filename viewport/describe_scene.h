// Describes a scene to panels.
#pragma once

#include "viewport/compare/error_measuring.h"
#include "viewport/panels/snapshot.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

// Describes what stays until files are read: the cast, and the lead's joints, controls, fibres and clip.
void describe_cast(const Scene& scene, Snapshot& snapshot);

// What commands may name of the lead and of the cast, and why there is nothing to show of what they lack.
void name_for_commands(const Scene& scene, Controls& controls);

// How far the lead's joints may be turned in a frame.
void describe_turns(const Scene& scene, const Controls& controls, Snapshot& snapshot);

// Describes what is shown and compared now, and how far apart it is.
void describe_comparison(const Scene& scene, const Controls& controls, const ErrorCurve& curve, Snapshot& snapshot);

// Describes what is known only once a picture is evaluated.
void describe_picture(const Scene& scene, Snapshot& snapshot);

}  // namespace bodyopt::viewport
