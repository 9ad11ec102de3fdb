// Poses from another program on this machine, as it makes them: over UDP, on the loopback interface alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "runtime/basis/skeleton.h"

namespace bodyopt::viewport {

// The datagram of a live pose (docs/formats.md, Live poses).
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

class LivePose {
 public:
  // Listens on 127.0.0.1:`port`; 0: one that is free. Throws Error(usage) when the port is in use or not allowed, or a
  // pose of so many joints does not fit a packet.
  LivePose(std::uint16_t port, std::size_t joint_count, std::size_t control_count);
  ~LivePose();
  LivePose(const LivePose&) = delete;
  LivePose& operator=(const LivePose&) = delete;

  // Expects poses of so many from now on; false: so it did already. Throws as the constructor.
  bool expect(std::size_t joint_count, std::size_t control_count);

  std::uint16_t port() const { return port_; }

  // The newest pose that has come since the last call, if any; does not wait. Packets that are not what they should be
  // are rejected, and those of the same sender that overtook each other.
  std::optional<Pose> poll();

  std::optional<int> frame() const { return frame_; }  // of the pose given last; none: there was none
  std::size_t rejected() const { return rejected_; }
  const std::string& last_rejection() const { return last_rejection_; }  // why, in words

 private:
  using Sender = std::uint64_t;  // address and port

  bool overtaken(Sender sender, std::uint32_t number) const;
  void reject(const std::string& reason);

  int socket_ = -1;
  std::uint16_t port_ = 0;
  std::size_t joint_count_ = 0, control_count_ = 0;
  std::optional<Sender> sender_;  // of the newest packet
  std::uint32_t number_ = 0;      // its number
  std::optional<int> frame_;
  std::size_t rejected_ = 0;
  std::string last_rejection_;
};

}  // namespace bodyopt::viewport
