// How much memory a read takes at once: a small file that makes a program allocate gigabytes is an attack.
#pragma once

#include <cstddef>

namespace bodyopt::fuzz {

// Must be called before any other thread begins.
void watch_memory();
// Ends the process where one read of a file of so many bytes had more allocated at once than 64 MiB for each KiB begun.
void begin_read(std::size_t file_bytes);
void end_read();

}  // namespace bodyopt::fuzz
