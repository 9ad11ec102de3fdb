// Everything that is open in the viewport and set there, as a file (docs/formats.md, session.json).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "shots/session/view_settings.h"

namespace bodyopt::shots {

// The files of a character as the viewport and sessions name them.

// Is the path that of a basis, with files that belong to it beside it?
bool is_basis(const std::string& path);

// The files of a character; what is empty is none. Dynamics, attached geometry and, where no other is named, a proxy:
// those beside a trained basis, where there are any.
struct ActorFiles {
  std::string basis;  // see open_character()
  std::string clip{}, truth{}, proxy{};
  std::string character{};  // for linear blending
  std::string limits{};     // of its joints
  std::string muscles{};    // for its section
  std::string joint_map{};  // of its clips
  std::string up{};         // of those that are BVH, as ClipOptions

  std::filesystem::path dynamics() const;
  std::filesystem::path attached() const;
  std::filesystem::path levels() const;                // the proxy; empty: none, and none can be there
  std::string up_of(const std::string& source) const;  // `up` where the clip's source is a BVH
  // `character`, what a character as it is was read from, or what has a trained basis' name beside it; empty: it is not
  // known.
  std::string own_file() const;
  // Returns all files to be watched, those beside the basis whether they are there or not.
  std::vector<std::filesystem::path> paths() const;
};

struct SessionCharacter {
  ActorFiles files;
  ViewSettings::Posing pose{};  // of the lead it is that of the view
  Placement placement{};        // while it is not the lead
  int number = 0;               // as commands name it; 0: by its place in the list
};

struct SessionFile {
  ClipOptions clip;                    // of it the fps and the unit
  std::vector<SessionCharacter> cast;  // the first is the lead
  int frame = 1;                       // shown
  std::string joint;                   // selected; empty: none
  std::string saved_as;                // of an autosave: the session's own file; empty: none yet
  ViewSettings view;
  ImagePlaneFile image_plane{};
  SoundFile sound{};
};

// Is it a session rather than a state? False where it cannot be read.
bool is_session(const std::string& file);

// Sessions keep paths within their folder, or relative to where the program runs, relative to the folder. So both can
// be moved together. Paths that are read lead from where the program runs. Throw Error(file).
SessionFile read_session(const std::filesystem::path& path);
void write_session(const SessionFile& session, const std::filesystem::path& path);

}  // namespace bodyopt::shots
