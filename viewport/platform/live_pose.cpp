#include "viewport/platform/live_pose.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt::viewport {
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

[[noreturn]] void reject(const auto&... problem) { throw Error(ErrorKind::mismatch, "a pose packet ", problem...); }

void expect(const char* what, std::size_t found, std::size_t expected, const char* cause) {
  if (found == expected) return;
  reject("has ", what, " ", found, ", expected ", expected, ": ", cause);
}

Header read_header(std::span<const std::byte> bytes, std::size_t joint_count, std::size_t control_count) {
  Header header;
  if (bytes.size() < sizeof(header)) {
    reject("has ", bytes.size(), " bytes, expected a header of ", sizeof(header), ": cut off?");
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
  throw Error(ErrorKind::usage, "cannot listen for live poses on 127.0.0.1:", port, ": ", std::strerror(reason),
              reason == EADDRINUSE ? " (by another viewport?)" : "", "; give another port, or 0 for one that is free");
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
    reject("has the number ", values[k], " for ", of_joint ? "joint " : "control ",
           of_joint ? k / kJointNumbers : k - kJointNumbers * joint_count,
           ", expected numbers up to 1e6: wrong units, or damaged?");
  }
  PosePacket packet{header.number, header.frame, {}};
  for (std::size_t j = 0; j < joint_count; ++j) {
    JointTransform joint = joint_from(values.data() + kJointNumbers * j);
    if (!is_rotation(joint.rotation)) reject("has no rotation (a quaternion of zeros) for joint ", j);
    joint.rotation = normalized(joint.rotation);
    packet.pose.joints.push_back(joint);
  }
  packet.pose.controls.assign(values.begin() + static_cast<std::ptrdiff_t>(kJointNumbers * joint_count), values.end());
  return packet;
}

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
    throw Error(ErrorKind::usage, "a pose of ", joint_count, " joints and ", control_count, " controls takes ", size,
                " bytes, and a packet holds ", kLargestPacket, ": such characters cannot be posed live");
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

}  // namespace bodyopt::viewport
