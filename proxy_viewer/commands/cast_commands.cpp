// Ghosts, and the others of the cast.
#include "proxy_viewer/commands/command_arguments.h"
#include "runtime/core/error.h"
#include "shots/session/setting_fields.h"

namespace bodyopt {
namespace {

// Of one of the cast, which are counted from 1, but the lead.
Standing& standing_of(Controls& controls, const std::string& number) {
  const int index = integer(number);
  if (index >= 2 && static_cast<std::size_t>(index) <= controls.standings.size()) {
    return controls.standings[static_cast<std::size_t>(index) - 1];
  }
  refuse(number, "one of the cast but the lead, expected a number from 2 to " +
                     std::to_string(controls.standings.size()) + ", as the cast panel counts them");
}

// Of a vertex of one of the cast.
std::uint32_t vertex_of(const Controls& controls, std::size_t character, const std::string& number) {
  if (character >= controls.output_counts.size()) {
    throw Error(ErrorKind::usage, "markers are of two bodies: open the one that is transferred to after the lead");
  }
  const int last = static_cast<int>(controls.output_counts[character]) - 1;
  return static_cast<std::uint32_t>(integer_within(number, 0, last));
}

const Command kCastCommands[] = {
    {"ghosts", "BEFORE AFTER", "", "Look", "frames before and after, see-through",
     [](Controls& c, const std::string& a) {
       const auto w = words(a, 2, "two counts");
       c.settings.ghosts.before = integer_within(w[0], 0, kMostGhosts);
       c.settings.ghosts.after = integer_within(w[1], 0, kMostGhosts);
     }},
    {"ghost-step", "FRAMES", "", "Look", "from one ghost to the next",
     [](Controls& c, const std::string& a) { c.settings.ghosts.step = integer_within(a, 1, kLongestGhostStep); }},
    {"ghost-opacity", "0-1", "", "Look", "of the ghost that is next; those beyond fade",
     [](Controls& c, const std::string& a) { c.settings.ghosts.opacity = number_within(a, 0, 1); }},
    {"toggle-ghosts", "[on|off]", "G", "Look", "two ghosts before and two after",
     [](Controls& c, const std::string& a) {
       ViewSettings::Ghosts& ghosts = c.settings.ghosts;
       const bool had = ghosts.before + ghosts.after > 0;
       bool has = had;
       toggle(has, a);
       if (has == had) return;
       ghosts.before = ghosts.after = has ? 2 : 0;
       if (has && ghosts.step == 1) ghosts.step = 4;
     },
     [](const Controls& c) { return name_of(c.settings.ghosts.before + c.settings.ghosts.after > 0); }},

    {"copies", "COUNT", "", "Look", "of the lead on the stage",
     [](Controls& c, const std::string& a) { c.settings.cast.copies = integer_within(a, 1, kMostCopies); }},
    {"copy-delay", "FRAMES", "", "Look", "from one copy to the next",
     [](Controls& c, const std::string& a) { c.settings.cast.delay = integer_within(a, 0, kLongestCopyDelay); }},

    {"mark", "[on|off]", "", "Compare", "clicks mark a vertex of the lead, then the same of the second of the cast",
     [](Controls& c, const std::string& a) {
       toggle(c.marking.on, a);
       c.marking.of_lead.reset();
     },
     [](const Controls& c) { return name_of(c.marking.on); }},
    {"marker", "VERTEX VERTEX", "", "Compare", "of the lead and of the second of the cast, that are the same",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "two numbers of vertices");
       add_marker(c, {vertex_of(c, 0, all[0]), vertex_of(c, 1, all[1])});
     }},
    {"unmark", "", "", "Compare", "takes the marker away that was set last",
     [](Controls& c, const std::string&) {
       if (c.marking.pairs.empty()) throw Error(ErrorKind::usage, "there is no marker");
       c.marking.pairs.pop_back();
     }},

    {"place", "NUMBER X Y Z|auto", "", "Look", "where one of the cast begins, metres; auto: where there is room",
     [](Controls& c, const std::string& a) {
       const std::string expected = "a number of the cast and three coordinates, or auto";
       const std::vector<std::string> all = words(a);
       if (all.size() != 4 && !(all.size() == 2 && all[1] == "auto")) refuse(a, expected);
       std::optional<Vec3> at;
       if (all.size() == 4) {
         at.emplace();
         for (std::size_t i = 0; i < 3; ++i) (*at)[i] = number_within(all[i + 1], -kFurthest, kFurthest);
       }
       standing_of(c, all[0]).at = at;
     }},
    {"ahead", "NUMBER FRAMES|auto", "", "Playback", "one of the cast goes round in its own clip; auto: frame by frame",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a number of frames, or auto");
       standing_of(c, all[0]).ahead = automatic_or(all[1], -kFurthestAhead, kFurthestAhead, integer_within);
     }},
    {"level-of", "NUMBER auto|0|1|2...", "", "Look", "of detail, of one of the cast; auto: by its size in the picture",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a level, or auto");
       standing_of(c, all[0]).level = automatic_or(all[1], 0, kCoarsestLevel, integer_within);
     }},
    request_command<&Requests::same_clip>("same-clip", "", "Playback", "all of the cast play the lead's clip"),
};

}  // namespace

std::span<const Command> cast_commands() { return kCastCommands; }

}  // namespace bodyopt
