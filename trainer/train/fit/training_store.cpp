#include "trainer/train/fit/training_store.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "assets/characters/character_hash.h"
#include "base/content_hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/choose_map.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

// Raised whenever the same inputs are fitted in another way, or kept in another form.
constexpr std::uint64_t kTrainerVersion = 4;

void add(ContentHash& hash, const std::vector<RegionWeights>& regions) {
  for (const RegionWeights& region : regions) {
    hash.add(region.name);
    hash.append(region.vertices.data(), region.vertices.size() * sizeof(std::uint32_t));
    hash.append(region.weights.data(), region.weights.size() * sizeof(double));
  }
}

void add(ContentHash& hash, const std::vector<Muscle>& muscles) {
  for (const Muscle& muscle : muscles) {
    hash.add(muscle.name);
    hash.add(muscle.radius);
    hash.add(static_cast<std::uint64_t>(muscle.fibre_count));
    for (const MusclePoint& point : muscle.path) {
      hash.add(std::uint64_t{point.joint});
      for (const double x : point.position) hash.add(x);
    }
  }
}

// Hashes options, but for those that only the choice of entries depends on or that change no result. The smoothing
// radius is kept beside the hash, whoever chose it.
void add(ContentHash& hash, const TrainOptions& options) {
  hash.add(0.0);  // for the radius, as earlier versions did where training chose it
  for (const int option :
       {options.smoothing_steps, options.components, options.centres, static_cast<int>(options.method.unposing),
        static_cast<int>(options.method.support), int{options.method.strains}, int{options.method.kernels}}) {
    hash.add(static_cast<std::uint64_t>(option));
  }
  hash.add(options.seed);
  hash.add(static_cast<std::uint64_t>(options.surface_curves));
}

// Begins of takes, and frames of which others are mirror images, as folds see them.
std::uint64_t takes_key(const SampleSet& set) {
  ContentHash hash;
  for (std::size_t n = 1; n < set.train.size(); ++n) {
    if (set.train[n].take != set.train[n - 1].take) hash.add(static_cast<std::uint64_t>(n));
  }
  const std::vector<std::size_t> origins = training_origins(set);
  for (std::size_t n = 0; n < origins.size(); ++n) {
    if (origins[n] != n) hash.add(static_cast<std::uint64_t>(origins[n]));
  }
  return hash.value();
}

std::uint64_t frame_key(const SampleSet& set, const Sample& sample) {
  ContentHash hash;
  for (const JointTransform& joint : sample.pose.joints) hash.add(joint);
  hash.append(sample.pose.controls.data(), sample.pose.controls.size() * sizeof(float));
  if (sample.weight != 1) hash.add(sample.weight);
  try {
    const Positions shape = sample.shape.read();
    hash.append(shape.data(), static_cast<std::size_t>(shape.size()) * sizeof(double));
  } catch (const Error& error) {
    throw Error(error.kind(), frame_name(set, sample) + ": " + error.what());
  }
  return hash.value();
}

// The type of number that a record of a list is a row of when stored; a key of 64 bits is two halves.
template <typename Record>
struct NumberOf {
  using Type = Record;
};
template <>
struct NumberOf<std::uint64_t> {
  using Type = std::uint32_t;
};
template <typename Number, std::size_t count>
struct NumberOf<std::array<Number, count>> {
  using Type = Number;
};

constexpr const char *kLayoutSchema = "bodyopt-training-layout-1", *kRegionSchema = "bodyopt-training-region-1";

// Both classes below give names to values in a file: one puts them there, the other takes them. A visitor that is given
// either says once what the file holds.
class KeptFileWriter {
 public:
  explicit KeptFileWriter(const char* schema) { file_.metadata["schema"] = schema; }

  void operator()(const std::string& name, const std::string& text) { file_.metadata[name] = text; }
  void operator()(const std::string& name, std::uint64_t key) { file_.metadata[name] = hexadecimal(key); }
  template <typename Record>
  void operator()(const std::string& name, const std::vector<Record>& values) {
    using Number = typename NumberOf<Record>::Type;
    put<Number>(name, values.data(), {values.size() * (sizeof(Record) / sizeof(Number))});
  }
  // Stores the values in the order in which they lie in memory.
  template <typename Matrix>
  void operator()(const std::string& name, const Eigen::PlainObjectBase<Matrix>& values) {
    put<typename Matrix::Scalar>(
        name, values.data(),
        {static_cast<std::uint64_t>(values.outerSize()), static_cast<std::uint64_t>(values.innerSize())});
  }
  void numbers(const std::string& name, const std::vector<const double*>& numbers, const std::string&) {
    (*this)(name, transformed(numbers, [](const double* number) { return *number; }));
  }
  // Items by number: `visit` with the name of each. `part`: what every one of them has.
  void each(const std::string& name, const char*, const auto& items, auto visit) {
    for (std::size_t k = 0; k < items.size(); ++k) visit(name + std::to_string(k), items[k]);
  }
  // A member of every item.
  void column(const std::string& name, const auto& items, auto member, const char* = nullptr) {
    (*this)(name, transformed(items, member));
  }

  void write(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) throw Error(ErrorKind::file, path.parent_path().string() + " cannot be made: " + error.message());
    file_.metadata["checksum"] = content_checksum(file_);
    write_safetensors(file_, path);
  }

 private:
  template <typename Number>
  void put(const std::string& name, const void* data, std::vector<std::uint64_t> shape) {
    Tensor tensor{dtype_of<Number>(), std::move(shape), {}};
    std::uint64_t count = 1;
    for (const std::uint64_t n : tensor.shape) count *= n;
    tensor.bytes.resize(count * sizeof(Number));
    if (count > 0) std::memcpy(tensor.bytes.data(), data, tensor.bytes.size());
    file_.tensors[name] = std::move(tensor);
  }

  Safetensors file_;
};

class KeptFileReader {
 public:
  explicit KeptFileReader(const fs::path& path) : path_(path) {
    try {
      file_ = read_safetensors(path);
    } catch (const Error& error) {
      throw Error(error.kind(), error.what() + advice());
    }
  }

  bool is(const char* schema) const { return text("schema") == schema; }

  void operator()(const std::string& name, std::string& value) const { value = text(name); }
  void operator()(const std::string& name, std::uint64_t& key) const {
    try {
      key = std::stoull(text(name), nullptr, 16);
    } catch (const std::logic_error&) {
      refuse("its '" + name + "' is no hash");
    }
  }
  template <typename Record>
  void operator()(const std::string& name, std::vector<Record>& values) const {
    const Tensor& found = tensor(name, 1, dtype_of<typename NumberOf<Record>::Type>());
    if (found.bytes.size() % sizeof(Record) != 0) refuse_shape(name);
    values.resize(found.bytes.size() / sizeof(Record));
    if (!values.empty()) std::memcpy(values.data(), found.bytes.data(), found.bytes.size());
  }
  template <typename Matrix>
  void operator()(const std::string& name, Eigen::PlainObjectBase<Matrix>& values) const {
    const Tensor& found = tensor(name, 2, dtype_of<typename Matrix::Scalar>());
    const auto outer = static_cast<Index>(found.shape[0]), inner = static_cast<Index>(found.shape[1]);
    if (Matrix::ColsAtCompileTime == 1 && outer != 1) refuse_shape(name);
    values.resize(Matrix::IsRowMajor ? outer : inner, Matrix::IsRowMajor ? inner : outer);
    if (values.size() > 0) std::memcpy(values.data(), found.bytes.data(), found.bytes.size());
  }
  // Refuses another count of them, which is what `problem` says.
  void numbers(const std::string& name, const std::vector<double*>& numbers, const std::string& problem) const {
    std::vector<double> values;
    (*this)(name, values);
    if (values.size() != numbers.size()) refuse(problem);
    for (std::size_t k = 0; k < values.size(); ++k) *numbers[k] = values[k];
  }
  void each(const std::string& name, const char* part, auto& items, auto visit) const {
    for (std::size_t k = 0; file_.tensors.contains(name + std::to_string(k) + part); ++k) {
      visit(name + std::to_string(k), items.emplace_back());
    }
  }
  // Without a `problem`, which is what another count of them is, the column says how many items there are.
  void column(const std::string& name, auto& items, auto member, const char* problem = nullptr) const {
    std::vector<std::decay_t<decltype(items[0].*member)>> values;
    (*this)(name, values);
    if (problem == nullptr) items.resize(values.size());
    if (values.size() != items.size()) refuse(problem);
    for (std::size_t k = 0; k < values.size(); ++k) items[k].*member = values[k];
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::file, path_.string() + ": " + what + advice());
  }

 private:
  std::string advice() const {
    return ". It is of an earlier training: delete the folder " + path_.parent_path().string() +
           " to train from the start";
  }
  [[noreturn]] void refuse_shape(const std::string& name) const {
    refuse("'" + name + "' has another type or shape than expected");
  }

  std::string text(const std::string& name) const {
    const auto found = file_.metadata.find(name);
    if (found == file_.metadata.end()) refuse("it lacks '" + name + "'");
    return found->second;
  }

  const Tensor& tensor(const std::string& name, std::size_t dimensions, const char* dtype) const {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("it lacks '" + name + "'");
    if (found->second.shape.size() != dimensions || found->second.dtype != dtype) refuse_shape(name);
    return found->second;
  }

  fs::path path_;
  Safetensors file_;
};

// Contradictions and outliers as they lie in a file: frames or places two by two.
struct ProblemLists {
  std::vector<std::array<std::uint32_t, 2>> frames, places;
  std::vector<double> apart, distances;
};

ProblemLists problem_lists(const RegionModel& model) {
  ProblemLists lists;
  for (const Contradiction& c : model.contradictions) {
    lists.frames.push_back({static_cast<std::uint32_t>(c.frames.first), static_cast<std::uint32_t>(c.frames.second)});
    lists.apart.push_back(c.distance);
  }
  for (const OutlierVertex& outlier : model.outliers) {
    lists.places.push_back({static_cast<std::uint32_t>(outlier.frame), outlier.vertex});
    lists.distances.push_back(outlier.distance);
  }
  return lists;
}

void take_problems(const ProblemLists& lists, RegionModel& model) {
  for (std::size_t k = 0; k < lists.apart.size(); ++k) {
    model.contradictions.push_back({{lists.frames[k][0], lists.frames[k][1]}, lists.apart[k], model.region.name});
  }
  for (std::size_t k = 0; k < lists.distances.size(); ++k) {
    model.outliers.push_back({lists.places[k][0], lists.places[k][1], lists.distances[k]});
  }
}

// The visitors, of constant values for a writer, of others for a reader.
void visit_problems(auto& file, auto& lists) {
  file("contradictions.frames", lists.frames);
  file("strays.places", lists.places);
  file("contradictions.distances", lists.apart);
  file("strays.distances", lists.distances);
}

void visit_region(auto& file, const std::string& prefix, auto& region) {
  file(prefix + "name", region.name);
  file(prefix + "vertices", region.vertices);
  file(prefix + "weights", region.weights);
}

void visit_fit(auto& file, const std::string& name, auto& fit) {
  file(name + ".centres", fit.centres);
  file(name + ".weights", fit.weights);
  file(name + ".errors", fit.errors);
  file(name + ".centre_frames", fit.centre_frames);
  file.numbers(name + ".dials", {&fit.inverse_width2, &fit.penalty.linear, &fit.penalty.kernel, &fit.validation_error},
               "'" + name + ".dials' are not four");
}

void visit_model(auto& file, auto& model) {
  visit_region(file, "", model.region);
  file("features", model.features);
  file("worth", model.explained);
  file("projection", model.projection);
  file("coefficients", model.components.coefficients);
  file("basis", model.components.basis);
  file("energy", model.components.energy);
  file("truncated", model.components.truncated);
  file.each("fit.", ".dials", model.fits, [&](const std::string& name, auto& fit) { visit_fit(file, name, fit); });
}

void visit_layout(auto& file, auto& kept) {
  file("key", kept.key);
  file("subject", kept.from.subject);
  file("frames", kept.from.frames);
  file("takes", kept.from.takes);
  file.numbers("smoothing_radius", {&kept.smoothing_radius}, "it does not have one smoothing radius");
  file.each("curve.", ".joints", kept.curves, [&](const std::string& name, auto& curve) {
    file.column(name + ".joints", curve.path, &MusclePoint::joint);
    file.column(name + ".positions", curve.path, &MusclePoint::position, "a curve has other positions than joints");
    file(name + ".name", curve.name);
  });
  file("features", kept.features);
  file.each("region.", ".vertices", kept.layout.regions,
            [&](const std::string& name, auto& region) { visit_region(file, name + ".", region); });
  file.each("region.", ".vertices", kept.layout.choices, [&](const std::string& name, auto& choices) {
    file.each(name + ".choice.", "", choices, [&](const std::string& each, auto& choice) { file(each, choice); });
  });
}

}  // namespace

TrainingKeys training_keys(const SampleSet& set, const TrainOptions& options) {
  ContentHash subject;
  subject.add(kTrainerVersion);
  bodyopt::add(subject, set.character);
  add(subject, set.muscles);
  add(subject, set.regions);
  for (const std::string& control : set.controls) subject.add(control);
  add(subject, options);
  for (const JointFeatures& of : learned_features(set.character, poses_of(set.train))) {  // of most characters none
    subject.add(std::uint64_t{of.joint});
    subject.add(std::uint64_t{of.above});
    subject.add(of.per_metre);
  }
  TrainingKeys keys{subject.value(), std::vector<std::uint64_t>(set.train.size()), takes_key(set),
                    std::vector<std::uint64_t>(set.heldout.size())};
  Progress progress("train: looking at the frames", set.train.size() + set.heldout.size());
  const auto look = [&](const std::vector<Sample>& samples, std::vector<std::uint64_t>& frames) {
    parallel_for(samples.size(), [&](std::size_t n) {
      frames[n] = frame_key(set, samples[n]);
      progress.advance();
    });
  };
  look(set.train, keys.frames);
  look(set.heldout, keys.heldout);
  return keys;
}

std::uint64_t muscles_hash(const std::vector<Muscle>& muscles) {
  ContentHash hash;
  add(hash, muscles);
  return hash.value();
}

std::uint64_t training_key(const TrainingKeys& keys, double smoothing_radius) {
  ContentHash hash;
  hash.add(keys.subject);
  hash.add(keys.takes);
  hash.add(smoothing_radius);
  for (const std::uint64_t frame : keys.frames) hash.add(frame);
  return hash.value();
}

std::uint64_t updated_key(std::uint64_t earlier, const TrainingKeys& keys) {
  ContentHash hash;
  hash.add(earlier);
  hash.add(keys.takes);
  for (const std::uint64_t frame : keys.frames) hash.add(frame);
  return hash.value();
}

TrainingStore::TrainingStore(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  if (!keeps() || !fs::exists(folder_, error) || fs::is_directory(folder_, error)) return;
  throw Error(ErrorKind::file, folder_.string() +
                                   " is no folder: what training finds is kept there. Delete it, or name "
                                   "the basis otherwise");
}

fs::path TrainingStore::layout_path() const { return folder_ / "layout.safetensors"; }

fs::path TrainingStore::region_path(std::size_t number, std::uint64_t key) const {
  return folder_ / ("region_" + std::to_string(number) + "_" + hexadecimal(key) + ".safetensors");
}

std::optional<KeptLayout> TrainingStore::layout() const {
  if (!keeps() || !fs::exists(layout_path())) return std::nullopt;
  const KeptFileReader file(layout_path());
  if (!file.is(kLayoutSchema)) return std::nullopt;
  KeptLayout kept;
  visit_layout(file, kept);
  for (Muscle& curve : kept.curves) curve = surface_curve(curve.name, std::move(curve.path));
  if (static_cast<std::size_t>(kept.features.rows()) != kept.from.frames.size()) {
    file.refuse("its features are not of its frames");
  }
  return kept;
}

void TrainingStore::keep(const KeptLayout& kept) const {
  if (!keeps()) return;
  KeptFileWriter file(kLayoutSchema);
  visit_layout(file, kept);
  file.write(layout_path());
}

std::optional<RegionModel> TrainingStore::region(std::size_t number, std::uint64_t key) const {
  if (!keeps() || !fs::exists(region_path(number, key))) return std::nullopt;
  const KeptFileReader file(region_path(number, key));
  if (!file.is(kRegionSchema)) return std::nullopt;
  std::uint64_t found = 0;
  file("key", found);
  if (found != key) file.refuse("it is of another training than its name says");
  RegionModel model;
  visit_model(file, model);
  if (model.fits.empty()) file.refuse("it holds no fit");
  ProblemLists lists;
  visit_problems(file, lists);
  if (lists.frames.size() != lists.apart.size() || lists.places.size() != lists.distances.size()) {
    file.refuse("its lists differ in length");
  }
  take_problems(lists, model);
  return model;
}

void TrainingStore::keep(std::size_t number, std::uint64_t key, const RegionModel& model) const {
  if (!keeps()) return;
  KeptFileWriter file(kRegionSchema);
  file("key", key);
  visit_model(file, model);
  const ProblemLists lists = problem_lists(model);
  visit_problems(file, lists);
  file.write(region_path(number, key));
}

void TrainingStore::forget_other_regions(std::uint64_t key) const {
  if (!keeps()) return;
  std::vector<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("region_") && name.find(hexadecimal(key)) == std::string::npos) others.push_back(entry.path());
  }
  for (const fs::path& other : others) fs::remove(other);
}

}  // namespace bodyopt::trainer
