// What is compared, and curated.
#include <utility>

#include "proxy_viewer/commands/command_arguments.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

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
       choose(c.settings.compare.with, a, kComparisonNames);
       const CompareWith shown = c.settings.jiggle.on ? CompareWith::jiggle : CompareWith::full;
       if (c.settings.compare.with == shown) c.say("that is what is shown: there is nothing beside it");
     },
     [](const Controls& c) { return name_of(c.settings.compare.with, kComparisonNames); }},
    choice_command<kLayoutNames, &ViewSettings::Compare::layout>("layout", "side-by-side|overlay|wipe|hold", "Compare",
                                                                 "of a comparison"),
    {"next-layout", "", "L", "Compare", "side by side, overlay, wipe, hold",
     [](Controls& c, const std::string&) { choose_next(c.settings.compare.layout, kLayoutNames); }},
    {"wipe", "0-1", "", "Compare", "where, of the picture's width",
     [](Controls& c, const std::string& a) { c.settings.compare.wipe = number_within(a, 0, 1); }},
    switch_command<&ViewSettings::Compare::heat>("heat", "E", "Compare", "colour by the distance, in millimetres"),
    {"heat-scale", "auto|MM", "", "Compare", "the hottest colour; auto: by what was measured",
     [](Controls& c, const std::string& a) {
       c.settings.compare.heat_scale_mm = automatic_or(a, kFinestHeat, kCoarsestHeat, number_within);
     }},
    switch_command<&ViewSettings::Compare::activation>("activation", "", "Compare",
                                                       "colour by what was learned: the distance to Direct Delta Mush"),
    switch_command<&ViewSettings::Compare::coverage>("coverage", "", "Compare",
                                                     "colour by the error to expect of the pose, in millimetres"),
    choice_command<kMatchNames, &ViewSettings::Compare::match>(
        "match", "none|colours|confidence", "Compare",
        "colour the lead and the second of the cast by which point is which, or by how sure that is"),
    request_command<&Requests::worst_frame>("worst-frame", "N", "Compare",
                                            "to the frame that is furthest from what it is compared with"),
    request_command<&Requests::worst_vertex>("worst-vertex", "Shift+N", "Compare",
                                             "to the vertex that is furthest off in this frame"),

    {"region", "NAME", "", "Compare", "of the dataset's map of poses",
     [](Controls& c, const std::string& a) { c.curating.region = known(a, c.curating.regions, "region"); }},
    choice_command<kMapColourNames, &Curating::colour>(
        "map-colour", "coverage|contradiction|error|sculpt|weight", "Compare",
        "of the map: thin data, like poses that disagree, the distance, what takes part in the last stroke, or how much "
        "frames count"),
    switch_command<&Curating::raw>("raw", "", "Compare", "the dataset's shapes before any modifier"),
    {"modifier", "NAME on|off", "", "Compare", "switches a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, state] = split_last(a, "a modifier, and on or off");
       if (state != "on" && state != "off") refuse(state, "on or off");
       c.requests.edits.push_back({.name = known(name, c.curating.modifiers, "modifier"), .enabled = state == "on"});
     }},
    {"strength", "NAME 0-1", "", "Compare", "of a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, strength] = split_last(a, "a modifier and a strength");
       c.requests.edits.push_back(
           {.name = known(name, c.curating.modifiers, "modifier"), .strength = number_within(strength, 0, 1)});
     }},
    {"undo-edit", "", "", "Compare", "the dataset's stack before the last edit",
     [](Controls& c, const std::string&) { c.requests.step_back = true; }},
    {"redo-edit", "", "", "Compare", "the edit of the stack that was undone",
     [](Controls& c, const std::string&) { c.requests.step_back = false; }},
    {"brush", "none|grab|smooth|inflate|flatten|erase", "", "Compare",
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
       c.settings.compare.with = CompareWith::truth;  // or its skin would not be seen
     },
     [](const Controls& c) { return c.brush.kind ? name_of(*c.brush.kind, kBrushKindNames) : "none"; }},
    {"brush-radius", "MM", "", "Compare", "of the brush, along the skin",
     [](Controls& c, const std::string& a) { c.brush.radius_mm = number_within(a, kFinestBrush, kWidestBrush); }},
    {"brush-strength", "0-1", "", "Compare", "of the brush",
     [](Controls& c, const std::string& a) { c.brush.strength = number_within(a, 0, 1); }},
    switch_command<&BrushInHand::symmetric>("brush-symmetry", "", "Compare",
                                            "the brush does the same on the other side of the body"),
    {"brush-spread", "auto|DEGREES", "", "Compare", "to poses how near a stroke reaches; auto: as the modifier's",
     [](Controls& c, const std::string& a) { c.brush.spread = automatic_or(a, 0, kWidestSpread, number_within); }},
    {"brush-modifier", "NAME", "", "Compare",
     "the sculpt of the dataset's stack that takes strokes; a new name makes one",
     [](Controls& c, const std::string& a) { c.brush.modifier = a; }},
    {"stroke", "X Y [X Y ...]", "", "Compare",
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
    request_command<&Requests::keep_strokes>("keep-strokes", "", "Compare",
                                             "writes what was brushed and could not be written before"),
    request_command<&Requests::contradictions>("contradictions", "", "Compare",
                                               "looks for like poses whose shapes disagree"),
    {"pair", "NUMBER", "", "Compare", "to the first of two frames that disagree, the worst from 1",
     [](Controls& c, const std::string& a) {
       if (c.curating.pairs.empty()) {
         throw Error(ErrorKind::usage,
                     c.curating.compared
                         ? "there is no pair: 'contradictions' found no like poses whose shapes disagree"
                         : "no frames are known to disagree: 'contradictions' looks for them");
       }
       go_to_pair(c, integer_within(a, 1, static_cast<int>(c.curating.pairs.size())) - 1);
     }},
    {"next-pair", "", "", "Compare", "to the pair after that",
     [](Controls& c, const std::string&) {
       const auto count = static_cast<int>(c.curating.pairs.size());
       if (count > 0) go_to_pair(c, (c.curating.pair + 1) % count);
     }},
    {"other-of-pair", "", "", "Compare", "to the other of the two frames",
     [](Controls& c, const std::string&) {
       if (c.curating.pair < 0) return;
       const ListedPair& listed = c.curating.pairs[static_cast<std::size_t>(c.curating.pair)];
       c.playback.scrub(c.playback.frame() == listed.first ? listed.second : listed.first);
     }},
};

}  // namespace

std::span<const Command> compare_commands() { return kCompareCommands; }

}  // namespace bodyopt
