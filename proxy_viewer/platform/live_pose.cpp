#include "proxy_viewer/platform/live_pose.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr int kMostPackets = 1000;                 // of one poll: a flood of them does not hold up the window
constexpr std::uint32_t kFurthestOvertaken = 100;  // packets; further back the sender has begun anew (as RFC 3550, A.1)

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

[[noreturn]] void refuse_port(std::uint16_t port) {
  const int reason = errno;
  throw Error(ErrorKind::usage, "cannot listen for live poses on 127.0.0.1:" + std::to_string(port) + ": " +
                                    std::strerror(reason) + (reason == EADDRINUSE ? " (by another viewport?)" : "") +
                                    "; give another port, or 0 for one that is free");
}

// An open socket that does not block; -1 with errno where that fails.
int open_socket(const sockaddr_in& address) {
  const int opened = socket(AF_INET, SOCK_DGRAM, 0);
  if (opened < 0) return -1;
  if (fcntl(opened, F_SETFD, FD_CLOEXEC) == 0 && fcntl(opened, F_SETFL, O_NONBLOCK) == 0 &&
      bind(opened, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return opened;
  }
  const int reason = errno;
  close(opened);
  errno = reason;
  return -1;
}

std::uint16_t port_of(int bound) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  getsockname(bound, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace

LivePose::LivePose(std::uint16_t port, std::size_t joint_count, std::size_t control_count) {
  expect(joint_count, control_count);
  socket_ = open_socket(loopback(port));
  if (socket_ < 0) refuse_port(port);
  port_ = port_of(socket_);
}

LivePose::~LivePose() { close(socket_); }

bool LivePose::expect(std::size_t joint_count, std::size_t control_count) {
  const std::size_t size = pose_packet_size(joint_count, control_count);
  if (size > kLargestPacket) {
    throw Error(ErrorKind::usage, "a pose of " + std::to_string(joint_count) + " joints and " +
                                      std::to_string(control_count) + " controls takes " + std::to_string(size) +
                                      " bytes, and a packet holds " + std::to_string(kLargestPacket) +
                                      ": such characters cannot be posed live");
  }
  const bool others = joint_count != joint_count_ || control_count != control_count_;
  joint_count_ = joint_count;
  control_count_ = control_count;
  return others;
}

std::optional<Pose> LivePose::poll() {
  std::array<std::byte, kLargestPacket> buffer;
  std::optional<Pose> newest;
  for (int k = 0; k < kMostPackets; ++k) {
    sockaddr_in from{};
    socklen_t from_size = sizeof(from);
    const ssize_t size =
        recvfrom(socket_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) break;  // nothing more
    const Sender sender = Sender{from.sin_addr.s_addr} << 16 | from.sin_port;
    try {
      PosePacket packet =
          read_pose_packet(std::span(buffer).first(static_cast<std::size_t>(size)), joint_count_, control_count_);
      if (overtaken(sender, packet.number)) {
        reject("a pose packet came after a newer one: its number is " + std::to_string(packet.number) + " after " +
               std::to_string(number_));
        continue;
      }
      sender_ = sender;
      number_ = packet.number;
      frame_ = packet.frame;
      newest = std::move(packet.pose);
    } catch (const Error& error) {
      reject(error.what());
    }
  }
  return newest;
}

// Numbers wrap: 2 is after 2^32 - 1.
bool LivePose::overtaken(Sender sender, std::uint32_t number) const {
  return sender == sender_ && number_ - number <= kFurthestOvertaken;
}

void LivePose::reject(const std::string& reason) {
  ++rejected_;
  last_rejection_ = reason;
}

}  // namespace bodyopt
