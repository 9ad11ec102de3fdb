// Values of one picture that panels read. They hold nothing that lives longer, and no panel computes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/host/stages.h"
#include "shots/session/pinned_joints.h"
#include "viewport/state/waveform.h"

namespace bodyopt::viewport {

struct JointRow {
  std::string name;
  int parent = -1;
  int depth = 0;                              // of the tree
  Vec3 low{-90, -90, -90}, high{90, 90, 90};  // of what is added to the clip in this frame, degrees
  double furthest = 0;                        // that a slider moves it, metres, either way; 0: it may not move
};

struct ControlRow {
  std::string name;
  double low = 0, high = 1;  // in training
  double usual = 0;          // where nothing sets it
  std::string modifier{};    // whose it is; empty: trained
  std::string what{};        // a line
};

struct AxisRow {
  std::string name, joint;   // of limits.json; the first joint that it turns
  double low = 0, high = 0;  // that may be added to the clip in this frame, degrees
};

struct ModifierRow {
  std::string name, type;
};

struct CharacterRow {
  std::string name, basis, clip, truth;
  std::uint32_t vertices = 0, triangles = 0, tets = 0;  // no tets: it does not jiggle
  std::uint64_t bytes = 0;                              // of the static tables
  std::string method{};                                 // that is shown
  bool wears = false;                                   // attached meshes
  std::size_t level = 0, level_count = 1;               // of detail
  int number = 1;                                       // by which commands name it
};

// How far the lead is from what it is compared with at a frame, mm; not a number: not measured, or nothing to measure.
struct ErrorRow {
  float rms = std::numeric_limits<float>::quiet_NaN(), max = rms;
  bool measured = false;
};

// Poses that another program sends.
struct LiveRow {
  std::optional<int> frame{};  // of the newest; none: nothing has come
  std::size_t rejected = 0;
  std::string last_rejection{};
};

// A frame of a dataset in the map of poses.
struct PoseDot {
  float x = 0, y = 0;                                    // from -1 to 1
  float heat = std::numeric_limits<float>::quiet_NaN();  // from 0 to 1; not a number: not known
  std::string text;                                      // "rom 12"
};

// A modifier of the dataset's stack.
struct StackRow {
  std::string name, type;
  bool enabled = true;
  double strength = 1;
};

// The dataset whose frames are looked at.
struct CurationRow {
  std::string region;         // of the map
  std::vector<PoseDot> dots;  // of every frame of the clip
  std::string legend;         // what the hottest colour is
  std::vector<StackRow> modifiers;
  std::vector<std::string> pairs;  // that disagree most; none: they were not looked for
};

// The skin that a joint of the lead holds, and the same of the second of the cast; see TransferPart.
struct MatchedPartRow {
  std::string joint;
  double confidence = 1, size = 1, unevenness = 0;
  bool is_guess = false;  // another anatomy
};

// How the lead and the second of the cast match.
struct MatchRow {
  bool same_topology = false;
  double confidence = 1, size = 1;    // mean; of the second over the lead
  std::vector<MatchedPartRow> parts;  // least sure first
  // The volumes of the two skins at the frame, over those at rest; none: it plays.
  std::optional<std::array<double, 2>> volumes{};
  std::string to_simulate{};  // frames of what the second plays that would teach it most; empty: not known
};

// A tissue as a section shows it.
struct TissueRow {
  std::string name;
  std::array<std::uint8_t, 3> colour;  // sRGB
};

// The section through the lead.
struct SectionRow {
  bool is_ready = false;  // what lies inside was found
  std::vector<TissueRow> tissues{};
  std::string under_mouse{};  // empty: none is
};

struct Snapshot {
  std::vector<CharacterRow> cast;  // the first is the lead, of whom the rest speaks
  std::vector<JointRow> joints;
  std::vector<AxisRow> axes;
  std::vector<shots::MissedPin> missed_pins;
  std::vector<ControlRow> controls;
  std::vector<ModifierRow> modifiers;  // in the order in which they are applied
  std::vector<std::string> fibres;
  std::vector<float> strains;               // of the fibres
  float outside = 0;                        // standard deviations beyond what was trained; 0: covered
  std::string outside_feature, outside_by;  // which, and how far
  bool knows_coverage = false;
  std::optional<double> expected_mm, most_expected_mm;  // error, where coverage is looked at: RMS, of a vertex
  double clip_fps = 24;
  std::size_t level = 0, level_count = 1;  // of detail

  std::vector<std::string> comparisons;  // with what it can be compared
  std::string compared;                  // with what it is; empty: nothing
  int first_frame = 1;                   // of the clip
  std::vector<ErrorRow> errors;          // per frame of the clip; empty where nothing is compared
  std::size_t measured = 0;              // how many of them
  std::optional<std::size_t> worst;      // index of the largest

  std::shared_ptr<const Waveform> waveform;  // null: there is no sound
  std::optional<CurationRow> curation;       // none: no dataset is open
  std::optional<LiveRow> live;               // none: the clip is shown
  std::optional<MatchRow> match;             // none: nobody asked for it

  bool has_character = false;         // its weights are at hand, so that its inside can be found
  std::optional<SectionRow> section;  // none: it is not asked for

  std::string device;
  double shown_fps = 0;              // pictures a second, over the last second
  double frame_ms = 0, draw_ms = 0;  // of the host: the whole picture; of the device: drawing
  StageSeconds stage_seconds;        // of the picture, summed over the cast
  double memory_mib = 0;             // resident
};

}  // namespace bodyopt::viewport
