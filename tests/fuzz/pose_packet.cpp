#include "tests/fuzz/fuzz_target.h"
#include "tests/viewport/pose_packet_bytes.h"
#include "viewport/platform/live_pose.h"

namespace bodyopt::fuzz {
namespace {

using namespace viewport;

constexpr std::uint16_t kJoints = 3, kControls = 2;

std::vector<std::string> seeds() {
  return {testing::packet_bytes(testing::packet_fields(kJoints, kControls)),
          testing::packet_bytes(testing::packet_fields(kJoints, 0))};
}

void read(const std::string& bytes) {
  const PosePacket packet = read_pose_packet(std::as_bytes(std::span(bytes)), kJoints, kControls);
  for (const JointTransform& joint : packet.pose.joints) {
    require_finite(joint.translation, "translations");
    require_finite(joint.rotation, "rotations");
    require_finite(joint.scale, "scales");
  }
  require_finite(packet.pose.controls, "controls");
}

const bool added = add_target({"pose_packet", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
