#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <utility>

#include "runtime/basis/dynamics.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/host/jiggle.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-jiggle-state-1";

// Of the character's size, and of that a frame: what jiggles is nowhere near, and further away single precision may run
// out of numbers.
constexpr double kMostJiggle = 1e3;  // off its quasi-static place
constexpr double kMostPlace = 1e6;   // in the world
constexpr int kMostFrame = 2000000000;

// Applies `visit(name, array)` to every array of a state.
template <typename State, typename Visit>
void for_each_array(State& state, Visit visit) {
  visit("joints", state.joints);
  visit("joint_velocity", state.joint_velocity);
  visit("displacement", state.motion.displacement);
  visit("velocity", state.motion.velocity);
  visit("nodes", state.motion.nodes);
  visit("node_velocity", state.motion.node_velocity);
}

// Throws Error(file) where a number is beyond what a character of these dynamics does, or none at all.
void require_bounded(const JiggleState& state, const Dynamics& dynamics, const std::filesystem::path& path) {
  const double size = box_diagonal(dynamics.tets.nodes),
               rate = static_cast<double>(dynamics.jiggle.step.frames_per_second);
  const auto check = [&](const char* name, const auto& values, double most) {
    for (const auto value : values) {
      if (std::abs(static_cast<double>(value)) <= most) continue;
      std::ostringstream text;
      text << path.string() << ": '" << name << "' has the number " << value << ", expected " << most
           << " at most for a character of " << size << " m: the jiggle blew up, or the file is damaged";
      throw Error(ErrorKind::file, text.str());
    }
  };
  check("displacement", state.motion.displacement, kMostJiggle * size);
  check("velocity", state.motion.velocity, kMostJiggle * size * rate);
  check("nodes", state.motion.nodes, kMostPlace * size);
  check("node_velocity", state.motion.node_velocity, kMostPlace * size * rate);
  check("joints", state.joints, kMostPlace * size);
  check("joint_velocity", state.joint_velocity, kMostPlace * size * rate);
  check("origin", state.origin, kMostPlace * size);
}

class StateReader {
 public:
  explicit StateReader(const std::filesystem::path& path) : path_(path), file_(read_safetensors(path)) {
    metadata("checksum");
    if (metadata("schema") != kSchema) {
      refuse("it is not a state of the jiggle (schema '", metadata("schema"), "', expected '", kSchema, "')");
    }
  }

  const std::string& metadata(const std::string& key) const {
    const auto found = file_.metadata.find(key);
    if (found == file_.metadata.end()) refuse("its metadata lacks '", key, "'");
    return found->second;
  }

  int integer(const std::string& key) const {
    try {
      std::size_t end = 0;
      const int value = std::stoi(metadata(key), &end);
      if (end == metadata(key).size()) return value;
    } catch (const std::exception&) {
    }
    refuse("its '", key, "' is not a whole number: '", metadata(key), "'");
  }

  template <typename T>
  void read(const std::string& name, std::vector<T>& values) const {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("tensor '", name, "' is missing");
    const Tensor& tensor = found->second;
    if (tensor.dtype != dtype_of<T>() || tensor.shape.size() != 2 || tensor.shape[1] != 3) {
      refuse("tensor '", name, "' is not rows of three numbers");
    }
    values.resize(tensor.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), tensor.bytes.data(), tensor.bytes.size());
    for (const T value : values) {
      if (!std::isfinite(value)) refuse("tensor '", name, "' has a number that is not finite");
    }
  }

  [[noreturn]] void refuse(const auto&... what) const { throw Error(ErrorKind::file, path_, ": ", what...); }

 private:
  const std::filesystem::path& path_;
  Safetensors file_;
};

}  // namespace

void save_state(const JiggleState& state, const Dynamics& dynamics, const std::filesystem::path& path) {
  require_bounded(state, dynamics, path);
  Safetensors file;
  for_each_array(state, [&](const char* name, const auto& values) { file.tensors[name] = tensor_from(values, 3); });
  file.tensors["origin"] = tensor_from(std::vector<double>(state.origin, state.origin + 3), 3);
  file.metadata = {{"schema", kSchema},
                   {"dynamics", checksum(dynamics)},
                   {"frame", std::to_string(state.frame)},
                   {"known", std::to_string(state.known)}};
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

StateFile read_state(const std::filesystem::path& path) {
  const StateReader reader(path);
  StateFile file{{}, reader.metadata("dynamics")};
  JiggleState& state = file.state;
  for_each_array(state, [&](const char* name, auto& values) { reader.read(name, values); });
  std::vector<double> origin;
  reader.read("origin", origin);
  const int known = reader.integer("known");
  if (known < 0 || known > 2 || origin.size() != 3) reader.refuse("its numbers of frames or its origin are not sound");
  std::copy(origin.begin(), origin.end(), state.origin);
  state.frame = reader.integer("frame");
  if (std::abs(static_cast<double>(state.frame)) > kMostFrame) reader.refuse("its frame is out of range");
  state.known = static_cast<std::uint32_t>(known);
  return file;
}

JiggleState load_state(const std::filesystem::path& path, const Dynamics& dynamics) {
  StateFile file = read_state(path);
  if (file.dynamics != checksum(dynamics)) {
    throw Error(ErrorKind::mismatch, path, ": it is a state of other dynamics (checksum ", file.dynamics,
                ", these have ", checksum(dynamics), "): made again since, or of another character");
  }
  require_bounded(file.state, dynamics, path);
  return std::move(file.state);
}

}  // namespace bodyopt
