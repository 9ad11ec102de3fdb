// What is set on top of the clip, before it was changed, step by step.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "shots/session/view_settings.h"

namespace bodyopt {

class PoseHistory {
 public:
  static constexpr std::size_t kMostSteps = 100;  // the oldest are forgotten

  // Of another pose, which has no step before it.
  void begin(const ViewSettings::Posing& now);
  // Where it has changed since, that is a step; what was undone is forgotten then.
  void note(const ViewSettings::Posing& now);

  // The keys show another pose at another frame: that is no step.
  void follow(const ViewSettings::Posing& now);

  // A step back or forth from what is now. False where there is none.
  bool undo(ViewSettings::Posing& now);
  bool redo(ViewSettings::Posing& now);

 private:
  struct Step {
    ViewSettings::PoseKey pose;
    std::map<int, ViewSettings::PoseKey> keys;
    bool operator==(const Step&) const = default;
  };

  static void show(const Step& step, ViewSettings::Posing& now);

  std::vector<Step> steps_ = {{}};  // oldest first
  std::size_t at_ = 0;              // that is shown
};

}  // namespace bodyopt
