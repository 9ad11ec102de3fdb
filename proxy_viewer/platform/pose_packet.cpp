#include "proxy_viewer/platform/pose_packet.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

static_assert(std::endian::native == std::endian::little,
              "packets are little-endian, and values are copied as they are");

constexpr char kMagic[4] = {'B', 'P', 'O', 'S'};
constexpr std::uint16_t kVersion = 1;
constexpr std::size_t kJointNumbers = 3 + 4 + 3;
constexpr float kLargest = 1e6f;            // metres, and of what has no unit
constexpr double kShortestRotation = 1e-3;  // of a quaternion, which should be 1

struct Header {
  char magic[4];
  std::uint16_t version, flags;
  std::uint32_t number;
  std::int32_t frame;
  std::uint16_t joint_count, control_count;
};
static_assert(sizeof(Header) == 20);

[[noreturn]] void reject(const std::string& problem) { throw Error(ErrorKind::mismatch, "a pose packet " + problem); }

void expect(const char* what, std::size_t found, std::size_t expected, const char* cause) {
  if (found == expected) return;
  reject(std::string("has ") + what + " " + std::to_string(found) + ", expected " + std::to_string(expected) + ": " +
         cause);
}

Header read_header(std::span<const std::byte> bytes, std::size_t joint_count, std::size_t control_count) {
  Header header;
  if (bytes.size() < sizeof(header)) {
    reject("has " + std::to_string(bytes.size()) + " bytes, expected a header of " + std::to_string(sizeof(header)) +
           ": cut off?");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) {
    reject("does not begin with 'BPOS': sent by another program?");
  }
  expect("the version", header.version, kVersion, "sent by a newer program?");
  expect("the flags", header.flags, 0, "sent by a newer program?");
  expect("a joint count of", header.joint_count, joint_count, "a pose of another skeleton?");
  if (header.control_count != 0) {
    expect("a control count of", header.control_count, control_count, "for another basis?");
  }
  return header;
}

JointTransform joint_from(const float* values) {
  JointTransform joint;
  std::copy(values, values + 3, joint.translation.begin());
  std::copy(values + 3, values + 7, joint.rotation.begin());
  std::copy(values + 7, values + 10, joint.scale.begin());
  return joint;
}

bool is_rotation(const Quat& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) >= kShortestRotation;
}

}  // namespace

std::size_t pose_packet_size(std::size_t joint_count, std::size_t control_count) {
  return sizeof(Header) + sizeof(float) * (kJointNumbers * joint_count + control_count);
}

PosePacket read_pose_packet(std::span<const std::byte> bytes, std::size_t joint_count, std::size_t control_count) {
  const Header header = read_header(bytes, joint_count, control_count);
  expect("a size in bytes of", bytes.size(), pose_packet_size(header.joint_count, header.control_count), "cut off?");
  std::vector<float> values((bytes.size() - sizeof(header)) / sizeof(float));
  if (!values.empty()) std::memcpy(values.data(), bytes.data() + sizeof(header), values.size() * sizeof(float));
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::abs(values[k]) <= kLargest) continue;
    const bool of_joint = k < kJointNumbers * joint_count;
    reject("has the number " + std::to_string(values[k]) + " for " +
           (of_joint ? "joint " + std::to_string(k / kJointNumbers)
                     : "control " + std::to_string(k - kJointNumbers * joint_count)) +
           ", expected numbers up to 1e6: wrong units, or damaged?");
  }
  PosePacket packet{header.number, header.frame, {}};
  for (std::size_t j = 0; j < joint_count; ++j) {
    JointTransform joint = joint_from(values.data() + kJointNumbers * j);
    if (!is_rotation(joint.rotation)) reject("has no rotation (a quaternion of zeros) for joint " + std::to_string(j));
    joint.rotation = normalized(joint.rotation);
    packet.pose.joints.push_back(joint);
  }
  packet.pose.controls.assign(values.begin() + static_cast<std::ptrdiff_t>(kJointNumbers * joint_count), values.end());
  return packet;
}

}  // namespace bodyopt
