// The animator's controls. Keys, menus, panels, scripts and command lines all write here; the application reads it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geometry/brush.h"
#include "shots/session/view_settings.h"
#include "viewport/state/file_dialog.h"
#include "viewport/state/orbit_camera.h"
#include "viewport/state/playback.h"
#include "viewport/state/pose_history.h"
#include "viewport/state/pose_library.h"

namespace bodyopt::viewport {

// The values that colour the map of poses.
enum class MapColour { coverage, contradiction, error, sculpt, weight };
inline constexpr std::array kMapColourNames{"coverage", "contradiction", "error", "sculpt", "weight"};

// The brush with which the mouse edits the skin of the dataset that is looked at.
struct BrushInHand {
  std::optional<BrushKind> kind;  // none: it turns the view
  double radius_mm = 50, strength = 0.5;
  bool symmetric = false;          // does the same on the other side of the body
  std::optional<double> spread{};  // degrees; none: what the modifier has
  std::string modifier = "brush";  // that takes the strokes
};

// Points of the picture, as shares of its width and height from the left top corner.
using PicturePath = std::vector<std::array<double, 2>>;

// A change to a modifier of the dataset that is looked at; what is not set stays.
struct ModifierEdit {
  std::string name;
  std::optional<bool> enabled{};
  std::optional<double> strength{};
  bool operator==(const ModifierEdit&) const = default;
};

// Two frames of like poses whose shapes disagree most in a region.
struct ListedPair {
  int first, second;
  std::string region;
};

// How a dataset is looked at.
struct Curating {
  std::string region;  // of the map
  MapColour colour = MapColour::coverage;
  bool raw = false;                             // shapes before any modifier
  std::vector<std::string> regions, modifiers;  // what commands may name; none: no dataset is open
  std::vector<std::string> frames;              // of the clip's frames, what their takes call them: "rom 40"
  bool compared = false;                        // pairs were looked for
  std::vector<ListedPair> pairs;                // the worst first
  int pair = -1;                                // that is looked at, from 0
};

// A vertex of the lead's skin, and the one of the second of the cast that is the same; output vertices.
struct MarkedPair {
  std::uint32_t of_lead = 0, of_second = 0;
  bool operator==(const MarkedPair&) const = default;
};

// Points of two skins that are the same, as a transfer from the lead to the second of the cast takes them.
struct Marking {
  bool on = false;  // clicks mark
  std::vector<MarkedPair> pairs;
  std::optional<std::uint32_t> of_lead;  // marked, its other to come
};

// The end of a limb that is to stay; without a point: where it is.
struct PinRequest {
  std::string joint;
  std::optional<Vec3> at{};  // metres, world
  bool operator==(const PinRequest&) const = default;
};

// The program whose keys commands have; see key_of().
enum class Keymap { bodyopt, maya, blender };
inline constexpr std::array kKeymapNames{"bodyopt", "maya", "blender"};

// The handles that drag the selected joint: arrows and rings, or those of one kind.
enum class Tool { all, move, turn };

// The handle of the selected joint that the mouse holds: its pin, itself, or a ring or arrow by its axis.
struct Grip {
  enum class Kind { pin, joint, ring, arrow } kind = Kind::pin;
  std::size_t axis = 0;  // x, y, z
};

// A pose of a file, blended into that in hand.
struct PoseRequest {
  std::string file;
  double amount = 1;  // 0: as it is
  bool operator==(const PoseRequest&) const = default;
};

// A pose that was copied, whole or what some joints have of it.
struct CopiedPose {
  shots::ViewSettings::PoseKey pose;
  std::vector<std::string> joints;  // none: all of it
};

// Asked for, and done by the application once a picture is drawn.
struct Requests {
  bool quit = false, reload = false, frame_selection = false, reset_jiggle = false;
  bool worst_frame = false, worst_vertex = false;
  bool keep_framed = false;  // what was framed is to be seen whole from another side, too
  bool frame_range = false;  // the camera is to see all that is played
  bool same_clip = false;    // all are to play the lead's
  std::optional<std::string> screenshot, turntable, sequence, save, save_state, load_state, save_markers;  // file names
  std::vector<std::string> open, add;  // files, by what they hold; characters, whatever else they are
  std::optional<double> unit;          // metres
  bool keep_keymap = false;            // for the viewports that follow
  std::vector<ModifierEdit> edits;
  std::optional<PinRequest> pin;
  std::optional<bool> step_back;      // in the history of edits, or forth
  bool contradictions = false;        // are looked for
  std::optional<PicturePath> stroke;  // of the brush in hand
  bool keep_strokes = false;
  std::optional<int> lead, remove;                      // characters, counted from 1
  std::optional<std::string> export_clip, export_skin;  // file names
  std::optional<bool> recover;                          // the autosave of a viewport that ended, or discard it
  std::optional<std::string> save_pose, limits;         // file names
  std::optional<PoseRequest> load_pose;
  std::optional<shots::SoundFile> sound;  // to be read
  bool operator==(const Requests&) const = default;
};

// A point of the picture, for as long as its frame is shown.
struct Marker {
  int frame;
  Vec3 at;  // metres, world
};

// The text that is typed into panels, and the state of their lists.
struct PanelState {
  bool entered = false;  // what is typed, before its field hears
  std::string prompt, joint_filter, camera, open;
  std::string screenshot = "bodyopt.png", sequence = "bodyopt.####.png", turntable = "turntable.####.png";
  std::string session = "session.json", state = "view.json", clip = "posed.glb", skin = "posed.pc2";
  std::string listed_joint;              // to which the list of joints was last scrolled
  std::string revealed_section;          // to which the side panel is to be scrolled
  std::vector<std::size_t> fibre_order;  // of the list of muscles
  std::string dragged_modifier;          // whose strength is being dragged
  std::optional<double> dragged_strength{};
  double tween = 0.5;
  std::optional<double> curve_value{};                        // of the curve's key that the mouse holds, before
  std::array<double, 2> curve_scale{};                        // the lowest and highest value of the curves
  std::optional<shots::ViewSettings::PoseKey> pose_before{};  // one of the library was in hand
  std::optional<double> pose_share{};                         // of it, by the mouse
};

struct Message {
  bool error = false;  // stays five times as long
  std::string text;
  double shown = 0;  // seconds
};

struct Controls {
  shots::ViewSettings settings;
  PoseHistory poses;  // of the settings
  Playback playback{{1, 1}, 24};
  OrbitCamera camera;
  Marking marking;
  std::vector<std::uint32_t> output_counts;  // of the cast: vertices that can be marked
  std::vector<shots::Placement> placements;  // of the cast, in its order; the lead's waits until another leads
  std::vector<int> cast_numbers;             // of the cast, in its order: each keeps its own, whoever leads or goes
  Vec3 travelled{};  // metres, world: how far the lead has gone since its clip's first frame, in the last picture
  std::vector<std::string> joint_names, axis_names, control_names;  // of the lead: what commands may name
  std::vector<std::string> movable_names, axis_joints;  // of the lead: joints that may move; of each axis the first
  std::vector<bool> axes_flip;                          // by axis: whether its turn is the other way about in a mirror
  std::vector<Quat> joint_axes;                         // of the lead's joints in the bind pose, joint to world
  // Why a command has nothing to show ("compare lbs", "jiggle on"), and what would help; by what is refused.
  std::map<std::string, std::string> missing;
  std::optional<bool> live;  // poses are shown as they are sent; none: nobody listens
  Curating curating;
  BrushInHand brush;
  std::string joint;           // selected; empty: none
  std::set<std::string> also;  // selected beside it
  std::optional<CopiedPose> copied;
  Keymap keymap = Keymap::bodyopt;
  Tool tool = Tool::all;
  bool auto_key = false;           // what is posed is a key at once
  bool dope_sheet = false;         // all keys are shown under the timeline, as wide as it
  bool curves = false;             // of keys, in place of their lines
  bool zooms = false;              // the timeline shows the range alone
  std::optional<int> keyed_frame;  // that the pose in hand is of
  shots::ImagePlaneFile image_plane;
  shots::SoundFile sound;
  std::vector<ClipCamera> file_cameras;  // of the lead's clip and character
  std::optional<int> shot_frame;  // that the view is of, as the shot's camera had it; none: it is to be looked through
  bool flipped = false;           // while the key of "hold to flip" is down
  bool cheat_sheet = false;
  bool panels = true;
  bool takes_series = false;               // pictures are taken one after the other: no handles are drawn
  bool headless = false;                   // nobody looks: what fails is thrown, and what is asked for is waited for
  bool prompt = false;                     // a command is being typed
  bool scripted = false;                   // a script runs: nobody is asked
  std::function<bool()> has_unsaved_work;  // poses, keys, cameras or markers that are in no session file
  std::function<double(int)> root_x;       // metres, world: where the lead's root stands in a frame of its clip
  bool asks_to_save = false;               // it is asked whether they shall be saved
  bool quits_when_saved = false;
  std::string session_file;         // that was opened or saved last; empty: none
  std::vector<std::string> recent;  // files that were open lately, the last first
  std::string recoverable;          // a session that a crash left; empty: none
  std::string recoverable_what;     // it is: whose, and from when
  std::string folder = ".";         // in which files are chosen: the last one was in
  std::string pose_folder;          // where the last pose was saved or loaded; empty: as `folder`
  PoseLibrary pose_library;         // of it, where its section is open
  std::optional<FileDialog> dialog;
  std::optional<Marker> marker;
  std::optional<Grip> grip;
  double automatic_heat_mm = 10;  // of the hottest colour, where the settings give none
  PanelState typed;
  Requests requests;
  std::vector<Message> messages;  // newest last

  // Cameras are kept without the lead's way: one that follows is kept as at the clip's first frame, and goes back so.
  shots::OrbitView kept_camera() const;
  void go_to_camera(const shots::OrbitView& kept);
  // Looking through the shot's camera, the view becomes that camera's once the frame is another: until then it is free.
  void follow_shot_camera();

  // Returns the pose at a frame: in hand at the frame that is shown, by the keys at others.
  shots::ViewSettings::Posing posing_at(int frame) const;
  // With keys, the pose in hand becomes that of the keys, once the frame that is shown is another.
  void follow_keys();
  // Whether the pose in hand differs from the keys, where there are any, and is lost with the frame.
  bool is_unkeyed() const;

  void select(const std::string& name);  // it alone; empty: none
  // Returns several selected joints, the first first; none: one or none is selected, and the pose is one thing.
  std::vector<std::string> selected() const;
  // Sets a key at the frame whose pose is in hand, where the pose differs and keys are set by themselves.
  void key_by_itself();
  // Whether the joint is turned or moved on top of the clip in the pose in hand.
  bool is_posed(const std::string& name) const;

  // Whether the layout "hold" shows the other side of the comparison: while the key is down. With a brush in hand that
  // side is what is brushed, and the key shows the first.
  bool shows_compared() const { return flipped != brush.kind.has_value(); }

  // The place in the cast of the one with that number. Throws Error(usage) where there is none.
  std::size_t cast_place(int number) const;

  const std::string& shown_pose_folder() const { return pose_folder.empty() ? folder : pose_folder; }
  // Asks for a command's file.
  void browse(const std::string& command);
  // Quits at once, or, where somebody would lose something, after asking.
  void quit_or_ask();

  double heat_mm() const { return settings.compare.heat_scale_mm.value_or(automatic_heat_mm); }
  void say(const std::string& text) { messages.push_back({.text = text}); }
  // Warns in the window and on standard error; a text is not repeated right after itself.
  void warn(const std::string& text);
  // Reports what the action throws, except Error(device), after which nothing can be drawn. Headless, all is thrown.
  void attempt(const std::function<void()>& action);
};

}  // namespace bodyopt::viewport
