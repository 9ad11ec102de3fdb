// Playback: what is shown when.
#include <algorithm>

#include "proxy_viewer/commands/command_arguments.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// "12", or as the take of a dataset that is open numbers it: "rom 40".
int frame_of_clip(const Controls& controls, const std::string& text) {
  if (text.find(' ') != std::string::npos) {
    const std::vector<std::string>& frames = controls.curating.frames;
    const auto place = std::ranges::find(frames, known(text, frames, "frame of a dataset's take")) - frames.begin();
    return controls.playback.first() + static_cast<int>(place);
  }
  const int frame = integer(text);
  controls.playback.require_frame(frame);
  return frame;
}

void require_keys(const Playback& playback) {
  if (!playback.keys().empty()) return;
  throw Error(ErrorKind::usage,
              "the clip has no keys to go to: a BVH samples its motion, and so does a clip with a key at most frames");
}

const Command kPlaybackCommands[] = {
    {"play", "", "Space", "Playback", "play or pause", [](Controls& c, const std::string&) { c.playback.toggle(); },
     [](const Controls& c) { return name_of(c.playback.playing()); }},
    {"step", "[FRAMES]", "Right", "Playback", "one frame on",
     [](Controls& c, const std::string& a) { c.playback.step(a.empty() ? 1 : integer(a)); }, nullptr, kRepeats},
    {"step-back", "", "Left", "Playback", "one frame back",
     [](Controls& c, const std::string&) { c.playback.step(-1); }, nullptr, kRepeats},
    {"first", "", "Home", "Playback", "to the first frame of the range",
     [](Controls& c, const std::string&) { c.playback.scrub(c.playback.in()); }},
    {"last", "", "End", "Playback", "to the last frame of the range",
     [](Controls& c, const std::string&) { c.playback.scrub(c.playback.out()); }},
    {"next-key", "", "Up", "Playback", "to the next key",
     [](Controls& c, const std::string&) {
       require_keys(c.playback);
       c.playback.go_to_next_key();
     },
     nullptr, kRepeats},
    {"previous-key", "", "Down", "Playback", "to the key before",
     [](Controls& c, const std::string&) {
       require_keys(c.playback);
       c.playback.go_to_previous_key();
     },
     nullptr, kRepeats},
    {"frame", "FRAME", "", "Playback", "to a frame; of a dataset's take: rom 40",
     [](Controls& c, const std::string& a) { c.playback.scrub(frame_of_clip(c, a)); }},
    {"backwards", "[on|off]", "B", "Playback", "play backwards",
     [](Controls& c, const std::string& a) {
       bool backwards = c.playback.backwards();  // as it goes now, in ping-pong
       toggle(backwards, a);
       c.playback.set_backwards(backwards);
     },
     [](const Controls& c) { return name_of(c.playback.backwards()); }},
    {"mode", "loop|ping-pong|once", "", "Playback", "what happens at the end of the range",
     [](Controls& c, const std::string& a) {
       PlayMode mode = c.playback.mode();
       choose(mode, a, kPlayModeNames);
       c.playback.set_mode(mode);
     },
     [](const Controls& c) { return name_of(c.playback.mode(), kPlayModeNames); }},
    {"speed", "0.1-2", "", "Playback", "of playing; 1: as it is",
     [](Controls& c, const std::string& a) {
       const double speed = number_within(a, PlaySettings::kSlowest, PlaySettings::kFastest);
       c.playback.set_speed(speed);
     }},
    {"every-frame", "[on|off]", "", "Playback", "drop no frame, however long it takes",
     [](Controls& c, const std::string& a) {
       bool every = !c.playback.real_time();
       toggle(every, a);
       c.playback.set_real_time(!every);
     },
     [](const Controls& c) { return name_of(!c.playback.real_time()); }},
    {"in", "[FRAME]", "I", "Playback", "the range begins here",
     [](Controls& c, const std::string& a) {
       const int in = a.empty() ? c.playback.frame() : frame_of_clip(c, a);
       if (in > c.playback.out()) c.say("the range ended earlier: it is this frame now");
       c.playback.set_range(in, std::max(in, c.playback.out()));
     }},
    {"out", "[FRAME]", "O", "Playback", "the range ends here",
     [](Controls& c, const std::string& a) {
       const int out = a.empty() ? c.playback.frame() : frame_of_clip(c, a);
       if (out < c.playback.in()) c.say("the range began later: it is this frame now");
       c.playback.set_range(std::min(c.playback.in(), out), out);
     }},
    {"whole-range", "", "Alt+I", "Playback", "play all frames",
     [](Controls& c, const std::string&) { c.playback.set_range(c.playback.first(), c.playback.last()); }},
    {"live", "[on|off]", "", "Playback", "poses that another program sends, or the clip",
     [](Controls& c, const std::string& a) {
       if (!c.live) throw Error(ErrorKind::usage, "no poses are listened for: begin with --live PORT");
       toggle(*c.live, a);
     },
     [](const Controls& c) { return name_of(c.live.value_or(false)); }},
};

}  // namespace

std::span<const Command> playback_commands() { return kPlaybackCommands; }

}  // namespace bodyopt
