#include "cli/arguments/modifier_arguments.h"

#include "assets/shot_modifiers.h"
#include "runtime/core/error.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt::cli {

void ModifierArguments::add(CLI::App& verb) {
  const std::string group = "Modifiers";
  add_option(verb, "--modifiers", file, "FILE",
             "Order, switches, strengths and constants for this shot (modifiers.json)")
      ->group(group);
  add_option(verb, "--control", settings, "A control at one value over the clip: 'breath=0.5', 'breath.rate=20'")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(group);
}

void ModifierArguments::choose(Basis& basis) const {
  if (file.empty()) return;
  if (basis.modifiers.empty()) {
    throw Error(ErrorKind::mismatch,
                "the basis has no modifiers that " + file + " could choose of: give it some with 'bodyopt modifiers'");
  }
  choose_modifiers(file, basis.modifiers);
}

void ModifierArguments::apply(const Basis& basis, Clip& clip) const {
  std::vector<std::string> known = basis.residual.controls;
  for (const std::string& name : modifier_channels(basis.modifiers)) known.push_back(name);
  set_channels(settings, known, clip);
  say(apply_channels(basis, clip));
}

}  // namespace bodyopt::cli
