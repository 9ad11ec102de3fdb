#include "viewport/commands/keymap_file.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

constexpr const char* kKeymapFile = "keymap.txt";

}  // namespace

Keymap read_keymap(const std::filesystem::path& folder) {
  std::ifstream file(folder / kKeymapFile);
  std::string word;
  if (folder.empty() || !(file >> word)) return Keymap::bodyopt;
  const auto* const found = std::ranges::find(kKeymapNames, word);
  if (found == kKeymapNames.end()) {
    throw Error(ErrorKind::file, folder / kKeymapFile, ": names the keymap '", word,
                "', expected one of the command 'keymap': was it written by a later version?");
  }
  return static_cast<Keymap>(found - kKeymapNames.begin());
}

void write_keymap(Keymap keymap, const std::filesystem::path& folder) {
  if (folder.empty()) return;
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw Error(ErrorKind::file, folder, ": cannot be made, to keep the keymap: ", problem.message());
  const std::string word = kKeymapNames[static_cast<std::size_t>(keymap)];
  write_file_atomically(folder / kKeymapFile, std::as_bytes(std::span(word)));
}

}  // namespace bodyopt::viewport
