// Poses from another program on this machine, as it makes them: over UDP, on the loopback interface alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "proxy_viewer/platform/pose_packet.h"

namespace bodyopt {

class LivePose {
 public:
  // Listens on 127.0.0.1:`port`; 0: one that is free. Throws Error(usage) when the port is in use or not allowed, or a
  // pose of so many joints does not fit a packet.
  LivePose(std::uint16_t port, std::size_t joint_count, std::size_t control_count);
  ~LivePose();
  LivePose(const LivePose&) = delete;
  LivePose& operator=(const LivePose&) = delete;

  // From now on poses of so many, whatever those before had; false: as they had. Throws as the constructor.
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

}  // namespace bodyopt
