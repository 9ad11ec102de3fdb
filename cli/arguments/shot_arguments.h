// The options of `eval` for skin that jiggles, with the state files between chunks of a shot.
#pragma once

#include <optional>
#include <string>

#include "cli/arguments/common.h"
#include "shots/shot_files.h"

namespace bodyopt::cli {

struct JiggleArguments {
  std::string state_out;  // empty: no state is written
  int state_every = 0;    // frames; 0: at the end alone

  void add(CLI::App& verb, JiggleChoice& choice);
  // Throws Error(usage) for options that do not go together or need --jiggle.
  void check(const JiggleChoice& choice) const;
  // Writes the state where one is due: after `done` frames, and, once the result is written, at the end. Returns its
  // file.
  std::optional<std::string> write_state_after(const Deformer& deformer, std::size_t done) const;
  std::optional<std::string> write_last_state(const Deformer& deformer) const;
};

// --modifiers FILE, --control NAME=VALUE
void add_modifier_options(CLI::App& verb, ShotFiles& files);

}  // namespace bodyopt::cli
