// The mapping of small_osim() to the limb: the model's hangs down, this one lies along x.
#pragma once

namespace bodyopt::attack {

inline const char* const kLimbMapping = R"({
  "schema": "bodyopt-muscle-mapping-1",
  "model_up": "+y", "model_forward": "+x", "character_up": "-x", "character_forward": "+y", "leave_out": [],
  "segments": [
    {"segments": ["upper"], "joint": "upper", "centres": [["upper", "upper"], ["fore", "lower"]]},
    {"segments": ["fore"], "joint": "lower", "centres": [["upper", "upper"], ["fore", "lower"]]}
  ]
})";

}  // namespace bodyopt::attack
