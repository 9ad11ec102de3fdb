#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "runtime/core/error.h"
#include "tests/viewport/pose_packet_bytes.h"
#include "viewport/platform/live_pose.h"

namespace bodyopt::testing {
namespace pose_packet_test {

using namespace viewport;

constexpr std::uint16_t kJoints = 3, kControls = 2;

PosePacket read(const std::string& bytes) {
  return read_pose_packet(std::as_bytes(std::span(bytes)), kJoints, kControls);
}

void expect_rejected(const std::string& bytes, const std::string& reason) {
  try {
    read(bytes);
    ADD_FAILURE() << "not rejected; expected '" << reason << "'";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST(PosePacket, IsReadAsWritten) {
  PacketFields fields = packet_fields(kJoints, kControls);
  fields.number = 0x80000001;
  fields.frame = -7;
  for (std::size_t k = 0; k < fields.values.size(); ++k) fields.values[k] = static_cast<float>(k) + 0.5f;
  const PosePacket packet = read(packet_bytes(fields));
  EXPECT_EQ(packet.number, 0x80000001u);
  EXPECT_EQ(packet.frame, -7);
  ASSERT_EQ(packet.pose.joints.size(), kJoints);
  EXPECT_EQ(packet.pose.joints[1].translation, (Vec3{10.5, 11.5, 12.5}));
  EXPECT_EQ(packet.pose.joints[1].scale, (Vec3{17.5, 18.5, 19.5}));
  const Quat& rotation = packet.pose.joints[1].rotation;  // 13.5 to 16.5, made a unit quaternion
  EXPECT_NEAR(rotation[3] / rotation[0], 16.5 / 13.5, 1e-12);
  EXPECT_NEAR(
      rotation[0] * rotation[0] + rotation[1] * rotation[1] + rotation[2] * rotation[2] + rotation[3] * rotation[3], 1,
      1e-12);
  EXPECT_EQ(packet.pose.controls, (std::vector{30.5f, 31.5f}));
}

TEST(PosePacket, HasTheSizeThatIsDocumented) {
  EXPECT_EQ(pose_packet_size(kJoints, kControls), 20u + 40 * kJoints + 4 * kControls);
  EXPECT_EQ(packet_bytes(packet_fields(kJoints, kControls)).size(), pose_packet_size(kJoints, kControls));
}

TEST(PosePacket, ControlsMayBeLeftOut) {
  const PosePacket packet = read(packet_bytes(packet_fields(kJoints, 0)));
  EXPECT_TRUE(packet.pose.controls.empty());
  EXPECT_EQ(packet.pose.joints.size(), kJoints);
}

TEST(PosePacket, EveryOtherLengthIsRejected) {
  const std::string bytes = packet_bytes(packet_fields(kJoints, kControls));
  for (std::size_t size = 0; size < bytes.size(); ++size) expect_rejected(bytes.substr(0, size), "bytes");
  expect_rejected(bytes + '\0', "a size in bytes of");
}

TEST(PosePacket, SaysWhatIsWrong) {
  const auto rejected = [](const std::string& reason, const auto& change) {
    PacketFields fields = packet_fields(kJoints, kControls);
    change(fields);
    expect_rejected(packet_bytes(fields), reason);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  rejected("'BPOS'", [](PacketFields& f) { f.magic = "BPOZ"; });
  rejected("the version 2, expected 1", [](PacketFields& f) { f.version = 2; });
  rejected("the flags 4, expected 0", [](PacketFields& f) { f.flags = 4; });
  rejected("joint count of 4, expected 3", [](PacketFields& f) { f = packet_fields(4, kControls); });
  rejected("joint count of 65535", [](PacketFields& f) { f.joint_count = 65535; });
  rejected("control count of 1, expected 2", [](PacketFields& f) { f = packet_fields(kJoints, 1); });
  rejected("nan for joint 0", [&](PacketFields& f) { f.values[0] = nan; });
  rejected("inf for joint 2", [&](PacketFields& f) { f.values[29] = -infinity; });
  rejected("for joint 1", [](PacketFields& f) { f.values[12] = 1.1e6f; });
  rejected("nan for control 1", [&](PacketFields& f) { f.values[31] = nan; });
  rejected("no rotation (a quaternion of zeros) for joint 1", [](PacketFields& f) { f.values[16] = 0; });
}

TEST(PosePacket, NothingElseGetsIn) {
  std::mt19937 random(11);
  int accepted = 0;
  for (int k = 0; k < 20000; ++k) {
    std::string bytes = packet_bytes(packet_fields(kJoints, kControls));
    for (std::size_t n = random() % 6; n > 0; --n) bytes[random() % bytes.size()] = static_cast<char>(random());
    if (random() % 4 == 0) bytes.resize(random() % 200);
    try {
      const PosePacket packet = read(bytes);
      ++accepted;
      ASSERT_EQ(packet.pose.joints.size(), kJoints);
      for (const JointTransform& joint : packet.pose.joints) {
        ASSERT_LE(std::abs(joint.translation[0]) + std::abs(joint.scale[2]), 2e6);
        ASSERT_NEAR(joint.rotation[0] * joint.rotation[0] + joint.rotation[1] * joint.rotation[1] +
                        joint.rotation[2] * joint.rotation[2] + joint.rotation[3] * joint.rotation[3],
                    1, 1e-9);
      }
    } catch (const Error&) {
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_LT(accepted, 19000);
}

}  // namespace pose_packet_test
}  // namespace bodyopt::testing
