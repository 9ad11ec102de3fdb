// Poses that another program sends, in place of the lead's clip for as long as they are wanted.
#pragma once

#include <cstdint>
#include <memory>

#include "proxy_viewer/platform/live_pose.h"
#include "proxy_viewer/session.h"

namespace bodyopt {

class LiveFeed {
 public:
  // It must outlive this.
  explicit LiveFeed(Session& session) : session_(session) {}

  // Says on which port. Throws as LivePose.
  void listen(std::uint16_t port);
  bool listens() const { return live_ != nullptr; }
  // The lead may be another: a pose of other joints is none of it. Where its poses do not fit a packet, it listens no
  // longer, and throws as LivePose.
  void follow_lead();
  // The newest of the poses that came. Whether there is something new to see.
  bool poll();

 private:
  Session& session_;
  std::unique_ptr<LivePose> live_;
};

}  // namespace bodyopt
