// What kind of file of ours stands under a name, by its "schema".
#pragma once

#include <filesystem>
#include <string>

namespace bodyopt {

// The schema of a JSON or safetensors file; empty where it has none, is damaged or cannot be read.
std::string schema_of(const std::filesystem::path& path);

// Refuses to write over a file of another kind, which a slip of the hand names: one of another schema (whatever its
// version), or one that does not look as what is written does. `schema`: of what is written; empty: of none, as a
// report has it. What is damaged may be written over. Throws Error(usage).
void refuse_other_kind(const std::filesystem::path& path, const std::string& schema);

}  // namespace bodyopt
