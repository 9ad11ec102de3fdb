// The viewport's playhead: which frame is shown when.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "shots/session/view_settings.h"

namespace bodyopt::viewport {

struct PlayFrames {
  int first = 1, last = 1;
};

// Knows no clock: advance() is given the time that has passed, and gives the same frames for the same times.
class Playback {
 public:
  static constexpr double kLongestGap = 1;  // seconds; the rest of a longer gap (a stall) is not played

  // `fps`: frames a second. Throws Error(usage) for frames that end before they begin, and an fps that is not above 0
  // and at most 1,000.
  Playback(const PlayFrames& frames, double fps);

  // Lets time pass and gives the frame to show, `most` frames on at most: the rest of the time is not played. What is
  // no positive number of seconds is no time.
  int advance(double seconds, std::int64_t most = std::numeric_limits<std::int64_t>::max());

  void play();  // at the end of a range that is played once: from its beginning
  void pause() { playing_ = false; }
  void toggle();
  void step(int frames);  // pauses; beyond the range, too, as far as the clip has frames
  // These two play on if they were playing.
  void go_to_previous_key(const std::set<int>& keys);  // stays where there is none
  void go_to_next_key(const std::set<int>& keys);
  void scrub(int frame);                // beyond the clip: its first or last
  void require_frame(int frame) const;  // throws Error(usage), which names those there are, unless the clip has it

  // Plays only frames from `in` to `out`. The frame shown stays; where it lies outside, playing enters the range at its
  // beginning. Throws Error(usage) when there is no frame of the clip within.
  void set_range(int in, int out);
  void set_keys(const std::vector<int>& frames);  // in any order; those outside the clip are left out
  void set_mode(shots::PlayMode mode) { mode_ = mode; }
  void set_speed(double speed);  // throws Error(usage) unless from PlaySettings::kSlowest to kFastest
  void set_backwards(bool backwards) { backwards_ = backwards; }
  // Real time drops frames when advance() is called late; otherwise every frame is shown.
  void set_real_time(bool real_time) { real_time_ = real_time; }

  shots::PlaySettings settings() const;
  // Returns what is to be said of a range that the clip lacks, which is forgotten. Throws as set_speed().
  std::string apply(const shots::PlaySettings& settings);

  int frame() const { return frame_at(shown_); }
  int first() const { return frame_at(0); }
  int last() const { return frame_at(count_ - 1); }
  int in() const { return frame_at(in_); }
  int out() const { return frame_at(out_); }
  std::vector<int> keys() const;  // rising
  bool playing() const { return playing_; }
  shots::PlayMode mode() const { return mode_; }
  double speed() const { return speed_; }
  bool backwards() const { return backwards_; }  // in ping-pong: as it goes now
  bool real_time() const { return real_time_; }
  std::int64_t dropped() const { return dropped_; }  // frames that were not shown since play()

 private:
  using Index = std::int64_t;  // of a frame among those of the clip

  int frame_at(Index index) const { return static_cast<int>(first_ + index); }
  Index index_of(std::int64_t frame) const { return frame - first_; }
  void show(Index index);
  Index start() const { return backwards_ ? out_ : in_; }
  Index end() const { return backwards_ ? in_ : out_; }
  void move(Index frames);
  Index move_once(Index frames);
  void move_looping(Index frames);
  void move_ping_pong(Index frames);

  Index first_, count_;
  Index in_ = 0, out_, shown_ = 0;
  double fps_;
  double waited_ = 0;  // frames; since the one shown was due
  std::vector<Index> keys_;
  shots::PlayMode mode_ = shots::PlayMode::loop;
  double speed_ = 1;
  bool playing_ = false, backwards_ = false, real_time_ = true;
  std::int64_t dropped_ = 0;
};

}  // namespace bodyopt::viewport
