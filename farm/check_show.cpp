#include "farm/check_show.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>

#include "assets/clip.h"
#include "assets/frame_range.h"
#include "assets/matched_joints.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/levels.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "shots/session/posed_clip.h"
#include "shots/session/session_file.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// Measured on one core of the machine of docs/notes (The farm): of the skin per vertex, of the jiggle per tetrahedron.
constexpr double kMillisecondsPerPoint = 7e-4, kMillisecondsPerTet = 4e-3;

// A level of a basis, and what was read to go with it.
struct LeveledBasis {
  Basis basis;
  std::size_t levels = 1;
};

struct FrameSpan {
  int first, last;
};

// Reads each thing once; what could not be read is told to everyone who asks.
template <typename Value>
class Once {
 public:
  template <typename Read>
  const Value& get(const std::string& key, const Read& read) {
    auto found = values_.find(key);
    if (found == values_.end()) {
      found = values_.emplace(key, Entry{}).first;
      try {
        found->second.value.emplace(read());
      } catch (const Error& error) {
        found->second.failure.emplace(error);
      }
    }
    if (found->second.failure) throw Error(*found->second.failure);
    return *found->second.value;
  }

 private:
  struct Entry {
    std::optional<Value> value;
    std::optional<Error> failure;
  };
  std::map<std::string, Entry> values_;
};

// Each part of a range begins after the end of the one before.
void require_rising(const std::string& range) {
  std::istringstream parts(range);
  std::optional<int> last;
  for (std::string part; std::getline(parts, part, ',');) {
    const std::vector<int> frames = parse_frame_range(part);
    if (last && frames.front() <= *last) {
      throw Error(ErrorKind::usage, "the parts of frames ", range, " overlap or are not in order");
    }
    last = frames.back();
  }
}

// What a session says of its lead, as if the list did.
ShowElement as_listed(ShowElement element) {
  if (element.session.empty()) return element;
  const SessionFile session = read_session(element.session);
  const ActorFiles& lead = trained_lead(session, element.session).files;
  element.basis = lead.basis;
  element.clip = lead.clip;
  element.options["fps"] = {std::to_string(session.clip.fps)};
  if (!lead.joint_map.empty()) element.options["joint-map"] = {lead.joint_map};
  if (const std::string up = lead.up_of(lead.clip); !up.empty()) element.options["up"] = {up};
  element.session_in = session.view.playback.in;
  element.session_out = session.view.playback.out;
  return element;
}

// All of the clip, or what the session plays of it.
std::string played_range(const ShowElement& element, const FrameSpan& clip) {
  const int first = std::max(clip.first, element.session_in.value_or(clip.first));
  const int last = std::min(clip.last, element.session_out.value_or(clip.last));
  if (first > last) {
    throw Error(ErrorKind::usage, element.session, ": '", element.clip,
                "' has no frame of the range that it plays: was the clip replaced? 'frames' chooses others");
  }
  return std::to_string(first) + "-" + std::to_string(last);
}

class ShowChecker {
 public:
  CheckedElement check(const ShowElement& listed) {
    const ShowElement element = as_listed(listed);
    const std::string level = element.option("level", "0");
    const auto& character = characters_.get(element.basis + '\0' + level, [&] { return read(element.basis, level); });
    CheckedElement checked{&listed, frames_of(element, character.basis), 0, {}};
    checked.frame_ms = kMillisecondsPerPoint * static_cast<double>(character.basis.mesh.output_count());
    if (element.has("jiggle")) checked.frame_ms += kMillisecondsPerTet * tets(element, character.basis);
    if (element.frame_ms > 0) checked.frame_ms = element.frame_ms;
    if (level == "0") checked.attached = attached(element, character.basis);
    check_output(listed, checked.attached);
    return checked;
  }

 private:
  static LeveledBasis read(const std::string& basis, const std::string& level) {
    std::vector<Level> levels = load_levels(basis);
    const std::size_t number = std::strtoul(level.c_str(), nullptr, 10);
    if (number >= levels.size()) {
      throw Error(ErrorKind::usage, "level ", level, " is asked for; ", basis, " has levels 0 to ", levels.size() - 1);
    }
    return {std::move(levels[number].basis), levels.size()};
  }

  std::vector<int> frames_of(const ShowElement& element, const Basis& basis) {
    ClipOptions options;
    options.fps = std::atof(element.option("fps", "24").c_str());
    options.first_frame = std::atoi(element.option("first-frame", "1").c_str());
    options.controls = element.option("controls", "");
    options.joint_map = element.option("joint-map", "");
    options.up = element.option("up", "");
    options.unit = std::atof(element.option("unit", "0").c_str());
    if (options.unit == 0 && !element.clip.empty()) options.unit = clip_unit(element.clip, kept_unit(basis));
    std::string key = element.clip + '\0' + element.basis;
    for (const char* option : {"fps", "first-frame", "controls", "joint-map", "unit", "up"}) {
      key += '\0' + element.option(option, "");
    }
    const FrameSpan span = spans_.get(key, [&] {
      const Clip clip =
          element.clip.empty() ? still_clip(basis.skeleton, options) : read_clip(element.clip, basis, options);
      return FrameSpan{clip.first_frame, clip.last_frame()};
    });
    const std::string range = element.frames.empty() ? played_range(element, span) : element.frames;
    require_rising(range);
    const std::vector<int> frames = parse_frame_range(range);
    for (const int frame : {frames.front(), frames.back()}) {
      if (frame >= span.first && frame <= span.last) continue;
      throw Error(ErrorKind::usage, "frame ", frame, " is asked for; '", element.clip, "' has frames ", span.first,
                  " to ", span.last);
    }
    return frames;
  }

  double tets(const ShowElement& element, const Basis& basis) {
    const std::string file = element.option("dynamics", dynamics_beside(element.basis).string());
    return tets_.get(file + '\0' + element.basis,
                     [&] { return static_cast<double>(load_dynamics(file, basis).tets.tet_count()); });
  }

  std::vector<std::string> attached(const ShowElement& element, const Basis& basis) {
    const fs::path beside = attachments_beside(element.basis);
    const std::string file = element.option("attached", fs::exists(beside) ? beside.string() : "");
    if (file.empty()) return {};
    return attached_.get(file + '\0' + element.basis,
                         [&] { return transformed(load_attachments(file, basis).meshes, &AttachedMesh::name); });
  }

  void check_output(const ShowElement& element, const std::vector<std::string>& attached) {
    const fs::path out = element.out;
    if (out.extension() != ".pc2" && out.extension() != ".usda") {
      throw Error(ErrorKind::usage, "out '", element.out, "' does not end in .pc2 or .usda");
    }
    if (element.out.find_first_of("#{}") != std::string::npos) {
      throw Error(
          ErrorKind::usage, "out '", element.out,
          "' holds '#' or an unknown {field}: known are {shot} and {element}; parts of a shot are named by the plan");
    }
    folders_.get(out.parent_path().string(), [&] { return require_writable_folder(out.parent_path()); });
    std::vector<std::string> files{element.out};
    for (const std::string& mesh : attached) {
      files.push_back(fs::path(out).replace_extension("." + mesh + out.extension().string()).string());
    }
    for (const std::string& file : files) {
      const auto [known, is_new] = writers_.emplace(file, &element);
      if (!is_new) {
        throw Error(ErrorKind::usage, "writes ", file, ", as does ", known->second->place,
                    ": give them names of their own, with {shot} and {element}");
      }
    }
  }

  // The folder, or the one in which it would be made.
  static bool require_writable_folder(fs::path folder) {
    while (!fs::exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
    if (fs::is_directory(folder) && access(folder.c_str(), W_OK) == 0) return true;
    throw Error(ErrorKind::file, folder, ": cannot be written into: expected a folder that is writable from here");
  }

  Once<LeveledBasis> characters_;
  Once<FrameSpan> spans_;
  Once<double> tets_;
  Once<std::vector<std::string>> attached_;
  Once<bool> folders_;
  std::map<std::string, const ShowElement*> writers_;
};

}  // namespace

std::vector<CheckedElement> check_show(const ShowList& list, std::vector<std::string>& problems) {
  ShowChecker checker;
  std::vector<CheckedElement> checked;
  for (const ShowElement& element : list.elements) {
    try {
      checked.push_back(checker.check(element));
    } catch (const Error& error) {
      problems.push_back(element.place + " (" + element.shot + ", " + element.element + "): " + error.what());
    }
  }
  return checked;
}

}  // namespace bodyopt
