// Describes a scene to panels.
#pragma once

#include "proxy_viewer/compare/error_measuring.h"
#include "proxy_viewer/panels/snapshot.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

// Names what the lead and the cast lack, and how to get it; see Controls::missing.
std::map<std::string, std::string> describe_missing(const Scene& scene);

// Describes what stays until files are read: the cast, and the lead's joints, controls, fibres and clip.
void describe_cast(const Scene& scene, Snapshot& snapshot);

// How far the lead's joints may be turned in a frame.
void describe_turns(const Scene& scene, const Controls& controls, Snapshot& snapshot);

// Describes what is shown and compared now, and how far apart it is.
void describe_comparison(const Scene& scene, const Controls& controls, const ErrorCurve& curve, Snapshot& snapshot);

}  // namespace bodyopt
