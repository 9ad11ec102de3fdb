#include "assets/clips/source_motion.h"

namespace bodyopt {

SourceFrame source_frame(const SourceMotion& motion, const std::vector<JointTransform>& locals) {
  SourceFrame frame;
  for (std::size_t b = 0; b < locals.size(); ++b) {
    const int parent = motion.joints[b].joint.parent;
    const Affine own = affine_from(locals[b]);
    if (parent < 0) {
      frame.rotation.push_back(locals[b].rotation);
      frame.transform.push_back(own);
    } else {
      const auto above = static_cast<std::size_t>(parent);
      frame.rotation.push_back(normalized(frame.rotation[above] * locals[b].rotation));
      frame.transform.push_back(frame.transform[above] * own);
    }
  }
  return frame;
}

std::vector<SourceFrame> sampled_frames(const SourceMotion& motion, std::size_t frames, double fps) {
  constexpr std::size_t kMost = 500;
  const std::size_t step = 1 + (frames - 1) / kMost;
  std::vector<SourceFrame> sampled;
  for (std::size_t k = 0; k < frames; k += step) {
    sampled.push_back(source_frame(motion, motion.locals_at(static_cast<double>(k) / fps)));
  }
  return sampled;
}

}  // namespace bodyopt
