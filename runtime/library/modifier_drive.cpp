#include "runtime/library/modifier_drive.h"

#include <utility>

#include "runtime/library/guard.h"

namespace bodyopt {

ModifierDrive::ModifierDrive(const bodyopt_instance& instance, const GivenPoses& given)
    : basis_(instance.deformer->basis()), names_(instance.channels), given_(given) {
  if (given.goes_on()) state_ = instance.modifiers;
}

void ModifierDrive::apply(std::size_t begin, std::span<Pose> poses) {
  if (!given_.shows_modifiers()) return;
  // Modifiers find their channels where a clip has all of its controls; what was learned has its own there after them.
  std::vector<std::vector<float>> controls;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    controls.push_back(std::exchange(poses[f].controls, given_.read_channels(begin + f)));
  }
  const std::span<const std::string> names = given_.has_channels() ? names_ : std::span<const std::string>();
  for (const std::string& note : drive_modifiers(basis_, names, given_.frames_per_second(), poses, &state_)) {
    write_log(BODYOPT_LOG_WARNING, note.c_str());
  }
  for (std::size_t f = 0; f < poses.size(); ++f) poses[f].controls = std::move(controls[f]);
}

void ModifierDrive::keep(bodyopt_instance& instance) const {
  if (given_.shows_modifiers()) instance.modifiers = state_;
}

}  // namespace bodyopt
