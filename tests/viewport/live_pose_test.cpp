#include "viewport/platform/live_pose.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <numbers>
#include <random>

#include "runtime/basis/basis.h"
#include "runtime/core/error.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewport/pose_packet_bytes.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

constexpr std::uint16_t kJoints = 3, kControls = 2;

// Another program that sends poses, from a port of its own.
class Sender {
 public:
  explicit Sender(std::uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address_.sin_port = htons(port);
  }
  ~Sender() { close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void send(const std::string& bytes) const {
    const ssize_t sent =
        sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address_), sizeof(address_));
    ASSERT_EQ(sent, std::ssize(bytes));
  }
  // A pose that is known by its frame, too.
  void send_pose(std::uint32_t number, int frame) const {
    PacketFields fields = packet_fields(kJoints, kControls);
    fields.number = number;
    fields.frame = frame;
    fields.values[0] = static_cast<float>(frame);
    send(packet_bytes(fields));
  }

 private:
  int socket_;
  sockaddr_in address_{};
};

class LivePoseTest : public ::testing::Test {
 protected:
  // The frame of the newest pose that has come; -1: none has.
  int newest() {
    const std::optional<Pose> pose = live_.poll();
    if (!pose) return -1;
    EXPECT_EQ(pose->joints.size(), kJoints);
    EXPECT_EQ(pose->joints[0].translation[0], live_.frame());
    return live_.frame().value();
  }

  LivePose live_{0, kJoints, kControls};
  Sender sender_{live_.port()};
};

TEST_F(LivePoseTest, GivesTheNewestPoseOnce) {
  EXPECT_NE(live_.port(), 0);
  EXPECT_EQ(newest(), -1);
  sender_.send_pose(0, 5);
  EXPECT_EQ(newest(), 5);
  EXPECT_EQ(newest(), -1);
  for (std::uint32_t k = 1; k <= 10; ++k) sender_.send_pose(k, 20 - static_cast<int>(k));  // scrubbed backwards
  EXPECT_EQ(newest(), 10);
  EXPECT_EQ(live_.rejected(), 0u);
}

TEST_F(LivePoseTest, PacketsThatWereOvertakenAreDropped) {
  sender_.send_pose(50, 1);
  sender_.send_pose(49, 2);
  sender_.send_pose(50, 3);
  EXPECT_EQ(newest(), 1);
  EXPECT_EQ(live_.rejected(), 2u);
  EXPECT_NE(live_.last_rejection().find("50 after 50"), std::string::npos) << live_.last_rejection();
  sender_.send_pose(48, 4);
  EXPECT_EQ(newest(), -1);
  sender_.send_pose(51, 6);
  EXPECT_EQ(newest(), 6);
}

TEST_F(LivePoseTest, TakesPosesOfTheJointsThatAreExpectedNow) {
  EXPECT_FALSE(live_.expect(kJoints, kControls));
  EXPECT_TRUE(live_.expect(kJoints + 1, kControls));
  sender_.send_pose(0, 1);
  EXPECT_EQ(newest(), -1);
  EXPECT_EQ(live_.rejected(), 1u);
  EXPECT_THROW(live_.expect(100'000, 0), Error);
  EXPECT_TRUE(live_.expect(kJoints, kControls));
  sender_.send_pose(1, 2);
  EXPECT_EQ(newest(), 2);
}

TEST_F(LivePoseTest, NumbersWrap) {
  sender_.send_pose(0xffffffff, 1);
  EXPECT_EQ(newest(), 1);
  sender_.send_pose(2, 2);
  EXPECT_EQ(newest(), 2);
  sender_.send_pose(0xfffffffe, 3);
  EXPECT_EQ(newest(), -1);
}

TEST_F(LivePoseTest, ASenderMayBeginAnew) {
  sender_.send_pose(5000, 1);
  EXPECT_EQ(newest(), 1);
  sender_.send_pose(0, 2);
  EXPECT_EQ(newest(), 2);
  Sender other(live_.port());  // and another need not know the first one's numbers
  sender_.send_pose(50, 3);
  other.send_pose(49, 4);
  EXPECT_EQ(newest(), 4);
}

TEST_F(LivePoseTest, BadPacketsAreCountedAndDoNotDisturb) {
  sender_.send_pose(1, 7);
  sender_.send("");
  sender_.send("hello");
  sender_.send(packet_bytes(packet_fields(kJoints + 1, kControls)));
  EXPECT_EQ(newest(), 7);
  EXPECT_EQ(live_.rejected(), 3u);
  EXPECT_NE(live_.last_rejection().find("joint count of 4, expected 3"), std::string::npos) << live_.last_rejection();
}

TEST_F(LivePoseTest, SurvivesTenThousandHostilePackets) {
  std::mt19937 random(2024);
  std::size_t poses = 0;
  for (int k = 0; k < 10000; ++k) {
    PacketFields fields = packet_fields(kJoints, kControls);
    fields.number = static_cast<std::uint32_t>(k);
    std::string bytes = packet_bytes(fields);
    const unsigned kind = random() % 3;
    if (kind == 0) bytes.resize(random() % bytes.size());
    if (kind == 1) bytes.assign(random() % 4000, static_cast<char>(random()));
    if (kind == 2) bytes[random() % 20] ^= static_cast<char>(1 + random() % 255);  // somewhere in its header
    sender_.send(bytes);
    poses += live_.poll().has_value() ? 1 : 0;
  }
  EXPECT_EQ(poses + live_.rejected(), 10000u);
  EXPECT_GT(live_.rejected(), 8000u);
  EXPECT_GT(poses, 500u);  // a changed number or frame is a pose all the same
  sender_.send_pose(1u << 31, 9);
  EXPECT_EQ(newest(), 9);
}

TEST(LivePose, ListensOnTheLoopbackInterfaceAlone) {
  const LivePose live(0, kJoints, kControls);
  // Whoever listens on all interfaces has the port everywhere; here another may have it on 127.0.0.2.
  const int other = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1);
  address.sin_port = htons(live.port());
  EXPECT_EQ(bind(other, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  close(other);
}

TEST(LivePose, APortInUseIsSaid) {
  const LivePose first(0, kJoints, kControls);
  try {
    LivePose second(first.port(), kJoints, kControls);
    ADD_FAILURE() << "two listen on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("in use"), std::string::npos) << error.what();
  }
}

TEST(LivePose, PortsAreGivenBack) {
  std::uint16_t port = 0;
  {
    const LivePose live(0, kJoints, kControls);
    port = live.port();
  }
  EXPECT_EQ(LivePose(port, kJoints, kControls).port(), port);
}

TEST(LivePose, CharactersTooLargeForAPacketAreRefused) {
  EXPECT_NO_THROW(LivePose(0, 1637, 1));
  EXPECT_THROW(LivePose(0, 1638, 0), Error);
}

class SendPoseScript : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run_program("python3 --version").exit_code != 0) GTEST_SKIP() << "there is no python3 here";
    save_basis(basis_, folder_ / "small.safetensors");
  }

  ProgramResult run(const std::string& arguments) const {
    return run_program("python3 '" + kSourceFolder + "/examples/send_pose.py' '" +
                       (folder_ / "small.safetensors").string() + "' " + arguments);
  }

  Basis basis_ = small_basis();
  TemporaryFolder folder_;
};

TEST_F(SendPoseScript, SwingsTheJointItIsGiven) {
  LivePose live(0, basis_.skeleton.size(), basis_.residual.controls.size());
  const Joint& joint = basis_.skeleton.joints.back();
  const ProgramResult result =
      run("--joint '" + joint.name + "' --axis x --degrees 40 --frames 7 --port " + std::to_string(live.port()));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const std::optional<Pose> pose = live.poll();
  ASSERT_TRUE(pose) << live.last_rejection();
  EXPECT_EQ(live.rejected(), 0u);
  EXPECT_EQ(live.frame(), 6);  // an eighth of a swing
  const double angle = 40 * std::numbers::pi / 180 * std::sin(std::numbers::pi / 4);
  const Quat expected = joint.bind.rotation * axis_angle({1, 0, 0}, angle);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(pose->joints.back().rotation[i], expected[i], 1e-6);
  EXPECT_NEAR(length(pose->joints.back().translation - joint.bind.translation), 0, 1e-6);
  EXPECT_NEAR(pose->joints.front().rotation[3], basis_.skeleton.joints.front().bind.rotation[3], 1e-6);
}

TEST_F(SendPoseScript, NamesTheJointsWhenItIsGivenAnother) {
  const ProgramResult result = run("--joint tail --port 9");
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.output.find(basis_.skeleton.joints.front().name), std::string::npos) << result.output;
}

}  // namespace
}  // namespace bodyopt::testing
