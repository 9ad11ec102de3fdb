// Commands that write files, and those of what is around the picture.
#include "assets/caches/cache_writer.h"
#include "runtime/core/error.h"
#include "shots/session/view_settings.h"
#include "viewport/commands/commands.h"

namespace bodyopt::viewport {
namespace {

const Command kFileCommands[] = {
    {"open", "[FILE]", "Ctrl+O", "File", "a basis, character, clip, point cache, dataset or session",
     [](Controls& c, const std::string& a) {
       if (a.empty()) return c.browse("open");
       c.requests.open.push_back(a);
     }},
    {"character", "[FILE]", "", "File", "one more character, also where a file of its rig would be a clip",
     [](Controls& c, const std::string& a) {
       if (a.empty()) return c.browse("character");
       c.requests.add.push_back(a);
     }},
    {"unit", "METRES|auto", "", "File", "of character files: the lead's is read again by it",
     [](Requests& requests, const std::string& a) {
       requests.unit = automatic_or(a, 1e-6, 1e6, number_within).value_or(0);
     }},
    {"recent", "NUMBER", "", "File", "a file that was open lately, the last from 1",
     [](Controls& c, const std::string& a) {
       if (c.recent.empty()) throw Error(ErrorKind::usage, "no file is known to have been open lately");
       const int number = integer_within(a, 1, static_cast<int>(c.recent.size()));
       c.requests.open.push_back(c.recent[static_cast<std::size_t>(number) - 1]);
     }},
    {"save", "[FILE.json]", "Ctrl+S", "File", "the session: files, poses, keys, cameras and settings; open reads it",
     [](Controls& c, const std::string& a) {
       const std::string& file = a.empty() ? c.session_file : a;
       if (file.empty() && !c.headless) return c.browse("save");
       require_ending(file, ".json");
       c.requests.save = file;
     }},
    {"recover", "[discard]", "", "File", "work that a viewport left unsaved, or discard it",
     [](Controls& c, const std::string& a) {
       if (!a.empty() && a != "discard") refuse(a, "'discard' or nothing");
       if (c.recoverable.empty()) throw Error(ErrorKind::usage, "no viewport left work that was not saved");
       c.requests.recover = a.empty();
     }},
    {"export-clip", "FILE.glb|.bvh|.usda", "", "File", "the motion of the range, as it is posed and keyed",
     [](Requests& requests, const std::string& a) {
       require_ending(a, ".glb|.bvh|.usda");
       requests.export_clip = a;
     }},
    {"export-skin", "FILE.pc2|.mdd|.usda|.glb", "", "File", "the lead's skin over the range, and what it wears",
     [](Requests& requests, const std::string& a) {
       require_ending(a, kCacheEndings);
       requests.export_skin = a;
     }},
    {"screenshot", "[FILE.png]", "F12", "File", "the picture as it is",
     [](Requests& requests, const std::string& a) { requests.screenshot = a; }},
    {"sequence", "FILE.####.png", "", "File", "a picture of every frame of the range; .mp4, .webp: a movie",
     [](Requests& requests, const std::string& a) { requests.sequence = a; }},
    {"turntable", "FILE.####.png", "", "File", "once around, 72 pictures",
     [](Requests& requests, const std::string& a) { requests.turntable = a; }},
    {"save-state", "FILE.json", "", "File", "cameras and settings",
     [](Requests& requests, const std::string& a) { requests.save_state = a; }},
    {"load-state", "FILE.json", "", "File", "cameras and settings; the frame stays: sessions keep it",
     [](Requests& requests, const std::string& a) { requests.load_state = a; }},
    {"save-markers", "FILE.json", "", "File", "for bodyopt transfer --markers",
     [](Requests& requests, const std::string& a) {
       require_ending(a, ".json");
       requests.save_markers = a;
     }},
    {"lead", "NUMBER", "", "Cast", "the character of whom panels speak, and to whom clips and caches go",
     [](Requests& requests, const std::string& a) { requests.lead = integer(a); }},
    {"remove", "NUMBER", "", "Cast", "a character of the cast; its files stay",
     [](Requests& requests, const std::string& a) { requests.remove = integer(a); }},
    request_command<&Requests::reload>("reload", "F5", "File", "read all files again"),
    {"browse",
     "open|character|save|save-state|load-state|save-pose|load-pose|limits|sound|image-plane|export-clip|export-skin|screenshot|sequence|turntable",
     "", "File", "chooses the file of a command from the list of a folder",
     [](Controls& c, const std::string& a) { c.browse(known(a, browsed_commands(), "command that takes a file")); }},
    {"quit", "", "Ctrl+Q", "File", "close the viewport; what is not saved is asked about",
     [](Controls& c, const std::string&) { c.quit_or_ask(); }},
    switch_command<&Controls::panels>("panels", "Tab", "View", "panels, or the picture alone"),
    switch_command<&shots::ViewSettings::Hud::on>("hud", "Z", "View", "figures over the picture"),
    switch_command<&shots::ViewSettings::Hud::legend>("legend", "", "View",
                                                      "names of what is compared, and what colours mean"),
    switch_command<&Controls::cheat_sheet>("cheat-sheet", "H", "View", "all keys"),
    switch_command<&Controls::prompt>("prompt", "Enter", "View", "type a command"),
    {"side-panel", "[on|off]", "Q", "View", "the panel on the right",
     [](shots::ViewSettings::Hud& hud, const std::string& a) {
       toggle(hud.panels.try_emplace(shots::kSidePanel, true).first->second, a);
     },
     [](const Controls& c) { return name_of(shots::shows_side_panel(c.settings)); }},
    {"section", "look|cameras|compare|curate|pose|poses|keys|modifiers|muscles|jiggle|ghosts|cast|transfer|output", "",
     "View", "opens a section of the side panel, and closes the others",
     [](shots::ViewSettings& settings, const std::string& a) {
       shots::open_section(settings, known(a, shots::section_names(), "section of the side panel"));
     }},
    {"keymap", "bodyopt|maya|blender", "", "View", "keys as there, also in viewports that follow",
     [](Controls& c, const std::string& a) {
       choose(c.keymap, a, kKeymapNames);
       c.requests.keep_keymap = true;
     },
     [](const Controls& c) { return name_of(c.keymap, kKeymapNames); }},
};

}  // namespace

std::span<const Command> file_commands() { return kFileCommands; }

}  // namespace bodyopt::viewport
