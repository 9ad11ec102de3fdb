// The files that modifiers name: caches in the dataset's folder modifiers/.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dataset/dataset.h"

namespace bodyopt {

// Samples (all of one size, points x 3) in a PC2 cache that is called "modifiers/OF-HASH.pc2" by what is in it. Returns
// its name, relative to the dataset's folder. Throws Error(file).
std::string keep_samples(const Dataset& dataset, const std::string& of, std::size_t count,
                         const std::function<std::vector<float>(std::size_t k)>& sample);

}  // namespace bodyopt
