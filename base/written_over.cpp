#include "base/written_over.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code failure;
  if (fs::equivalent(a, b, failure)) return true;
  const fs::path of_a = fs::weakly_canonical(fs::absolute(a), failure);
  return !failure && of_a == fs::weakly_canonical(fs::absolute(b), failure) && !failure;
}

}  // namespace

void refuse_over(const std::string& option, const fs::path& output, const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (file.empty() || !is_same_file(output, file)) continue;
    throw Error(ErrorKind::usage, option, " ", output, " would write over ", file,
                ", which is an input or another output: give it a name of its own");
  }
}

void require_writable_folder(fs::path folder) {
  folder = fs::absolute(folder);
  while (!fs::exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
  if (access((folder / "").c_str(), W_OK) == 0) return;  // with a '/' at its end a file is refused
  throw Error(ErrorKind::file, folder, ": cannot be written into: expected a folder that is writable from here: ",
              with_cause({errno, std::generic_category()}));
}

}  // namespace bodyopt
