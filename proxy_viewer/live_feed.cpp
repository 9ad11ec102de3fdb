#include "proxy_viewer/live_feed.h"

#include <iostream>
#include <string>
#include <utility>

namespace bodyopt {

void LiveFeed::listen(std::uint16_t port) {
  const Basis& basis = session_.scene.lead().basis();
  live_ = std::make_unique<LivePose>(port, basis.skeleton.size(), basis.residual.controls.size());
  session_.controls.live = true;
  const std::string listening = "listening for poses on 127.0.0.1:" + std::to_string(live_->port());
  std::cerr << listening << "\n";
  session_.controls.say(listening);
}

void LiveFeed::follow_lead() {
  if (!live_) return;
  const Basis& basis = session_.scene.lead().basis();
  try {
    if (live_->expect(basis.skeleton.size(), basis.residual.controls.size())) session_.scene.leave_live_pose();
  } catch (...) {  // nor are those that were listened for
    live_.reset();
    session_.controls.live.reset();
    session_.snapshot.live.reset();
    session_.scene.leave_live_pose();
    throw;
  }
}

bool LiveFeed::poll() {
  if (!live_) return false;
  if (!*session_.controls.live) {
    session_.scene.leave_live_pose();
    session_.snapshot.live.reset();
    return false;
  }
  const std::size_t rejected = live_->rejected();
  std::optional<Pose> pose = live_->poll();
  const bool is_new = pose || live_->rejected() > rejected;
  if (pose) session_.scene.set_live_pose(std::move(*pose));
  session_.snapshot.live = LiveRow{live_->frame(), live_->rejected(), live_->last_rejection()};
  return is_new;
}

}  // namespace bodyopt
