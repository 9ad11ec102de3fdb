// What panels read: plain values of one picture. They hold nothing that lives longer, and no panel computes.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "runtime/basis/transform.h"

namespace bodyopt {

struct JointRow {
  std::string name;
  int parent = -1;
  int depth = 0;                                    // of the tree
  Vec3 low{-180, -180, -180}, high{180, 180, 180};  // limits of what is added to the clip, degrees
};

struct CharacterRow {
  std::string name, basis, clip, truth;
  std::uint32_t vertices = 0, triangles = 0;
  std::uint64_t bytes = 0;  // of the static tables
  bool jiggles = false;
};

struct Snapshot {
  std::vector<CharacterRow> cast;  // the first is the lead, of whom the rest speaks
  std::vector<JointRow> joints;
  std::vector<std::string> controls, fibres;
  std::vector<float> strains;  // of the fibres
  float outside = 0;           // standard deviations beyond what was trained; 0: covered
  std::string outside_feature;
  double clip_fps = 24;
  std::size_t level = 0, level_count = 1;  // of detail
  std::vector<float>
      error_mm;  // per frame of the clip, RMS to what it is compared with; not a number: not yet measured

  std::string device;
  double shown_fps = 0;                    // pictures a second, over the last second
  double frame_ms = 0, draw_ms = 0;        // of the host: the whole picture; of the device: drawing
  std::map<std::string, double> stage_ms;  // rig, strain, residual, pose, diffuse, jiggle, output
  double memory_mib = 0;                   // resident
};

}  // namespace bodyopt
