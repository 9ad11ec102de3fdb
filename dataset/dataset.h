// dataset.json: which character, clips and shapes belong together, and which frames are held out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "runtime/core/atomic_file.h"

namespace bodyopt {

// Lists the files that a dataset is made of.

struct Clip;
struct Skeleton;

// dataset/modifier.h, which takes a second to compile.
struct Modifier;
struct NamedSelection;

// One clip and its shapes. Sample k of the cache is frame frames[k] of the clip.
struct DatasetTake {
  std::string name;
  std::string clip;      // as given to read_clip; the file part relative to the dataset's folder
  std::string controls;  // controls.json of the clip, relative path, or empty
  double fps = 24;
  int first_frame = 1;
  std::vector<int> frames;
  std::string shapes;         // PC2, output vertex order, relative path
  std::string shapes_status;  // side-car JSON of simulate, relative path; empty for shapes from elsewhere
  std::vector<int> heldout;   // frames never trained on
  std::string joint_map{};    // joint_map.json of the clip, relative path, or empty
  std::string up{};           // as ClipOptions
  bool carried = false;       // from another character, by 'transfer dataset', which may do so again
  bool as_given = false;      // its shapes lie as they are meant to, wherever that is
};

struct Dataset {
  Dataset();
  Dataset(const Dataset& other);
  Dataset(Dataset&& other) noexcept;
  Dataset& operator=(const Dataset& other);
  Dataset& operator=(Dataset&& other) noexcept;
  ~Dataset();

  std::filesystem::path folder;
  std::string character;    // relative path
  double unit = 0;          // as read_character
  std::string muscles;      // relative path, or empty
  std::string materials;    // relative path, or empty: the defaults
  double body_fat = 0;      // share of the body's mass; 0: the default
  std::string kind;         // of body, as --kind of simulate; empty: recognised
  std::string corrections;  // of the anatomy, relative path, or empty
  std::string regions;      // regions.json, relative path, or empty: chosen by training
  std::vector<DatasetTake> takes;
  std::vector<Modifier> modifiers;  // that the shapes are read through, first to last
  std::vector<NamedSelection> selections;
};

// The clip of a take, with its controls. Throws as read_clip.
Clip read_clip(const Dataset& dataset, const DatasetTake& take, const Skeleton& skeleton);

// Throws Error(mismatch) when two takes of one name differ in clip, controls, joint map or frame numbers.
void require_same_motion(const DatasetTake& there, const DatasetTake& asked);

// Throws Error(file) on bad bytes, wrong schema version or missing keys.
Dataset read_dataset(const std::filesystem::path& path);
// The dataset in `path`, or, where there is none yet, `asked`. One dataset holds the takes of one character: throws
// Error(mismatch) where that in the file has another character, unit, muscles, materials or anatomy.
Dataset open_dataset(const Dataset& asked, const std::filesystem::path& path);
// Written to a temporary name, then renamed. `path` is the dataset.json; its folder must exist.
void write_dataset(const Dataset& dataset, const std::filesystem::path& path);
// Puts a take in the place of that of its name, or after all others, and returns the dataset as it is then. Alone: what
// other processes do to `path` meanwhile is neither lost nor does it undo this. Throws as open_dataset().
Dataset put_take(const Dataset& asked, const DatasetTake& take, const std::filesystem::path& path);
// Throws what put_take() would throw after the long work that makes the take's shapes. Reasons are a folder that cannot
// be written to, or a name that JSON cannot hold.
void require_place_for(const Dataset& asked, const DatasetTake& take, const std::filesystem::path& path);

// The side-car of a simulated cache: what the solver says of each frame.
struct FrameStatus {
  int frame = 0;
  double residual = 0;     // norm of the force left over / norm of the elastic forces
  bool converged = false;  // residual below 1e-4 and no inverted tet
  int iterations = 0;
  double seconds = 0;
  int inverted_tets = 0;
  // Metres that skin has passed through skin, at the deepest. It is not a number for shapes that were not simulated.
  double contact_depth = std::numeric_limits<double>::quiet_NaN();
  double volume_change = 0;  // relative, of the muscle that changes most
  std::uint64_t inputs = 0;  // hash of everything the shape depends on; 0: not known
  // Estimated distance of the shape from that in ever finer tets, metres, RMS over the skin. It is not a number in most
  // frames, where none was made.
  double discretisation_error = std::numeric_limits<double>::quiet_NaN();
};
std::vector<FrameStatus> read_frame_status(const std::filesystem::path& path);
void write_frame_status(const std::vector<FrameStatus>& status, const std::filesystem::path& path);

// Frames of a take whose shapes an enabled modifier of the type blend replaces wholly; those in the cache are hidden.
[[nodiscard]] std::set<int> replaced_frames(const Dataset& dataset, const DatasetTake& take);

// Frames of a take that its side-car does not vouch for, but for those that are replaced; none without a side-car.
[[nodiscard]] std::set<int> unconverged_frames(const Dataset& dataset, const DatasetTake& take);

// Does a take have shapes that come from elsewhere: those that its side-car has no `inputs` of?
[[nodiscard]] bool has_given_shapes(const Dataset& dataset, const DatasetTake& take);

// Keeps a second run from writing the same take at the same time.

// Holds a lock on a take while it lives.
class [[nodiscard]] TakeLock {
 public:
  static constexpr char kOtherName[] = "write a take of another name";

  // cache: that of the take's shapes. The lock has `.lock` in place of its ending. A draft and a full simulation of one
  // name share a side-car, and so exclude each other. Throws Error(file) when another run holds it. The constructor is
  // not explicit: a lock for one call is a path.
  // `instead`: what the caller's user can do rather than wait.
  TakeLock(std::filesystem::path cache, const std::string& instead = kOtherName);

  const std::filesystem::path& cache() const { return cache_; }

 private:
  std::filesystem::path cache_;
  RunLock lock_;
};

struct HashedFile {
  std::string what;    // "character", "take 'rom': shapes"
  std::string path;    // as the dataset names it
  std::uint64_t xxh3;  // of its bytes
};

// Hashes every file that the dataset names, each once, in its order. Throws Error(file) where one cannot be read.
std::vector<HashedFile> hashed_files(const Dataset& dataset);

// xxh3 of a file's bytes. Throws Error(file).
std::uint64_t file_hash(const std::filesystem::path& path);

}  // namespace bodyopt
