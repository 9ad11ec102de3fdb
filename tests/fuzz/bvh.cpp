#include "tests/fuzz/clip.h"
#include "tests/fuzz/small_limb.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {
      "HIERARCHY\nROOT upper\n{\n  OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n  JOINT lower\n  {\n    OFFSET 10 0 0\n    CHANNELS 3 Yrotation Zrotation Xrotation\n"
      "    End Site\n    {\n      OFFSET 0 1 0\n    }\n  }\n}\nMOTION\nFrames: 2\nFrame Time: 0.05\n"
      "1 2 3 0 0 0 0 0 0\n3 2 +3e0 90 0 0 10 20 30\n"};
}

void read(const std::string& bytes) {
  require_finite_poses(read_clip(as_file("clip.bvh", bytes).string(), limb().skeleton, {}));
}

const bool added = add_target({"bvh", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
