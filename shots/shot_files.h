// A shot as it is asked for: by files and numbers, as options of `eval`, a session and the list of a show name them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/levels.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/weights.h"
#include "shots/clip_choice.h"
#include "shots/session/view_settings.h"
#include "shots/shot.h"

namespace bodyopt::shots {

// Opens what the viewport can show: a trained basis, a character as it is, or the built-in arm.

struct OpenedCharacter {
  std::vector<Level> levels;           // finest first
  Attachments attached;                // of a character as it is: its own further meshes
  std::optional<Character> character;  // where it is at hand: a basis does not hold its skin weights
  std::optional<Clip> clip;            // its own, to begin with
  std::vector<std::string> notes;      // for the user, one sentence each
  std::string shown_by{};              // how it is shown, where nobody trained it: a sentence, and nothing is wrong
};

// `path`: a basis (.safetensors), or a character (.glb, .gltf, .fbx), which plays its first clip. Empty: the built-in
// arm with its muscles and its held-out motion. Both without a basis get Direct Delta Mush at once. No file is written.
// `options`: of the clip; the unit is also that of the character's file. Throws Error(file), Error(mismatch).
OpenedCharacter open_character(const std::string& path, const ClipOptions& options);

// Does the file hold a character rather than a clip for this skeleton? It has a skinned mesh, and no clip, or shares
// less than half of the smaller skeleton's joints, by name. Throws Error(file).
bool is_another_character(const std::string& path, const Skeleton& skeleton);

// The user's choices for the jiggle.
struct JiggleChoice {
  bool jiggle = false;
  std::string dynamics;                // empty: the file beside the basis
  std::string state_in;                // empty: it starts at rest
  std::string cuts;                    // a range of frames
  int preroll = 0;                     // frames
  std::vector<double> gravity_change;  // x, y, z, m/s^2, world; or empty

  // The dynamics; empty without jiggle.
  std::string file(const std::string& basis) const;
};

// The posing and files that a session gives its lead.
struct SessionPosing {
  std::string file;         // the session; empty: there is none
  std::string character{};  // the lead's own file, for the surface of its skin, where it is there and fits; or empty
  std::string like{};       // where that is not known, its clip's, for the same where it has the same skin; or empty
  std::string limits;       // of the joints; or empty
  ViewSettings::Posing pose{};
  std::optional<int> in{}, out{};  // ends of the range that it plays; otherwise the clip's
  bool jiggles = false;            // in the viewport
  float jiggle = 1;                // how much of it is shown
  double unit = 0;                 // metres per unit of a character that is no basis; 0: as its file says
};

struct ShotFiles {
  std::string basis;       // or, of a session, a character as it is; empty there: the built-in arm
  std::string character;   // its own file as somebody named it, for the surface of the skin; or empty
  bool is_rigged = false;  // the skin is written bound to its joints, by the weights of that file
  std::size_t level = 0;   // of detail, of a proxy; 0: the finest
  ClipChoice clip;         // without a source: the bind pose
  SessionPosing session;
  std::string modifiers;              // modifiers.json; or empty
  std::vector<std::string> controls;  // "NAME=VALUE" over the whole clip
  std::string attached;               // empty: the file beside the basis, where there is one
  JiggleChoice jiggle;
  DeviceChoice device;

  // A session may name a character without a trained basis; Direct Delta Mush then poses it.
  bool is_untrained() const;
  // Returns all files that decide the result.
  std::vector<std::filesystem::path> paths() const;
};

// The lead of a session with its clip, its posing and the range that it plays, in place of what `files` has of them.
// Throws Error(file).
void take_session(const std::string& session, ShotFiles& files);

// Opens the character, and keeps of its levels the one that is asked for. Throws Error(file), and Error(usage) for a
// level that is not there.
OpenedCharacter open_level(const ShotFiles& files);

// Reads the chosen clip. Otherwise takes the character's own, or the bind pose, as the viewport poses a lead that plays
// none. Throws as ClipChoice::read().
Clip read_own_clip(const ClipChoice& choice, const Basis& basis, std::optional<Clip> own);

// Numbers of the chosen frames; frames that the session does not play are left out. Throws Error(usage) for frames that
// the clip does not have, and where none are left.
std::vector<int> shot_frames(const ShotFiles& files, const ClipSpan& clip);

// Reads what is attached to the skin. `own`: what an untrained character brings along. Throws Error(file),
// Error(mismatch).
Attachments read_attachments(const ShotFiles& files, const Basis& basis, Attachments own);

// Says that the session's lead jiggles in the viewport and stays still in the shot; otherwise empty.
std::string missing_jiggle(const ShotFiles& files);

// Refuses to jiggle a session's lead that nobody trained. Throws Error(usage).
[[noreturn]] void refuse_jiggle(const std::string& session);

// Reads the surface from a character's own file that the user did not name; reports why where there is none.
SkinSurface surface_if_any(const std::string& character, const MeshTable& mesh, const Tell& tell);
// Each attached mesh gets the surface of the file's mesh with its name and triangles; empty: there is none.
std::vector<SkinSurface> attached_surfaces(const std::string& character, const Basis& basis,
                                           const Attachments& attached, const Tell& tell);

// Both, for a skin that is exported, from the character's own file. `like`: where that is empty, another file, which
// nothing is said of where it has another skin.
void take_surfaces(const std::string& own, const std::string& like, Shot& shot, const Tell& tell);

// Reads them. Throws Error(file), Error(mismatch), Error(device), and Error(usage) for frames, levels and controls that
// are not there.
Shot read_shot(const ShotFiles& files, const Tell& tell);

}  // namespace bodyopt::shots
