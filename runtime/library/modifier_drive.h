// Applies modifiers to the poses of a call, and goes on from one call of an instance to the next.
#pragma once

#include <span>
#include <string>

#include "runtime/library/handles.h"
#include "runtime/library/strides.h"

namespace bodyopt {

class ModifierDrive {
 public:
  // Both must outlive it.
  ModifierDrive(const bodyopt_instance& instance, const GivenPoses& given);

  // `poses`: frames `begin` and after of the call, which follow those of the time before. Nothing where the call shows
  // no modifiers. Throws as drive_modifiers().
  void apply(std::size_t begin, std::span<Pose> poses);
  // All frames are shown: the instance goes on from here.
  void keep(bodyopt_instance& instance) const;

 private:
  const Basis& basis_;
  std::span<const std::string> names_;
  const GivenPoses& given_;
  ModifierState state_;
};

}  // namespace bodyopt
