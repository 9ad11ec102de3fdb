#include "shots/session/actor_files.h"

#include "assets/clip_source.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/levels.h"

namespace bodyopt {

namespace fs = std::filesystem;

bool is_basis(const std::string& path) { return path.ends_with(".safetensors"); }

fs::path ActorFiles::dynamics() const { return dynamics_beside(basis); }

fs::path ActorFiles::attached() const { return attachments_beside(basis); }

fs::path ActorFiles::levels() const { return proxy.empty() && is_basis(basis) ? proxy_beside(basis) : fs::path(proxy); }

std::string ActorFiles::up_of(const std::string& source) const {
  return lower_case_extension(split_source(source).path) == ".bvh" ? up : "";
}

std::vector<fs::path> ActorFiles::paths() const {
  std::vector<fs::path> all;
  if (is_basis(basis)) all = {dynamics(), attached()};
  for (const std::string& file :
       {basis, split_source(clip).path.string(), truth, levels().string(), character, limits, muscles, joint_map}) {
    if (!file.empty()) all.emplace_back(file);
  }
  return all;
}

}  // namespace bodyopt
