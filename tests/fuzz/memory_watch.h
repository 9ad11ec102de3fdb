// How much memory a read takes at once: a small file that makes a program allocate gigabytes is an attack.
#pragma once

#include <cstddef>

namespace bodyopt::fuzz {

// Must be called before any other thread begins.
void watch_memory();
// Ends the process where a read has more than so much allocated at once.
void begin_read(std::size_t most_mib);
void end_read();

}  // namespace bodyopt::fuzz
