#include "trainer/train/fit/training_store.h"

#include <algorithm>
#include <cstring>

#include "assets/character_hash.h"
#include "base/content_hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/surface_curves.h"

namespace bodyopt {
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

// All but what only the choice of entries depends on, what changes no result, and the smoothing radius: that is kept
// beside it, whoever chose it.
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

// Begins of takes, as folds see them.
std::uint64_t takes_key(const std::vector<Sample>& samples) {
  ContentHash hash;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    if (samples[n].take != samples[n - 1].take) hash.add(static_cast<std::uint64_t>(n));
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

// Tensors of a file, by name.
template <typename Number>
constexpr const char* dtype_of() {
  if constexpr (std::is_same_v<Number, double>) return "F64";
  if constexpr (std::is_same_v<Number, float>) return "F32";
  if constexpr (std::is_same_v<Number, std::uint32_t>) return "U32";
}

template <typename Number>
void put(Safetensors& file, const std::string& name, const Number* data, std::vector<std::uint64_t> shape) {
  Tensor tensor{dtype_of<Number>(), std::move(shape), {}};
  std::uint64_t count = 1;
  for (const std::uint64_t n : tensor.shape) count *= n;
  tensor.bytes.resize(count * sizeof(Number));
  if (count > 0) std::memcpy(tensor.bytes.data(), data, tensor.bytes.size());
  file.tensors[name] = std::move(tensor);
}

template <typename Number>
void put(Safetensors& file, const std::string& name, const std::vector<Number>& values) {
  put(file, name, values.data(), {values.size()});
}

// In the order in which they lie in memory.
void put(Safetensors& file, const std::string& name, const Eigen::MatrixXd& columns) {
  put(file, name, columns.data(),
      {static_cast<std::uint64_t>(columns.cols()), static_cast<std::uint64_t>(columns.rows())});
}
void put(Safetensors& file, const std::string& name, const RawFeatures& rows) {
  put(file, name, rows.data(), {static_cast<std::uint64_t>(rows.rows()), static_cast<std::uint64_t>(rows.cols())});
}

class KeptFile {
 public:
  explicit KeptFile(const fs::path& path) : path_(path) {
    try {
      file_ = read_safetensors(path);
    } catch (const Error& error) {
      throw Error(error.kind(), error.what() + advice());
    }
  }

  bool is(const char* schema) const { return text("schema") == schema; }
  std::string text(const std::string& name) const {
    const auto found = file_.metadata.find(name);
    if (found == file_.metadata.end()) refuse("it lacks '" + name + "'");
    return found->second;
  }
  std::uint64_t key(const std::string& name) const {
    try {
      return std::stoull(text(name), nullptr, 16);
    } catch (const std::logic_error&) {
      refuse("its '" + name + "' is no hash");
    }
  }
  bool has(const std::string& name) const { return file_.tensors.contains(name); }

  template <typename Number>
  std::vector<Number> list(const std::string& name) const {
    const Tensor& found = tensor(name, 1, dtype_of<Number>());
    std::vector<Number> values(found.shape[0]);
    if (!values.empty()) std::memcpy(values.data(), found.bytes.data(), found.bytes.size());
    return values;
  }
  Eigen::MatrixXd matrix(const std::string& name) const {
    const Tensor& found = tensor(name, 2, dtype_of<double>());
    Eigen::MatrixXd columns(static_cast<Index>(found.shape[1]), static_cast<Index>(found.shape[0]));
    if (columns.size() > 0) std::memcpy(columns.data(), found.bytes.data(), found.bytes.size());
    return columns;
  }
  RawFeatures features(const std::string& name) const {
    const Tensor& found = tensor(name, 2, dtype_of<float>());
    RawFeatures rows(static_cast<Index>(found.shape[0]), static_cast<Index>(found.shape[1]));
    if (rows.size() > 0) std::memcpy(rows.data(), found.bytes.data(), found.bytes.size());
    return rows;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::file, path_.string() + ": " + what + advice());
  }

 private:
  std::string advice() const {
    return ". It is of an earlier training: delete the folder " + path_.parent_path().string() +
           " to train from the start";
  }

  const Tensor& tensor(const std::string& name, std::size_t dimensions, const char* dtype) const {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("it lacks '" + name + "'");
    if (found->second.shape.size() != dimensions || found->second.dtype != dtype) {
      refuse("'" + name + "' has another type or shape than expected");
    }
    return found->second;
  }

  fs::path path_;
  Safetensors file_;
};

constexpr const char *kLayoutSchema = "bodyopt-training-layout-1", *kRegionSchema = "bodyopt-training-region-1";

Safetensors new_file(const char* schema, std::uint64_t key) {
  Safetensors file;
  file.metadata["schema"] = schema;
  file.metadata["key"] = hexadecimal(key);
  return file;
}

void write(Safetensors file, const fs::path& path) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw Error(ErrorKind::file, path.parent_path().string() + " cannot be made: " + error.message());
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

void put(Safetensors& file, const std::string& prefix, const RegionWeights& region) {
  file.metadata[prefix + "name"] = region.name;
  put(file, prefix + "vertices", region.vertices);
  put(file, prefix + "weights", region.weights);
}

RegionWeights region_weights(const KeptFile& file, const std::string& prefix) {
  return {file.text(prefix + "name"), file.list<std::uint32_t>(prefix + "vertices"),
          file.list<double>(prefix + "weights")};
}

// Keys are 64 bits, of which tensors hold halves.
std::vector<std::uint32_t> halves(const std::vector<std::uint64_t>& keys) {
  std::vector<std::uint32_t> halves;
  for (const std::uint64_t key : keys) {
    halves.push_back(static_cast<std::uint32_t>(key));
    halves.push_back(static_cast<std::uint32_t>(key >> 32));
  }
  return halves;
}

std::vector<std::uint64_t> joined(const std::vector<std::uint32_t>& halves) {
  std::vector<std::uint64_t> keys;
  for (std::size_t k = 0; k + 1 < halves.size(); k += 2) keys.push_back(halves[k] | std::uint64_t{halves[k + 1]} << 32);
  return keys;
}

void put(Safetensors& file, const Components& components) {
  put(file, "coefficients", components.coefficients);
  put(file, "basis", components.basis);
  put(file, "energy", Eigen::MatrixXd(components.energy));
  put(file, "truncated", Eigen::MatrixXd(components.truncated));
}

Components components_in(const KeptFile& file) {
  return {file.matrix("coefficients"), file.matrix("basis"), file.matrix("energy"), file.matrix("truncated")};
}

void put(Safetensors& file, const std::string& prefix, const Regression& fit) {
  put(file, prefix + "centres", fit.centres);
  put(file, prefix + "weights", fit.weights);
  put(file, prefix + "errors", fit.errors);
  put(file, prefix + "centre_frames", std::vector<std::uint32_t>(fit.centre_frames.begin(), fit.centre_frames.end()));
  put(file, prefix + "dials",
      std::vector{fit.inverse_width2, fit.penalty.linear, fit.penalty.kernel, fit.validation_error});
}

Regression regression_in(const KeptFile& file, const std::string& prefix) {
  Regression fit;
  fit.centres = file.matrix(prefix + "centres");
  fit.weights = file.matrix(prefix + "weights");
  fit.errors = file.matrix(prefix + "errors");
  for (const std::uint32_t frame : file.list<std::uint32_t>(prefix + "centre_frames")) {
    fit.centre_frames.push_back(static_cast<int>(frame));
  }
  const std::vector<double> dials = file.list<double>(prefix + "dials");
  if (dials.size() != 4) file.refuse("'" + prefix + "dials' are not four");
  fit.inverse_width2 = dials[0];
  fit.penalty = {dials[1], dials[2]};
  fit.validation_error = dials[3];
  return fit;
}

std::string curve_prefix(std::size_t number) { return "curve." + std::to_string(number) + "."; }

void put_curves(Safetensors& file, const std::vector<Muscle>& curves) {
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<std::uint32_t> joints;
    std::vector<double> positions;
    for (const MusclePoint& point : curves[c].path) {
      joints.push_back(point.joint);
      positions.insert(positions.end(), point.position.begin(), point.position.end());
    }
    file.metadata[curve_prefix(c) + "name"] = curves[c].name;
    put(file, curve_prefix(c) + "joints", joints);
    put(file, curve_prefix(c) + "positions", positions);
  }
}

std::vector<Muscle> curves_in(const KeptFile& file) {
  std::vector<Muscle> curves;
  for (std::size_t c = 0; file.has(curve_prefix(c) + "joints"); ++c) {
    const auto joints = file.list<std::uint32_t>(curve_prefix(c) + "joints");
    const auto positions = file.list<double>(curve_prefix(c) + "positions");
    if (positions.size() != 3 * joints.size()) file.refuse("a curve has other positions than joints");
    std::vector<MusclePoint> path;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      path.push_back({joints[k], {positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]}});
    }
    curves.push_back(surface_curve(file.text(curve_prefix(c) + "name"), std::move(path)));
  }
  return curves;
}

std::string fit_prefix(std::size_t number) { return "fit." + std::to_string(number) + "."; }

void put(Safetensors& file, const std::vector<Contradiction>& contradictions, const std::vector<StrayVertex>& strays) {
  std::vector<std::uint32_t> frames, places;
  std::vector<double> apart, distances;
  for (const Contradiction& c : contradictions) {
    frames.push_back(static_cast<std::uint32_t>(c.frames.first));
    frames.push_back(static_cast<std::uint32_t>(c.frames.second));
    apart.push_back(c.distance);
  }
  for (const StrayVertex& stray : strays) {
    places.push_back(static_cast<std::uint32_t>(stray.frame));
    places.push_back(stray.vertex);
    distances.push_back(stray.distance);
  }
  put(file, "contradictions.frames", frames);
  put(file, "contradictions.distances", apart);
  put(file, "strays.places", places);
  put(file, "strays.distances", distances);
}

void read_data_problems(const KeptFile& file, RegionModel& model) {
  const auto frames = file.list<std::uint32_t>("contradictions.frames"),
             places = file.list<std::uint32_t>("strays.places");
  const auto apart = file.list<double>("contradictions.distances"), distances = file.list<double>("strays.distances");
  if (frames.size() != 2 * apart.size() || places.size() != 2 * distances.size())
    file.refuse("its lists differ in length");
  for (std::size_t k = 0; k < apart.size(); ++k) {
    model.contradictions.push_back({{frames[2 * k], frames[2 * k + 1]}, apart[k], model.region.name});
  }
  for (std::size_t k = 0; k < distances.size(); ++k) {
    model.strays.push_back({places[2 * k], places[2 * k + 1], distances[k]});
  }
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
  for (const JointFeatures& of : learned_features(set.character)) {  // of most characters none
    subject.add(std::uint64_t{of.joint});
    subject.add(std::uint64_t{of.above});
  }
  TrainingKeys keys{subject.value(), std::vector<std::uint64_t>(set.train.size()), takes_key(set.train),
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
  const KeptFile file(layout_path());
  if (!file.is(kLayoutSchema)) return std::nullopt;
  KeptLayout kept;
  kept.key = file.key("key");
  kept.from = {file.key("subject"), joined(file.list<std::uint32_t>("frames")), file.key("takes"), {}};
  const std::vector<double> radius = file.list<double>("smoothing_radius");
  if (radius.size() != 1) file.refuse("it does not have one smoothing radius");
  kept.smoothing_radius = radius[0];
  kept.curves = curves_in(file);
  kept.features = file.features("features");
  if (static_cast<std::size_t>(kept.features.rows()) != kept.from.frames.size()) {
    file.refuse("its features are not of its frames");
  }
  for (std::size_t r = 0;; ++r) {
    const std::string prefix = "region." + std::to_string(r) + ".";
    if (!file.has(prefix + "vertices")) break;
    kept.layout.regions.push_back(region_weights(file, prefix));
    FeatureChoices& choices = kept.layout.choices.emplace_back();
    for (std::size_t c = 0; file.has(prefix + "choice." + std::to_string(c)); ++c) {
      choices.push_back(file.list<std::uint32_t>(prefix + "choice." + std::to_string(c)));
    }
  }
  return kept;
}

void TrainingStore::keep(const KeptLayout& kept) const {
  if (!keeps()) return;
  Safetensors file = new_file(kLayoutSchema, kept.key);
  file.metadata["subject"] = hexadecimal(kept.from.subject);
  file.metadata["takes"] = hexadecimal(kept.from.takes);
  put_curves(file, kept.curves);
  put(file, "frames", halves(kept.from.frames));
  put(file, "smoothing_radius", std::vector{kept.smoothing_radius});
  put(file, "features", kept.features);
  for (std::size_t r = 0; r < kept.layout.regions.size(); ++r) {
    const std::string prefix = "region." + std::to_string(r) + ".";
    put(file, prefix, kept.layout.regions[r]);
    for (std::size_t c = 0; c < kept.layout.choices[r].size(); ++c) {
      put(file, prefix + "choice." + std::to_string(c), kept.layout.choices[r][c]);
    }
  }
  write(std::move(file), layout_path());
}

std::optional<RegionModel> TrainingStore::region(std::size_t number, std::uint64_t key) const {
  if (!keeps() || !fs::exists(region_path(number, key))) return std::nullopt;
  const KeptFile file(region_path(number, key));
  if (!file.is(kRegionSchema)) return std::nullopt;
  if (file.key("key") != key) file.refuse("it is of another training than its name says");
  RegionModel model;
  model.region = region_weights(file, "");
  model.features = file.list<std::uint32_t>("features");
  model.explained = file.list<double>("worth");
  model.projection = file.matrix("projection");
  model.components = components_in(file);
  for (std::size_t f = 0; file.has(fit_prefix(f) + "dials"); ++f) {
    model.fits.push_back(regression_in(file, fit_prefix(f)));
  }
  if (model.fits.empty()) file.refuse("it holds no fit");
  read_data_problems(file, model);
  return model;
}

void TrainingStore::keep(std::size_t number, std::uint64_t key, const RegionModel& model) const {
  if (!keeps()) return;
  Safetensors file = new_file(kRegionSchema, key);
  put(file, "", model.region);
  put(file, "features", model.features);
  put(file, "worth", model.explained);
  put(file, "projection", model.projection);
  put(file, model.components);
  for (std::size_t f = 0; f < model.fits.size(); ++f) put(file, fit_prefix(f), model.fits[f]);
  put(file, model.contradictions, model.strays);
  write(std::move(file), region_path(number, key));
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

}  // namespace bodyopt
