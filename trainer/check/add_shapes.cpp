#include "trainer/check/add_shapes.h"

#include <algorithm>
#include <map>
#include <set>

#include "assets/caches/pc2.h"
#include "assets/caches/shape_reader.h"
#include "base/frame_range.h"
#include "base/progress.h"
#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

const DatasetTake* find_take(const Dataset& dataset, const std::string& name) {
  for (const DatasetTake& take : dataset.takes) {
    if (take.name == name) return &take;
  }
  return nullptr;
}

std::vector<int> frames_in_both(std::vector<int> a, std::vector<int> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  std::vector<int> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

TakeCheck check_given(const Dataset& dataset, const DatasetTake& given, const fs::path& source) {
  Dataset alone = dataset;
  alone.takes = {given};
  alone.modifiers.clear();
  alone.takes.front().shapes = fs::absolute(source).string();
  const std::vector<TakeCheck> checks = check_dataset(alone);
  const std::string problem = first_problem(checks, source);
  if (!problem.empty()) throw Error(ErrorKind::mismatch, problem);
  return checks.front();
}

bool names(const Dataset& dataset, const std::string& file) {
  return std::any_of(dataset.takes.begin(), dataset.takes.end(),
                     [&](const DatasetTake& take) { return take.shapes == file || take.shapes_status == file; });
}

bool same_bytes(const fs::path& a, const fs::path& b) {
  return fs::is_regular_file(a) && fs::file_size(a) == fs::file_size(b) && file_hash(a) == file_hash(b);
}

// Files of a change that is under way; they go again unless it is completed.
class NewFiles {
 public:
  explicit NewFiles(fs::path folder) : folder_(std::move(folder)) {}
  ~NewFiles() {
    std::error_code ignored;
    for (const std::string& name : names_) fs::remove(folder_ / name, ignored);
  }
  NewFiles(const NewFiles&) = delete;
  NewFiles& operator=(const NewFiles&) = delete;

  // A name that no file has: take.pc2, take+1.pc2 ...; no take can be called by the latter.
  std::string name(const std::string& take, const std::string& ending) {
    std::string name = take + ending;
    for (int k = 1; fs::exists(folder_ / name); ++k) name = take + '+' + std::to_string(k) + ending;
    return names_.emplace_back(name);
  }
  // A run that was killed may have left the same file under an earlier of these names, which nothing names. The new
  // file takes its place: nothing is stranded, and what is done again is what was done. Returns its name.
  std::string instead_of_leftover(const std::string& name, const std::string& take, const std::string& ending,
                                  const Dataset& dataset) {
    std::string earlier = take + ending;
    for (int k = 1; earlier != name; ++k) {
      if (!names(dataset, earlier) && same_bytes(folder_ / earlier, folder_ / name)) {
        fs::rename(folder_ / name, folder_ / earlier);
        return earlier;
      }
      earlier = take + '+' + std::to_string(k) + ending;
    }
    return name;
  }
  void keep() { names_.clear(); }

 private:
  fs::path folder_;
  std::vector<std::string> names_;
};

// A cache and the frames of its samples.
struct Source {
  ShapeReader reader;
  std::vector<int> frames;
};

Source open_source(const fs::path& path, const std::vector<int>& frames) {
  Source source{ShapeReader(path), frames};
  if (source.reader.sample_count() == frames.size()) return source;
  throw Error(ErrorKind::mismatch, path.string() + ": it has " + std::to_string(source.reader.sample_count()) +
                                       " samples, the dataset names " + std::to_string(frames.size()) +
                                       " frames: one of the two was made anew without the other");
}

// The frames of a source that can be read, of some.
std::vector<int> readable(const Source& source, const std::vector<int>& frames) {
  std::vector<int> sound;
  for (std::size_t k = 0; k < source.frames.size(); ++k) {
    if (std::find(frames.begin(), frames.end(), source.frames[k]) == frames.end()) continue;
    try {
      source.reader.sample(static_cast<std::uint32_t>(k));
      sound.push_back(source.frames[k]);
    } catch (const Error&) {  // damaged: the new shape takes its place
    }
  }
  std::sort(sound.begin(), sound.end());
  return sound;
}

std::vector<int> frames_without(std::vector<int> all, const std::vector<int>& some) {
  std::sort(all.begin(), all.end());
  std::erase_if(all, [&](int frame) { return std::binary_search(some.begin(), some.end(), frame); });
  return all;
}

// The frames of all sources, of the last of them that has each; of the last source only `frames`.
std::vector<int> write_cache(const std::vector<Source>& sources, const std::vector<int>& frames_of_last,
                             const fs::path& path) {
  std::map<int, std::pair<const ShapeReader*, std::uint32_t>> samples;
  for (const Source& source : sources) {
    for (std::size_t k = 0; k < source.frames.size(); ++k) {
      const int frame = source.frames[k];
      const bool asked = std::binary_search(frames_of_last.begin(), frames_of_last.end(), frame);
      if (&source == &sources.back() && !asked) continue;
      samples[frame] = {&source.reader, static_cast<std::uint32_t>(k)};
    }
  }
  std::vector<int> frames;
  for (const auto& [frame, sample] : samples) frames.push_back(frame);
  Pc2Writer writer(path, sources.front().reader.point_count(), static_cast<std::uint32_t>(frames.size()),
                   static_cast<float>(frames.front()), frame_spacing(frames));
  Progress progress("dataset add", frames.size(), "the dataset is as it was");
  for (const auto& [frame, sample] : samples) {
    writer.append(sample.first->sample(sample.second));
    progress.advance();
  }
  writer.close();
  return frames;
}

// A shape from elsewhere counts as solved; that it has no `inputs` keeps `simulate` from replacing it.
std::vector<FrameStatus> with_given(std::vector<FrameStatus> status, const std::vector<int>& given) {
  const std::set<int> frames(given.begin(), given.end());
  std::erase_if(status, [&](const FrameStatus& of_frame) { return frames.contains(of_frame.frame); });
  for (const int frame : frames) {
    FrameStatus& of_frame = status.emplace_back();
    of_frame.frame = frame;
    of_frame.converged = true;
  }
  std::sort(status.begin(), status.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  return status;
}

// A take with new frames from the last source in a new cache, and its side-car; as it is, where there are none.
DatasetTake with_frames(const DatasetTake& old, DatasetTake take, const std::vector<Source>& sources,
                        const std::vector<int>& fresh, const Dataset& dataset, NewFiles& files) {
  const std::string name = take.name;
  take.heldout = unite_frames(old.heldout, take.heldout);
  take.as_given = take.as_given || old.as_given;
  if (fresh.empty()) {
    take.frames = old.frames;
    take.shapes = old.shapes;
    take.shapes_status = old.shapes_status;
    take.carried = old.carried;
    return take;
  }
  take.shapes = files.name(name, ".pc2");
  take.frames = write_cache(sources, fresh, dataset.folder / take.shapes);
  take.shapes = files.instead_of_leftover(take.shapes, name, ".pc2", dataset);
  if (old.shapes_status.empty()) return take;
  take.shapes_status = files.name(name, ".status.json");
  write_frame_status(with_given(read_frame_status(dataset.folder / old.shapes_status), fresh),
                     dataset.folder / take.shapes_status);
  take.shapes_status = files.instead_of_leftover(take.shapes_status, name, ".status.json", dataset);
  return take;
}

// Puts those of the source's frames over what the take has of them.
void cover(const fs::path& path, const std::string& take, const std::vector<int>& frames, const Source& source) {
  std::vector<std::uint32_t> samples;
  for (const int frame : frames) {
    const auto found = std::find(source.frames.begin(), source.frames.end(), frame);
    samples.push_back(static_cast<std::uint32_t>(found - source.frames.begin()));
  }
  put_shapes_over(path, take, frames, source.reader, samples);
}

// Files of a take that lie beside dataset.json and that nothing names any more.
void remove_unnamed(const Dataset& dataset, const DatasetTake& old) {
  for (const std::string& name : {old.shapes, old.shapes_status}) {
    if (name.empty() || fs::path(name).has_parent_path() || names(dataset, name)) continue;
    std::error_code ignored;  // a leftover is harmless
    fs::remove(dataset.folder / name, ignored);
  }
}

}  // namespace

AddedShapes add_shapes(const Dataset& begun, const fs::path& path, const DatasetTake& given, const fs::path& source,
                       bool replace) {
  const TakeLock lock(begun.folder / (given.name + ".pc2"));
  const Dataset dataset = open_dataset(begun, path);
  const DatasetTake old = find_take(dataset, given.name) ? *find_take(dataset, given.name) : DatasetTake{};
  if (!old.name.empty()) require_same_motion(old, given);
  const std::vector<int> replaced = frames_in_both(old.frames, given.frames);
  if (!replaced.empty() && !replace) {
    throw Error(ErrorKind::usage, "the take '" + given.name + "' has the frames " + format_frame_range(replaced) +
                                      " already: --replace puts the new shapes in their place");
  }
  AddedShapes added{given, check_given(dataset, given, source), static_cast<int>(replaced.size())};

  require_place_for(begun, given, path);
  NewFiles files(dataset.folder);
  std::vector<Source> sources;
  if (!old.name.empty()) sources.push_back(open_source(dataset.folder / old.shapes, old.frames));
  sources.push_back(open_source(source, given.frames));
  const std::vector<int> covered = replaced.empty() ? replaced : readable(sources.front(), replaced);
  added.take = with_frames(old, given, sources, frames_without(given.frames, covered), dataset, files);
  const Dataset changed = put_take(begun, added.take, path);
  files.keep();
  if (added.take.shapes != old.shapes) remove_unnamed(changed, old);
  if (!covered.empty()) cover(path, given.name, covered, sources.back());
  return added;
}

}  // namespace bodyopt::trainer
