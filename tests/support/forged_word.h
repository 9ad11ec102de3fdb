// A word of a file's tables, replaced.
#pragma once

#include <random>
#include <string>

#include "runtime/basis/safetensors.h"

namespace bodyopt::testing {

// By the worst there are, or with one bit flipped. Returns the tensor's type and name and the word's place.
std::string forge_word(Safetensors& file, std::mt19937& random);

}  // namespace bodyopt::testing
