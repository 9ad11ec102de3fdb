// How it looks.
#include "proxy_viewer/commands/command_arguments.h"
#include "proxy_viewer/commands/command_tables.h"
#include "proxy_viewer/state/setting_fields.h"

namespace bodyopt {
namespace {

const Command kLookCommands[] = {
    {"style", "clay|matcap|flat|normals", "", "Look", "how skin looks",
     [](Controls& c, const std::string& a) { choose(c.settings.look.style, a, kStyleNames); },
     [](const Controls& c) { return name_of(c.settings.look.style, kStyleNames); }},
    {"next-style", "", "S", "Look", "clay, matcap, flat, normals",
     [](Controls& c, const std::string&) { choose_next(c.settings.look.style, kStyleNames); }},
    {"wire", "[on|off]", "W", "Look", "edges over the surface",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.wire, a); },
     [](const Controls& c) { return name_of(c.settings.look.wire); }},
    {"skeleton", "[on|off]", "K", "Look", "joints and bones, seen through the skin",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.skeleton, a); },
     [](const Controls& c) { return name_of(c.settings.look.skeleton); }},
    {"fibres", "[on|off]", "M", "Look", "muscle fibres, coloured by strain",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.fibres, a); },
     [](const Controls& c) { return name_of(c.settings.look.fibres); }},
    {"tets", "[on|off]", "T", "Look", "the tetrahedra of the jiggle, cut open",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.tets, a); },
     [](const Controls& c) { return name_of(c.settings.look.tets); }},
    {"tet-cut", "0-1", "", "Look", "share of the body that is cut away, from the front",
     [](Controls& c, const std::string& a) { c.settings.look.tet_cut = number_within(a, 0, 1); }},
    {"anatomy", "[on|off]", "", "Look", "the lead cut open: bone, fat, cavity and muscles, named under the mouse",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.anatomy, a); },
     [](const Controls& c) { return name_of(c.settings.look.anatomy); }},
    {"anatomy-axis", "x|y|z", "", "Look", "of the world: what the cut is across",
     [](Controls& c, const std::string& a) { choose(c.settings.look.anatomy_axis, a, kSectionAxisNames); },
     [](const Controls& c) { return name_of(c.settings.look.anatomy_axis, kSectionAxisNames); }},
    {"anatomy-at", "0-1", "", "Look", "where the cut is, of the body's extent along that axis",
     [](Controls& c, const std::string& a) { c.settings.look.anatomy_at = number_within(a, 0, 1); }},
    {"level", "auto|0|1|2...", "", "Look", "of detail, 0 the finest; auto: the one that keeps up",
     [](Controls& c, const std::string& a) { c.settings.look.level = automatic_or(a, 0, kCoarsestLevel); }},
    {"grid", "[on|off]", "D", "Look", "the grid on the ground",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.grid, a); },
     [](const Controls& c) { return name_of(c.settings.look.grid); }},
    {"axes", "[on|off]", "A", "Look", "the world's axes",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.axes, a); },
     [](const Controls& c) { return name_of(c.settings.look.axes); }},
    {"shadow", "[on|off]", "", "Look", "the shadow on the ground",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.shadow, a); },
     [](const Controls& c) { return name_of(c.settings.look.shadow); }},
    {"worn", "[on|off]", "", "Look", "clothes, eyes and what else is attached to the skin",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.worn, a); },
     [](const Controls& c) { return name_of(c.settings.look.worn); }},
};

}  // namespace

std::span<const Command> look_commands() { return kLookCommands; }

}  // namespace bodyopt
