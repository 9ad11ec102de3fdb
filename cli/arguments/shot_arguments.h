// The options of verbs that show a basis with its modifiers, and of `eval` for skin that jiggles, with the state files
// between chunks of a shot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/arguments/common.h"

namespace bodyopt {
class Deformer;
}  // namespace bodyopt

namespace bodyopt::cli {

struct JiggleArguments {
  bool jiggle = false;
  std::string dynamics, state_in, state_out, cuts;
  int state_every = 0;  // frames; 0: at the end alone
  int preroll = 0;      // frames
  std::vector<double> gravity_change;

  void add(CLI::App& verb);
  // Throws Error(usage) for options that do not go together or need --jiggle.
  void check() const;
  // A deformer with the dynamics beside the basis file (BASIS with .dynamics before .safetensors), or those named; it
  // starts from --state-in. Without --jiggle a quasi-static one. `loaded`: of that file.
  std::unique_ptr<Deformer> deformer(Basis loaded, const std::string& basis, const DeviceChoice& device) const;
  // The dynamics that deformer() loads; empty without --jiggle.
  std::string file(const std::string& basis) const;
  // Throws Error(mismatch) when the clip has another rate than the dynamics, Error(usage) when the frames begin before
  // the state that was read, or are not in order.
  void check_frames(const Deformer& deformer, const Clip& clip, const std::vector<int>& frames) const;
  // Steps the frames of the clip before the first that the options ask for. Shows progress.
  void preroll_to(const Clip& clip, const std::vector<int>& frames, Deformer& deformer) const;
  // Writes the state where one is due: after `done` frames, and, once the result is written, at the end. Returns its
  // file.
  std::optional<std::string> write_state_after(const Deformer& deformer, std::size_t done) const;
  std::optional<std::string> write_last_state(const Deformer& deformer) const;
};

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
