// Everything that is open: the characters, their files and their settings, as panels and pictures read it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "shots/session/session_file.h"
#include "viewport/brushing.h"
#include "viewport/commands/controls.h"
#include "viewport/curation.h"
#include "viewport/framing.h"
#include "viewport/image_plane.h"
#include "viewport/matching.h"
#include "viewport/panels/snapshot.h"
#include "viewport/platform/live_pose.h"
#include "viewport/platform/watched_files.h"
#include "viewport/scene/scene.h"
#include "viewport/sectioning.h"
#include "viewport/viewer.h"

namespace bodyopt::viewport {

class Session {
 public:
  Session(std::shared_ptr<const vulkan::Device> device, const ViewerOptions& options);

  Scene scene;
  Controls controls;
  Snapshot snapshot;
  Framing framing{scene, controls};
  Curation curation;
  Brushing brushing{scene, controls, curation};
  Matching matching;
  Sectioning sectioning;
  ImagePlane image_plane;

  // Opens the first of the options' files, a basis or a character, or the built-in arm where there is none. Gives what
  // is to be said of it. Throws Error(usage), and as the readers do.
  std::vector<std::string> open_first();
  // Opens a basis or character; a clip or truth of the one that was opened or made the lead last; or a state. The
  // extension decides. What was there stays where it throws.
  std::vector<std::string> open(const std::string& file);
  // One more of the cast, whatever else the file holds.
  std::vector<std::string> open_character(const std::string& file);
  void use_unit(double metres);  // of files of characters; 0: as they say
  void open_truth(Actor& character, const std::string& file);
  // Take numbers of the cast, from 1 as the panel shows them. The playhead stays. Throw Error(usage) where there is no
  // such one, or no other.
  void make_lead(int number);
  void remove(int number);
  // Reads the characters again that any of the files belong to; the playhead stays, and goes on as it went. All stays
  // as it was where it throws.
  void reload(const std::vector<std::filesystem::path>& files);
  void use_sound(const shots::SoundFile& sound);  // no file: none. Throws Error(file)
  void use_limits(const std::string& file);       // of the lead; "none": it has none. Throws as the readers do
  void give_same_clip();                          // the lead's, to all
  // Returns files that have changed and are whole; `now`: seconds, of any clock.
  std::vector<std::filesystem::path> changed_files(double now) { return watched_.changed(now); }

  // Done to the stack of the dataset that is looked at; its shapes are read again. Throw Error(usage) where none is.
  void edit_stack(const ModifierEdit& edit);
  void step_stack(bool back);
  // Puts what was brushed, if anything, into the stack; it stays in hand where this throws.
  void keep_strokes();

  // Saves all that is open and set. Throws Error(file), and Error(usage) for a file that is open or no session.
  void save(const std::string& file);
  // Writes the same without a message. saved_as: of an autosave, the session's own file.
  void write(const std::string& file, const std::string& saved_as = "") const;
  // The user's work that could be lost: poses, keys, cameras and markers.
  struct Work {
    std::vector<shots::ViewSettings::Posing> posings;  // of those that are posed
    std::map<std::string, shots::OrbitView> cameras;
    shots::ViewSettings::ShotCamera shot_camera;
    shots::ImagePlaneFile image_plane;
    shots::SoundFile sound;
    std::vector<MarkedPair> markers;
    bool operator==(const Work&) const = default;
  };
  Work work() const;
  void save_state(const std::string& file);
  void load_state(const std::string& file);

  // Poses that another program sends, in place of the lead's clip for as long as they are wanted. Says on which port.
  // Throws as LivePose.
  void listen(std::uint16_t port);
  bool listens() const { return live_ != nullptr; }
  // The lead may be another: a pose of other joints is none of it. Where its poses do not fit a packet, nobody listens
  // any longer; throws as LivePose.
  void expect_poses_of_lead();
  // Takes the newest of the poses that came; whether there is something new to see.
  bool poll_live();

  // Applies the settings of a session that was opened, once; false: none was.
  bool restore_view();
  // Plays the lead's clip as it played before; a range that the clip lacks is reported, and forgotten.
  void play_clip();
  // Warns of truths whose place on their clips has changed since the last call.
  void warn_of_truth_times();

 private:
  bool is_character(const std::string& file) const;
  std::vector<std::string> add(shots::ActorFiles files);
  shots::ActorFiles files_of_dataset(const std::string& file);
  void open_session(const std::string& file);
  void replace_lead(const shots::ActorFiles& files);
  void use_settings(const shots::ViewSettings& settings);
  void read_dataset_again();
  void play_as(const shots::PlaySettings& settings);
  void number_cast();
  void pose_lead();
  void show_lead();
  void play_on();
  void forget_pair();  // one of the first two is another: markers and the match are of none now
  void describe_cast();
  void take_note_of_cast();  // of what is open, and of its files
  void warn_of_rates();
  void require_shot_camera();
  void watch() { watched_ = WatchedFiles(scene.paths()); }

  const ViewerOptions& options_;
  ClipOptions clip_options_;  // its unit: of a dataset, where one is opened
  const std::string device_name_;
  WatchedFiles watched_;
  std::unique_ptr<LivePose> live_;            // none: nobody listens
  std::optional<shots::SessionFile> opened_;  // whose view is not restored yet
  std::size_t receiver_ = 0;                  // of clips and caches, in the cast
  std::set<std::string> truth_times_;         // what was said of them
};

}  // namespace bodyopt::viewport
