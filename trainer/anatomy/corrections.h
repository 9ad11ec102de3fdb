// What an artist corrects of an anatomy: a small file beside the character, which changes nothing else.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "runtime/basis/skeleton.h"
#include "trainer/anatomy/body_kind.h"

namespace bodyopt {

struct AnatomyCorrections {
  struct OfBone {
    std::optional<bool> carries;  // do bones move with the joint? none: as found
    double thicker = 0;           // metres, on all sides of those
  };
  struct OfMuscle {
    double volume = 0;  // cubic metres of one side; 0: as the tables have it
    double factor = 1;  // of that
  };

  std::optional<BodyKind> kind;
  std::optional<double> body_fat;
  std::map<std::string, OfBone> bones;                  // by joint
  std::map<std::string, double> region_fat, joint_fat;  // factors of the fat's pattern, by BodyRegion's names, by joint
  std::map<std::string, OfMuscle> muscles;              // by name

  OfBone of_bone(const std::string& joint) const;
};

// anatomy.json. Throws Error(file) for bad bytes, Error(mismatch) for joints the skeleton lacks.
AnatomyCorrections read_corrections(const std::filesystem::path& path, const Skeleton& skeleton);

}  // namespace bodyopt
