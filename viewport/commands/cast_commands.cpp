// Ghosts, and the others of the cast.
#include <utility>

#include "runtime/core/error.h"
#include "shots/session/setting_fields.h"
#include "viewport/commands/commands.h"

namespace bodyopt::viewport {
namespace {

// Returns the placement of one of the cast; the lead has none.
shots::Placement& placement_of(Controls& controls, const std::string& number) {
  const std::size_t place = controls.cast_place(integer(number));
  if (place == 0) refuse(number, "the number of another than the lead, which stands where its clip has it");
  return controls.placements[place];
}

// Reads a vertex of one of the cast.
std::uint32_t vertex_of(const Controls& controls, std::size_t character, const std::string& number) {
  if (character >= controls.output_counts.size()) {
    throw Error(ErrorKind::usage, "markers are of two bodies: open the one that is transferred to after the lead");
  }
  const int last = static_cast<int>(controls.output_counts[character]) - 1;
  return static_cast<std::uint32_t>(integer_within(number, 0, last));
}

const Command kCastCommands[] = {
    {"ghosts", "BEFORE AFTER", "", "Look", "frames before and after, see-through",
     [](shots::ViewSettings::Ghosts& ghosts, const std::string& a) {
       const auto w = words(a, 2, "two counts");
       ghosts.before = integer_within(w[0], 0, shots::kMostGhosts);
       ghosts.after = integer_within(w[1], 0, shots::kMostGhosts);
     }},
    {"ghost-step", "FRAMES", "", "Look", "from one ghost to the next",
     [](shots::ViewSettings::Ghosts& ghosts, const std::string& a) {
       ghosts.step = integer_within(a, 1, shots::kLongestGhostStep);
     }},
    {"ghost-opacity", "0-1", "", "Look", "of the ghost that is next; those beyond fade",
     [](shots::ViewSettings::Ghosts& ghosts, const std::string& a) { ghosts.opacity = number_within(a, 0, 1); }},
    {"toggle-ghosts", "[on|off]", "G", "Look", "two ghosts before and two after",
     [](shots::ViewSettings::Ghosts& ghosts, const std::string& a) {
       const bool had = ghosts.before + ghosts.after > 0;
       bool has = had;
       toggle(has, a);
       if (has == had) return;
       ghosts.before = ghosts.after = has ? 2 : 0;
       if (has && ghosts.step == 1) ghosts.step = 4;
     },
     [](const Controls& c) { return name_of(c.settings.ghosts.before + c.settings.ghosts.after > 0); }},
    switch_command<&shots::ViewSettings::Ghosts::trail>("trail", "Alt+G", "Look", "the way of selected joints"),

    {"copies", "COUNT", "", "Cast", "of the lead on the stage",
     [](shots::ViewSettings::Cast& cast, const std::string& a) {
       cast.copies = integer_within(a, 1, shots::kMostCopies);
     }},
    {"copy-delay", "FRAMES", "", "Cast", "from one copy to the next",
     [](shots::ViewSettings::Cast& cast, const std::string& a) {
       cast.delay = integer_within(a, 0, shots::kLongestCopyDelay);
     }},

    {"mark", "[on|off]", "", "Cast", "clicks mark a vertex of the lead, then the same of the second of the cast",
     [](Marking& marking, const std::string& a) {
       toggle(marking.on, a);
       marking.of_lead.reset();
     },
     [](const Controls& c) { return name_of(c.marking.on); }},
    {"marker", "VERTEX VERTEX", "", "Cast", "of the lead and of the second of the cast, that are the same",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "two numbers of vertices");
       add_marker(c, {vertex_of(c, 0, all[0]), vertex_of(c, 1, all[1])});
     }},
    {"unmark", "", "", "Cast", "takes the marker away that was set last",
     [](Marking& marking, const std::string&) {
       if (marking.pairs.empty()) throw Error(ErrorKind::usage, "there is no marker");
       marking.pairs.pop_back();
     }},

    {"place", "NUMBER X Y Z|auto", "", "Cast",
     "where one of the cast begins, its height over the ground, metres; auto: where there is room",
     [](Controls& c, const std::string& a) {
       const std::string expected = "a number of the cast and three coordinates, or auto";
       const std::vector<std::string> all = words(a);
       if (all.size() != 4 && !(all.size() == 2 && all[1] == "auto")) refuse(a, expected);
       std::optional<Vec3> at;
       if (all.size() == 4) {
         at.emplace();
         for (std::size_t i = 0; i < 3; ++i) (*at)[i] = number_within(all[i + 1], -shots::kFurthest, shots::kFurthest);
       }
       placement_of(c, all[0]).at = at;
     }},
    {"ahead", "NUMBER FRAMES|auto", "", "Cast", "one of the cast goes round in its own clip; auto: frame by frame",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a number of frames, or auto");
       placement_of(c, all[0]).ahead =
           automatic_or(all[1], -shots::kFurthestAhead, shots::kFurthestAhead, integer_within);
     }},
    {"level-of", "NUMBER auto|0|1|2...", "", "Cast", "of detail, of one of the cast; auto: by its size in the picture",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a level, or auto");
       placement_of(c, all[0]).level = automatic_or(all[1], 0, shots::kCoarsestLevel, integer_within);
     }},
    request_command<&Requests::same_clip>("same-clip", "", "Cast", "all of the cast play the lead's clip"),
};

// Commands of comparison and curation.

void go_to_pair(Controls& controls, int pair) {
  controls.curating.pair = pair;
  controls.playback.pause();
  const ListedPair& listed = controls.curating.pairs[static_cast<std::size_t>(pair)];
  controls.curating.region = listed.region;
  controls.playback.scrub(listed.first);
  controls.requests.frame_selection = true;  // motion capture goes far, and stretches its arms
}

const Command kCompareCommands[] = {
    {"compare", "none|lbs|ddm|linear|full|jiggle|truth|proxy", "", "Compare", "with what",
     [](Controls& c, const std::string& a) {
       choose(c.settings.compare.with, a, shots::kComparisonNames);
       const shots::CompareWith shown = c.settings.jiggle.on ? shots::CompareWith::jiggle : shots::CompareWith::full;
       if (c.settings.compare.with == shown) c.say("that is what is shown: there is nothing beside it");
     },
     [](const Controls& c) { return name_of(c.settings.compare.with, shots::kComparisonNames); }},
    choice_command<shots::kLayoutNames, &shots::ViewSettings::Compare::layout>("layout", "side-by-side|overlay|wipe|hold", "Compare",
                                                                 "of a comparison"),
    {"next-layout", "", "L", "Compare", "side by side, overlay, wipe, hold",
     [](shots::ViewSettings::Compare& compare, const std::string&) { choose_next(compare.layout, shots::kLayoutNames); }},
    {"wipe", "0-1", "", "Compare", "where, of the picture's width",
     [](shots::ViewSettings::Compare& compare, const std::string& a) { compare.wipe = number_within(a, 0, 1); }},
    switch_command<&shots::ViewSettings::Compare::heat>("heat", "E", "Compare", "colour by the distance, in millimetres"),
    {"heat-scale", "auto|MM", "", "Compare", "the hottest colour; auto: by what was measured",
     [](shots::ViewSettings::Compare& compare, const std::string& a) {
       compare.heat_scale_mm = automatic_or(a, shots::kFinestHeat, shots::kCoarsestHeat, number_within);
     }},
    switch_command<&shots::ViewSettings::Compare::activation>("activation", "", "Compare",
                                                       "colour by what was learned: the distance to Direct Delta Mush"),
    switch_command<&shots::ViewSettings::Compare::coverage>("coverage", "", "Compare",
                                                     "colour by the error to expect of the pose, in millimetres"),
    choice_command<shots::kMatchNames, &shots::ViewSettings::Compare::match>(
        "match", "none|colours|confidence", "Cast",
        "which point of the lead is which of the second of the cast, or how sure that is"),
    request_command<&Requests::worst_frame>("worst-frame", "N", "Compare",
                                            "to the frame furthest from what it is compared with"),
    request_command<&Requests::worst_vertex>("worst-vertex", "Shift+N", "Compare",
                                             "to the vertex furthest off in this frame"),

    {"region", "NAME", "", "Curate", "of the dataset's map of poses",
     [](Curating& curating, const std::string& a) { curating.region = known(a, curating.regions, "region"); }},
    choice_command<kMapColourNames, &Curating::colour>("map-colour", "coverage|contradiction|error|sculpt|weight",
                                                       "Curate", "of the map of poses"),
    switch_command<&Curating::raw>("raw", "", "Curate", "the dataset's shapes before any modifier"),
    {"modifier", "NAME on|off", "", "Curate", "switches a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, state] = split_last(a, "a modifier, and on or off");
       if (state != "on" && state != "off") refuse(state, "on or off");
       c.requests.edits.push_back({.name = known(name, c.curating.modifiers, "modifier"), .enabled = state == "on"});
     }},
    {"strength", "NAME 0-1", "", "Curate", "of a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, strength] = split_last(a, "a modifier and a strength");
       c.requests.edits.push_back(
           {.name = known(name, c.curating.modifiers, "modifier"), .strength = number_within(strength, 0, 1)});
     }},
    {"undo-edit", "", "", "Curate", "the dataset's stack before the last edit",
     [](Requests& requests, const std::string&) { requests.step_back = true; }},
    {"redo-edit", "", "", "Curate", "the edit of the stack that was undone",
     [](Requests& requests, const std::string&) { requests.step_back = false; }},
    {"brush", "none|grab|smooth|inflate|flatten|erase", "", "Curate",
     "what the mouse does to the dataset's skin; none: it turns the view",
     [](Controls& c, const std::string& a) {
       if (a == "none") {
         c.brush.kind = std::nullopt;
         return;
       }
       BrushKind kind{};
       choose(kind, a, kBrushKindNames);
       if (c.curating.regions.empty())
         throw Error(ErrorKind::usage, "no dataset is open: begin with bodyopt view DATASET");
       c.brush.kind = kind;
       c.settings.compare.with = shots::CompareWith::truth;  // or its skin would not be seen
     },
     [](const Controls& c) { return c.brush.kind ? name_of(*c.brush.kind, kBrushKindNames) : "none"; }},
    {"brush-radius", "MM", "", "Curate", "of the brush, along the skin",
     [](BrushInHand& brush, const std::string& a) { brush.radius_mm = number_within(a, shots::kFinestBrush, shots::kWidestBrush); }},
    {"brush-strength", "0-1", "", "Curate", "of the brush",
     [](BrushInHand& brush, const std::string& a) { brush.strength = number_within(a, 0, 1); }},
    switch_command<&BrushInHand::symmetric>("brush-symmetry", "", "Curate",
                                            "the brush does the same on the other side of the body"),
    {"brush-spread", "auto|DEGREES", "", "Curate", "to poses how near a stroke reaches; auto: as the modifier's",
     [](BrushInHand& brush, const std::string& a) { brush.spread = automatic_or(a, 0, shots::kWidestSpread, number_within); }},
    {"brush-modifier", "NAME", "", "Curate",
     "the sculpt of the dataset's stack that takes strokes; a new name makes one",
     [](BrushInHand& brush, const std::string& a) { brush.modifier = a; }},
    {"stroke", "X Y [X Y ...]", "", "Curate",
     "of the brush through points of the picture, by shares of its width and height",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> w = words(a);
       if (w.size() % 2 != 0) refuse(a, "a list of points: two shares each");
       if (!c.brush.kind) throw Error(ErrorKind::usage, "no brush is in hand: 'brush grab'");
       PicturePath path;
       for (std::size_t k = 0; k < w.size(); k += 2)
         path.push_back({number_within(w[k], 0, 1), number_within(w[k + 1], 0, 1)});
       c.requests.stroke = std::move(path);
     }},
    request_command<&Requests::keep_strokes>("keep-strokes", "", "Curate",
                                             "writes what was brushed and could not be written before"),
    request_command<&Requests::contradictions>("contradictions", "", "Curate",
                                               "looks for like poses whose shapes disagree"),
    {"pair", "NUMBER", "", "Curate", "to the first of two frames that disagree, the worst from 1",
     [](Controls& c, const std::string& a) {
       if (c.curating.pairs.empty()) {
         throw Error(ErrorKind::usage,
                     c.curating.compared
                         ? "there is no pair: 'contradictions' found no like poses whose shapes disagree"
                         : "no frames are known to disagree: 'contradictions' looks for them");
       }
       go_to_pair(c, integer_within(a, 1, static_cast<int>(c.curating.pairs.size())) - 1);
     }},
    {"next-pair", "", "", "Curate", "to the pair after that",
     [](Controls& c, const std::string&) {
       const auto count = static_cast<int>(c.curating.pairs.size());
       if (count > 0) go_to_pair(c, (c.curating.pair + 1) % count);
     }},
    {"other-of-pair", "", "", "Curate", "to the other of the two frames",
     [](Controls& c, const std::string&) {
       if (c.curating.pair < 0) return;
       const ListedPair& listed = c.curating.pairs[static_cast<std::size_t>(c.curating.pair)];
       c.playback.scrub(c.playback.frame() == listed.first ? listed.second : listed.first);
     }},
};

}  // namespace

std::span<const Command> cast_commands() { return kCastCommands; }

std::span<const Command> compare_commands() { return kCompareCommands; }

}  // namespace bodyopt::viewport
