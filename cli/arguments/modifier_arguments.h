// The options of verbs that show a basis with its modifiers.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/common.h"

namespace bodyopt::cli {

// --modifiers FILE, --control NAME=VALUE
struct ModifierArguments {
  std::string file;
  std::vector<std::string> settings;

  void add(CLI::App& verb);
  // Lets the file choose of the basis' modifiers. Throws as choose_modifiers.
  void choose(Basis& basis) const;
  // Sets the controls that are named, and applies the modifiers to the clip. Says what there is to say. Throws
  // Error(usage) for controls that the basis does not have.
  void apply(const Basis& basis, Clip& clip) const;
};

}  // namespace bodyopt::cli
