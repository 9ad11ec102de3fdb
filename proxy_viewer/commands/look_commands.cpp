// How it looks.
#include "proxy_viewer/commands/command_arguments.h"

namespace bodyopt {
namespace {

const Command kLookCommands[] = {
    choice_command<kStyleNames, &ViewSettings::Look::style>("style", "clay|matcap|flat|normals", "Look",
                                                            "how skin looks"),
    {"next-style", "", "S", "Look", "clay, matcap, flat, normals",
     [](Controls& c, const std::string&) { choose_next(c.settings.look.style, kStyleNames); }},
    switch_command<&ViewSettings::Look::wire>("wire", "W", "Look", "edges over the surface"),
    switch_command<&ViewSettings::Look::skeleton>("skeleton", "K", "Look", "joints and bones, seen through the skin"),
    switch_command<&ViewSettings::Look::fibres>("fibres", "M", "Look", "muscle fibres, coloured by strain"),
    switch_command<&ViewSettings::Look::tets>("tets", "T", "Look", "the tetrahedra of the jiggle, cut open"),
    {"tet-cut", "0-1", "", "Look", "share of the body that is cut away, from the front",
     [](Controls& c, const std::string& a) { c.settings.look.tet_cut = number_within(a, 0, 1); }},
    switch_command<&ViewSettings::Look::anatomy>(
        "anatomy", "", "Look", "the lead cut open: bone, fat, cavity and muscles, named under the mouse"),
    choice_command<kSectionAxisNames, &ViewSettings::Look::anatomy_axis>("anatomy-axis", "x|y|z", "Look",
                                                                         "of the world: what the cut is across"),
    {"anatomy-at", "0-1", "", "Look", "where the cut is, of the body's extent along that axis",
     [](Controls& c, const std::string& a) { c.settings.look.anatomy_at = number_within(a, 0, 1); }},
    {"level", "auto|0|1|2...", "", "Look", "of detail, 0 the finest; auto: the one that keeps up",
     [](Controls& c, const std::string& a) {
       c.settings.look.level = automatic_or(a, 0, kCoarsestLevel, integer_within);
     }},
    switch_command<&ViewSettings::Look::grid>("grid", "D", "Look", "the grid on the ground"),
    switch_command<&ViewSettings::Look::axes>("axes", "A", "Look", "the world's axes"),
    switch_command<&ViewSettings::Look::shadow>("shadow", "", "Look", "the shadow on the ground"),
    switch_command<&ViewSettings::Look::worn>("worn", "", "Look",
                                              "clothes, eyes and what else is attached to the skin"),
};

}  // namespace

std::span<const Command> look_commands() { return kLookCommands; }

}  // namespace bodyopt
