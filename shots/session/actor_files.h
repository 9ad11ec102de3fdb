// The files of a character as the viewport and sessions name them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt {

// Is the path that of a basis, with files that belong to it beside it?
bool is_basis(const std::string& path);

// The files of a character; what is empty is none. Dynamics, attached geometry and, where no other is named, a proxy:
// those beside a trained basis, where there are any.
struct ActorFiles {
  std::string basis;  // see open_character()
  std::string clip{}, truth{}, proxy{};
  std::string character{};  // for linear blending
  std::string limits{};     // of its joints
  std::string muscles{};    // for its section
  std::string joint_map{};  // of its clips
  std::string up{};         // of those that are BVH, as ClipOptions

  std::filesystem::path dynamics() const;
  std::filesystem::path attached() const;
  std::filesystem::path levels() const;                // the proxy; empty: none, and none can be there
  std::string up_of(const std::string& source) const;  // `up` where the clip's source is a BVH
  // All of them, those beside the basis whether they are there or not: to be watched.
  std::vector<std::filesystem::path> paths() const;
};

}  // namespace bodyopt
