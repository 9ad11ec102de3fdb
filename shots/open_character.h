// What the viewport can show: a trained basis, a character as it is, or the built-in arm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/clip.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/levels.h"

namespace bodyopt {

struct OpenedCharacter {
  std::vector<Level> levels;           // finest first
  Attachments attached;                // of a character as it is: its own further meshes
  std::optional<Character> character;  // where it is at hand: a basis does not hold its skin weights
  std::optional<Clip> clip;            // its own, to begin with
  std::vector<std::string> notes;      // for the user, one sentence each
};

// `path`: a basis (.safetensors); a character (.glb, .gltf, .fbx), which gets Direct Delta Mush at once and plays its
// first clip; or nothing: the built-in arm with its muscles and its held-out motion, by Direct Delta Mush too. No file
// is written. `options`: of the clip; the unit is also that of the character's file. Throws Error(file),
// Error(mismatch).
OpenedCharacter open_character(const std::string& path, const ClipOptions& options);

// Does the file hold a character rather than a clip for this skeleton: a mesh with a skin, and no clip, or less than
// half of the joints of either skeleton in the other, by name? Throws Error(file).
bool is_another_character(const std::string& path, const Skeleton& skeleton);

}  // namespace bodyopt
