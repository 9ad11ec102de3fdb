#include "viewport/state/playback.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::viewport {
namespace {

constexpr double kHighestRate = 1000;  // frames a second

std::string range_text(std::int64_t first, std::int64_t last) {
  return std::to_string(first) + "-" + std::to_string(last);
}

void require(bool good, const std::string& problem) {
  if (!good) throw Error(ErrorKind::usage, problem);
}

// Modulo with a result from 0 on.
std::int64_t modulo(std::int64_t a, std::int64_t b) { return ((a % b) + b) % b; }

}  // namespace

Playback::Playback(const PlayFrames& frames, double fps) : first_(frames.first), fps_(fps) {
  const std::string named = "frames " + range_text(frames.first, frames.last) + " cannot be played: ";
  require(frames.last >= frames.first, named + "they end before they begin");
  std::ostringstream rate;
  rate << named << "they have " << fps << " frames a second, expected more than 0 and at most " << kHighestRate;
  require(fps > 0 && fps <= kHighestRate, rate.str());
  count_ = std::int64_t{frames.last} - frames.first + 1;
  out_ = count_ - 1;
}

int Playback::advance(double seconds, std::int64_t most) {
  if (!playing_ || !(seconds > 0)) return frame();
  waited_ += std::min(seconds, kLongestGap) * speed_ * fps_;
  const double due = std::floor(waited_);
  if (due < 1) return frame();
  waited_ -= due;
  move(real_time_ ? std::min(static_cast<Index>(due), most) : 1);
  return frame();
}

void Playback::play() {
  if (playing_) return;
  playing_ = true;
  waited_ = 0;
  dropped_ = 0;
  if (mode_ == shots::PlayMode::once && shown_ == end()) shown_ = start();
}

void Playback::toggle() { playing_ ? pause() : play(); }

void Playback::step(int frames) {
  pause();
  show(shown_ + frames);
}

void Playback::go_to_previous_key(const std::set<int>& keys) {
  const auto here = keys.lower_bound(frame());
  if (here != keys.begin()) scrub(*std::prev(here));
}

void Playback::go_to_next_key(const std::set<int>& keys) {
  const auto next = keys.upper_bound(frame());
  if (next != keys.end()) scrub(*next);
}

void Playback::scrub(int frame) { show(index_of(frame)); }

void Playback::require_frame(int frame) const {
  require(
      frame >= first() && frame <= last(),
      "'" + std::to_string(frame) + "' is not a frame of the clip, which has frames " + range_text(first(), last()));
}

void Playback::set_range(int in, int out) {
  const Index begin = std::max<Index>(index_of(in), 0);
  const Index end = std::min(index_of(out), count_ - 1);
  require(begin <= end, "there is no frame of " + range_text(first(), last()) + " in the range " + range_text(in, out));
  in_ = begin;
  out_ = end;
}

void Playback::set_keys(const std::vector<int>& frames) {
  keys_.clear();
  for (const int frame : frames) {
    if (frame >= first_ && index_of(frame) < count_) keys_.push_back(index_of(frame));
  }
  std::sort(keys_.begin(), keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
}

void Playback::set_speed(double speed) {
  std::ostringstream problem;
  problem << "a speed is from " << shots::PlaySettings::kSlowest << " to " << shots::PlaySettings::kFastest << ", not "
          << speed;
  require(speed >= shots::PlaySettings::kSlowest && speed <= shots::PlaySettings::kFastest, problem.str());
  speed_ = speed;
}

shots::PlaySettings Playback::settings() const {
  shots::PlaySettings settings{mode_, speed_, backwards_, real_time_, std::nullopt, std::nullopt};
  if (in_ > 0) settings.in = in();
  if (out_ < count_ - 1) settings.out = out();
  return settings;
}

std::string Playback::apply(const shots::PlaySettings& settings) {
  set_mode(settings.mode);
  set_speed(settings.speed);
  set_backwards(settings.backwards);
  set_real_time(settings.real_time);
  set_range(first(), last());
  const int in = settings.in.value_or(first()), out = settings.out.value_or(last());
  const std::string lacks =
      "the range is frames " + range_text(in, out) + ", the clip has " + range_text(first(), last()) + ": ";
  if (in > out || in > last() || out < first()) return lacks + "all of the clip is played";
  set_range(in, out);
  return first() <= in && out <= last() ? "" : lacks + "those of both are played";
}

std::vector<int> Playback::keys() const {
  return transformed(keys_, [&](const Index key) { return frame_at(key); });
}

void Playback::show(Index index) {
  shown_ = std::clamp<Index>(index, 0, count_ - 1);
  waited_ = 0;
}

// `frames`: one or more.
void Playback::move(Index frames) {
  const bool outside = shown_ < in_ || shown_ > out_;
  if (outside) shown_ = start();
  const Index left = outside ? frames - 1 : frames;
  Index moved = frames;
  if (mode_ == shots::PlayMode::once) {
    moved = move_once(left) + (outside ? 1 : 0);
  } else if (mode_ == shots::PlayMode::loop) {
    move_looping(left);
  } else {
    move_ping_pong(left);
  }
  if (in_ < out_) dropped_ += std::max<Index>(moved - 1, 0);
}

// Gives how many frames it went before the end.
Playback::Index Playback::move_once(Index frames) {
  const Index moved = std::min(frames, std::abs(end() - shown_));
  shown_ += backwards_ ? -moved : moved;
  if (shown_ == end()) playing_ = false;
  return moved;
}

void Playback::move_looping(Index frames) {
  shown_ = in_ + modulo(shown_ - in_ + (backwards_ ? -frames : frames), out_ - in_ + 1);
}

// There and back is a loop of twice the length, in which either end comes once.
void Playback::move_ping_pong(Index frames) {
  const Index length = out_ - in_;
  if (length == 0 || frames == 0) return;
  const Index there = shown_ - in_;
  const Index phase = modulo((backwards_ ? -there : there) + frames, 2 * length);
  shown_ = in_ + (phase <= length ? phase : 2 * length - phase);
  backwards_ = phase >= length;
}

}  // namespace bodyopt::viewport
