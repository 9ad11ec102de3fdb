// Everything that can be set in the viewport, and its state file (docs/formats.md, view.json).
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt::shots {

// A camera that goes around a point, as a session keeps it.

struct OrbitView {
  static constexpr double kNearest = 0.01, kFarthest = 1e5;  // metres, of the distance
  static constexpr double kNarrowest = 1e-3, kWidest = 3;    // radians, of the vertical angle

  Vec3 target{0, 0, 0};                   // metres, world
  double distance = 3;                    // metres, from the eye to the target
  double azimuth = 0;                     // radians: 0 from the front (+z), pi / 2 from the character's left (+x)
  double elevation = 0;                   // radians above the horizon
  bool orthographic = false;              // at the target things look as large as in perspective
  bool cut_away = false;                  // what stands before the target is cut away
  double roll = 0;                        // radians that the camera turns about where it looks, to its left
  double vertical_angle = double{0.45f};  // that it sees, radians

  bool operator==(const OrbitView&) const = default;
};

// How frames of a clip are played, as a session keeps it.

enum class PlayMode { loop, ping_pong, once };

struct PlaySettings {
  static constexpr double kSlowest = 0.1, kFastest = 2;  // speeds

  PlayMode mode = PlayMode::loop;
  double speed = 1;
  bool backwards = false, real_time = true;
  std::optional<int> in, out;  // frames; the clip's first and last where they are left out
  bool operator==(const PlaySettings&) const = default;
};

enum class KeyEase { smooth, linear, step, spline };  // from a key to the next; see between_keys.h
enum class LookStyle { clay, material, matcap, flat, normals, silhouette };
enum class CompareWith { none, lbs, ddm, linear, full, jiggle, truth, proxy };
enum class CompareLayout { side_by_side, overlay, wipe, hold };
enum class MatchView { none, colours, confidence };
enum class SectionAxis { x, y, z };

// A camera that is keyed at a frame.
struct CameraKey : OrbitView {
  KeyEase ease = KeyEase::smooth;  // to the next; step: a cut
  bool operator==(const CameraKey&) const = default;
};

// Names in commands, panels and the state file, in the order of the enumerations.
inline constexpr std::array kPlayModeNames{"loop", "ping-pong", "once"};
inline constexpr std::array kKeyEaseNames{"smooth", "linear", "step", "spline"};
inline constexpr std::array kStyleNames{"clay", "material", "matcap", "flat", "normals", "silhouette"};
inline constexpr std::array kComparisonNames{"none", "lbs", "ddm", "linear", "full", "jiggle", "truth", "proxy"};
inline constexpr std::array kLayoutNames{"side-by-side", "overlay", "wipe", "hold"};
inline constexpr std::array kMatchNames{"none", "colours", "confidence"};
inline constexpr std::array kSectionAxisNames{"x", "y", "z"};

struct ViewSettings {
  // The camera of the shot.
  struct ShotCamera {
    bool look_through = true;       // frames are seen by it, where there is one
    std::string of_file;            // of the lead's clip or character, by name; empty: the one that is keyed
    std::map<int, CameraKey> keys;  // by frame, as cameras are kept
    bool operator==(const ShotCamera&) const = default;
  };

  struct Look {
    LookStyle style = LookStyle::material;
    bool wire = false, grid = true, axes = true, skeleton = false, fibres = false, tets = false;
    double tet_cut = 0.5;                       // share of the tets that is cut away, from the front
    bool anatomy = false;                       // the lead cut open by a plane that shows its tissues
    SectionAxis anatomy_axis = SectionAxis::y;  // of the world, that the plane is across
    double anatomy_at = 0.5;                    // of its skin's extent along that, from the lowest
    bool shadow = true;
    bool worn = true;          // clothes, eyes: what is attached to the skin
    bool follow = true;        // the camera goes along with the character
    std::optional<int> level;  // of detail, 0 the finest; otherwise the one that keeps up
    bool operator==(const Look&) const = default;
  };

  struct Compare {
    CompareWith with = CompareWith::none;
    CompareLayout layout = CompareLayout::side_by_side;
    double wipe = 0.5;  // where, of the picture's width
    bool heat = false;
    std::optional<double> heat_scale_mm;  // the hottest colour; otherwise as the errors of the frame are
    bool activation = false, coverage = false;
    MatchView match = MatchView::none;  // of the lead with the second of the cast
    bool operator==(const Compare&) const = default;
  };

  // What a pose sets on top of the clip.
  struct PoseKey {
    std::map<std::string, Vec3> joints{};  // Euler angles about x, y, z in degrees, by joint
    std::map<std::string, double> axes{};  // degrees, by the name of a degree of freedom of limits.json
    std::map<std::string, double> controls{};
    std::map<std::string, Vec3> pins{};      // where ends of limbs are held, metres, world, by joint
    std::map<std::string, Vec3> moves{};     // along the world's axes, metres, by joint
    std::map<std::string, Vec3> facing{};    // of pinned ends, without what turns them here, degrees, world, by joint
    KeyEase ease = KeyEase::smooth;          // smooth: slow at this key and at the next
    std::map<std::string, KeyEase> eases{};  // in its place: of joints, axes and controls
    bool operator==(const PoseKey&) const = default;
  };

  struct Posing : PoseKey {
    double correction = 1;        // of what is learned; 0: none of it
    std::map<int, PoseKey> keys;  // by frame; none: the pose is of all frames, otherwise of the frame that is shown
    bool operator==(const Posing&) const = default;
  };

  struct Jiggling {
    bool on = false;
    double amount = 1;
    bool operator==(const Jiggling&) const = default;
  };

  struct Ghosts {
    int before = 0, after = 0;  // how many
    int step = 1;               // frames from one to the next
    double opacity = 0.3;
    bool trail = false;  // of the joints that are selected
    bool operator==(const Ghosts&) const = default;
  };

  struct Cast {
    int copies = 1;  // of the lead on the stage
    int delay = 8;   // frames from one to the next
    bool operator==(const Cast&) const = default;
  };

  struct Hud {
    bool on = true;                      // figures
    bool legend = true;                  // what the sides of a comparison and the colours of a heat map are
    std::map<std::string, bool> panels;  // whether they are open, by name
    bool operator==(const Hud&) const = default;
  };

  // The file's values: Playback and OrbitCamera hold those by which the viewport plays and looks.
  PlaySettings playback;
  OrbitView camera;
  std::map<std::string, OrbitView> cameras;  // saved, by name
  ShotCamera shot_camera;
  Look look;
  Compare compare;
  Posing pose;
  Jiggling jiggle;
  Ghosts ghosts;
  Cast cast;
  Hud hud;

  bool operator==(const ViewSettings&) const = default;
};

// Returns what is set by a name, as joints and controls are; otherwise `usual`.
template <typename Value>
Value set_or(const std::map<std::string, Value>& set, const std::string& name, std::type_identity_t<Value> usual) {
  const auto found = set.find(name);
  return found == set.end() ? std::move(usual) : found->second;
}

inline constexpr const char* kViewSchema = "bodyopt-view-1";

// A setting that the file leaves out keeps its default. Throws Error(file).
ViewSettings read_view_settings(const std::filesystem::path& path);
// Checks what no single field can: names of sections, and that a range ends after it begins. Throws Error(file).
void require_good_settings(const ViewSettings& settings, const std::filesystem::path& path);
void write_view_settings(const ViewSettings& settings, const std::filesystem::path& path);  // throws Error(file)

// How far settings go: in commands, sliders and the state file alike.
inline constexpr int kMostGhosts = 12, kLongestGhostStep = 1000;    // either way; frames
inline constexpr int kMostCopies = 1000, kLongestCopyDelay = 1000;  // frames
inline constexpr int kCoarsestLevel = 15;
inline constexpr int kFurthestAhead = 100000;                      // frames, either way
inline constexpr double kMostJiggle = 4;                           // times what is simulated
inline constexpr double kFinestHeat = 0.01, kCoarsestHeat = 1000;  // mm, of the hottest colour
inline constexpr double kFinestBrush = 0.1, kWidestBrush = 1e4;    // mm, of its radius
inline constexpr double kWidestSpread = 360;                       // degrees, of what is brushed over poses
inline constexpr double kMostTurn = 360;                           // degrees, either way
inline constexpr double kFurthest = 1e6;                           // metres, of targets, pins and moves
inline constexpr double kMostControl = 1e6;                        // either way

// The sections of the side panel, and which are open: kept with the settings, by name.
struct Section {
  const char* name;   // "look": in settings and commands
  const char* title;  // "Look"
  bool open;          // to begin with
};

constexpr std::array<Section, 14> kSections = {{{"look", "Look", true},
                                                {"cameras", "Cameras", false},
                                                {"compare", "Compare", true},
                                                {"curate", "Curate", true},
                                                {"pose", "Pose", true},
                                                {"poses", "Poses", false},
                                                {"keys", "Keys", false},
                                                {"modifiers", "Modifiers", false},
                                                {"muscles", "Muscles", false},
                                                {"jiggle", "Jiggle", false},
                                                {"ghosts", "Ghosts", false},
                                                {"cast", "Cast", false},
                                                {"transfer", "Transfer", false},
                                                {"output", "Output", false}}};
constexpr const char* kSidePanel = "side";  // all of them

inline std::vector<std::string> section_names() {
  std::vector<std::string> names;
  for (const Section& section : kSections) names.emplace_back(section.name);
  return names;
}

inline bool is_open(const ViewSettings& settings, const Section& section) {
  return set_or(settings.hud.panels, section.name, section.open);
}

inline bool shows_side_panel(const ViewSettings& settings) { return set_or(settings.hud.panels, kSidePanel, true); }

// Closes the others.
inline void open_section(ViewSettings& settings, const std::string& name) {
  settings.hud.panels[kSidePanel] = true;
  for (const Section& section : kSections) settings.hud.panels[section.name] = section.name == name;
}

// An image behind the characters, or one for each frame where its name has #### or %04d.
struct ImagePlaneFile {
  std::string file{};  // empty: none
  double opacity = 1;
  bool operator==(const ImagePlaneFile&) const = default;
};

// A sound under the timeline.
struct SoundFile {
  std::string file{};  // empty: none
  int first = 1;       // the frame that it begins at
  bool operator==(const SoundFile&) const = default;
};

// The place and timing of one of the cast that is not the lead; a session keeps them.
struct Placement {
  std::optional<Vec3> at;  // where its root begins, its ground for the height, metres, world; none: where there is room
  std::optional<int> ahead;  // frames ahead of the lead, round and round in its own clip; none: frame by frame
  std::optional<int> level;  // of detail, 0 the finest; none: as its size in the picture asks
  bool operator==(const Placement&) const = default;
};

}  // namespace bodyopt::shots
