// Shapes that come from elsewhere (Houdini, Ziva, scans, sculpted corrections) into a dataset.
#pragma once

#include <filesystem>

#include "dataset/dataset.h"
#include "trainer/check/check.h"

namespace bodyopt::trainer {

struct AddedShapes {
  DatasetTake take;  // as the dataset has it now
  TakeCheck check;   // of the shapes given, by themselves
  int replaced = 0;  // of the frames given, those that the take had
};

// Copies the shapes of `source` into the dataset of `path` (its dataset.json; `begun` where there is none yet). Sample
// k is frame given.frames[k] of the take given.name, which is made where there is none. The take gets a new cache (PC2,
// by rising frame) beside dataset.json with the new frames, and its side-car, if any, is made anew. After them
// dataset.json is renamed into place, then the files it named before go. Frames that it has keep their shapes. The new
// ones lie in a modifier over them (put_shapes_over()), which can be undone; only damaged shapes are replaced. Killed
// at any moment, the dataset is the old one, the new one, or that without the modifier.
//
// Throws, with nothing changed, Error(mismatch) where the shapes do not belong to the character and the clip's frames
// or the take is of another motion. Throws Error(usage) for frames that it has already unless `replace`, Error(file),
// and Error(interrupted) after SIGINT.
AddedShapes add_shapes(const Dataset& begun, const std::filesystem::path& path, const DatasetTake& given,
                       const std::filesystem::path& source, bool replace);

}  // namespace bodyopt::trainer
