// Pictures on disk: one, one of every frame, one from all around. What was written before an interruption is kept.
#pragma once

#include <functional>
#include <string>

#include "proxy_viewer/controls.h"
#include "proxy_viewer/render/renderer.h"

namespace bodyopt {

using DrawPicture = std::function<Image()>;  // of what the controls say

// These say in a message what was written, and throw Error(file), Error(usage) for a pattern that is none, and
// Error(interrupted).

// `file`, or, where it is empty, the first bodyopt.0001.png, ... that is free.
void write_screenshot(const std::string& file, const DrawPicture& draw, Controls& controls);

// The range in pictures (`pattern` with #### or %04d), or in one that moves (.webp; `fps` of the clip); otherwise the
// frame that is shown.
void write_sequence(const std::string& pattern, double fps, const DrawPicture& draw, Controls& controls);

// Once around the target.
void write_turntable(const std::string& pattern, const DrawPicture& draw, Controls& controls);

}  // namespace bodyopt
