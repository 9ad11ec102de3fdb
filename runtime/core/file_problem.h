// Why the file system refuses what is asked of a file, in words for messages.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace bodyopt {

// The system's reason, and the likely cause: "Read-only file system (is it mounted for reading alone?)".
std::string with_cause(std::error_code failure);

// Names the path and tells the reason: what() is the library's own wording.
std::string describe_refusal(const std::filesystem::filesystem_error& error);

// Why what is at the path cannot be read as a file is: "no such file", "is a folder; expected a file", and the like.
// Call it while errno is that of opening it.
std::string why_unreadable(const std::filesystem::path& path);

// Throws Error(file) unless a file is there: pipes would make their reader wait, and devices have no end.
void require_file(const std::filesystem::path& path);

}  // namespace bodyopt
