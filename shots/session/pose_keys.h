// What is set on top of the clip, between the frames that have keys.
#pragma once

#include <map>

#include "shots/session/view_settings.h"

namespace bodyopt {

// Slow at each key, fast between them; before the first and after the last as those. Joints and axes that a key leaves
// out are there as the clip has them, controls and pins as the other key has them. There must be a key.
ViewSettings::PoseKey between_keys(const std::map<int, ViewSettings::PoseKey>& keys, int frame);

// The posing as it is at a frame: by its keys, or, without any, as it is.
ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame);

}  // namespace bodyopt
