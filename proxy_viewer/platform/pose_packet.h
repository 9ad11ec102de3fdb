// The datagram of a live pose (docs/formats.md, Live poses).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

struct PosePacket {
  std::uint32_t number = 0;  // counts the sender's packets
  std::int32_t frame = 0;
  Pose pose;  // of finite numbers and unit quaternions
};

constexpr std::size_t kLargestPacket = 65507;  // bytes that UDP carries

// Bytes of a packet.
std::size_t pose_packet_size(std::size_t joint_count, std::size_t control_count);

// Reads a packet for a skeleton of `joint_count` joints and a basis of `control_count` controls. A packet without
// controls leaves Pose::controls empty. Throws Error(mismatch) for any other packet.
PosePacket read_pose_packet(std::span<const std::byte> bytes, std::size_t joint_count, std::size_t control_count);

}  // namespace bodyopt
