#include "proxy_viewer/character.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "runtime/basis/error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/device.h"
#include "trainer/dataset/controls.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

struct Segment {
  std::uint32_t from, to, fibre;
};

// Fibre points name strain vertices; drawing needs those of the skin.
std::vector<FibrePoint> points_on_skin(const StrainTable& strain) {
  std::vector<FibrePoint> points = strain.points;
  for (FibrePoint& point : points) {
    point.a = strain.vertices[point.a];
    point.b = strain.vertices[point.b];
    point.c = strain.vertices[point.c];
  }
  return points;
}

std::vector<Segment> segments_of(const StrainTable& strain) {
  std::vector<Segment> segments;
  for (std::uint32_t fibre = 0; fibre < strain.fibre_count(); ++fibre) {
    for (std::uint32_t p = strain.fibre_begin[fibre] + 1; p < strain.fibre_begin[fibre + 1]; ++p) {
      segments.push_back({p - 1, p, fibre});
    }
  }
  return segments;
}

double diagonal(std::span<const float> points) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = points.empty() ? 0 : points[axis], high = low;
    for (std::size_t k = axis; k < points.size(); k += 3) {
      low = std::min(low, points[k]);
      high = std::max(high, points[k]);
    }
    squared += static_cast<double>(high - low) * static_cast<double>(high - low);
  }
  return std::sqrt(squared);
}

Quat euler(const Vec3& degrees) {
  const double radians = std::numbers::pi / 180;
  return axis_angle({0, 0, 1}, radians * degrees[2]) * axis_angle({0, 1, 0}, radians * degrees[1]) *
         axis_angle({1, 0, 0}, radians * degrees[0]);
}

bool same(const JointTransform& a, const JointTransform& b) {
  return a.translation == b.translation && a.rotation == b.rotation && a.scale == b.scale;
}

bool same(std::span<const Pose> a, std::span<const Pose> b) {
  return std::ranges::equal(a, b, [](const Pose& p, const Pose& q) {
    return p.controls == q.controls &&
           std::ranges::equal(p.joints, q.joints, [](const auto& s, const auto& t) { return same(s, t); });
  });
}

Clip bind_clip(const Basis& basis) {
  Clip clip;
  clip.name = "bind pose";
  clip.poses = {bind_pose(basis.skeleton)};
  return clip;
}

}  // namespace

Basis linear_part(Basis basis) {
  ResidualTable& residual = basis.residual;
  for (const Region& region : residual.regions) {
    const std::size_t columns = std::size_t{1} + region.feature_count + region.centre_count;
    for (std::uint32_t k = 0; k < region.coefficient_count; ++k) {
      const auto row = residual.weights.begin() + static_cast<std::ptrdiff_t>(region.weight_values + k * columns);
      std::fill(row + 1 + region.feature_count, row + static_cast<std::ptrdiff_t>(columns), 0.0f);
    }
  }
  return basis;
}

Character::Character(std::shared_ptr<const vulkan::Device> device, const CharacterFiles& files,
                     const ClipOptions& options)
    : device_(std::move(device)),
      files_(files),
      clip_options_(options),
      basis_(load_basis(files.basis)),
      clip_(bind_clip(basis_)),
      size_(diagonal(basis_.mesh.rest)) {
  const fs::path beside = fs::path(files.basis).replace_extension(".dynamics.safetensors");
  if (fs::exists(beside)) dynamics_ = load_dynamics(beside, basis_);
  const fs::path attached = fs::path(files.basis).replace_extension(".attached.safetensors");
  if (fs::exists(attached)) {
    worn_ = std::make_unique<WornMeshes>(*device_, basis_, load_attachments(attached, basis_));
  }
  triangles_ = vulkan::upload(*device_, basis_.mesh.triangles, "the triangles");
  const std::vector<Segment> segments = segments_of(basis_.strain);
  fibre_segments_ = vulkan::upload(*device_, segments, "the fibres");
  fibre_points_ = vulkan::upload(*device_, points_on_skin(basis_.strain), "the fibre points");
  fibre_segment_count_ = static_cast<std::uint32_t>(segments.size());
  if (!files.truth.empty()) open_truth(files.truth);
  if (files.clip.empty()) {
    measure_ground();
  } else {
    open_clip(files.clip);
  }
}

std::string Character::name() const { return fs::path(files_.basis).stem().string(); }

bool Character::has(Method method) const {
  if (method == Method::jiggle) return dynamics_.has_value();
  return method != Method::truth || truth_.has_value();
}

void Character::open_clip(const std::string& source) {
  Clip clip = read_clip(source, basis_.skeleton, clip_options_);
  arrange_controls(basis_.residual.controls, clip);
  if (clip.poses.empty()) throw Error(ErrorKind::file, source + ": the clip has no frame");
  clip_ = std::move(clip);
  files_.clip = source;
  measure_ground();
}

void Character::open_truth(const std::string& path) {
  Pc2Reader reader(path);
  if (reader.point_count() != basis_.mesh.output_count()) {
    throw Error(ErrorKind::mismatch, path + ": the cache has " + std::to_string(reader.point_count()) +
                                         " points, the character " + std::to_string(basis_.mesh.output_count()) +
                                         " vertices: it is of another character, or another level of it");
  }
  if (reader.sample_count() == 0) throw Error(ErrorKind::file, path + ": the cache has no sample");
  truth_.emplace(Truth{std::move(reader), -1, {}, {}});
  files_.truth = path;
}

Pose Character::pose(int frame, const ViewSettings::Posing& posing) const {
  const int number = std::clamp(frame, clip_.first_frame, clip_.last_frame());
  Pose pose = clip_.poses[static_cast<std::size_t>(number - clip_.first_frame)];
  for (const auto& [joint, degrees] : posing.joints) {
    const int index = basis_.skeleton.find(joint);
    if (index < 0) continue;
    Quat& rotation = pose.joints[static_cast<std::size_t>(index)].rotation;
    rotation = normalized(rotation * euler(degrees));
  }
  const std::vector<std::string>& controls = basis_.residual.controls;
  for (const auto& [control, value] : posing.controls) {
    const auto at = std::find(controls.begin(), controls.end(), control);
    if (at == controls.end()) continue;
    pose.controls.resize(controls.size(), 0.0f);
    pose.controls[static_cast<std::size_t>(at - controls.begin())] = static_cast<float>(value);
  }
  return pose;
}

Deformer& Character::deformer(Method method, Use use) {
  std::unique_ptr<Deformer>& made = deformers_[{method, use}];
  if (made) return *made;
  made = std::make_unique<Deformer>(method == Method::linear ? linear_part(basis_) : basis_,
                                    method == Method::jiggle ? dynamics_ : std::nullopt, JiggleOptions{}, device_);
  return *made;
}

const Evaluation& Character::evaluate(Method method, std::span<const Pose> poses, int frame, const Weights& weights) {
  Evaluated& last = evaluated_[method];
  if (method == Method::truth) {
    try {
      show_truth(frame);
    } catch (...) {
      truth_.reset();  // until it is read again
      throw;
    }
    return last.result;
  }
  if (method == Method::jiggle) poses = poses.first(1);
  if (frame == last.frame && weights == last.weights && same(poses, last.poses)) return last.result;
  last.poses.clear();  // should it throw
  Deformer& d = deformer(method, Use::show);
  d.set_weights({method == Method::ddm ? 0.0f : weights.correction, weights.jiggle});
  const bool carries = worn_ && (method == Method::full || method == Method::jiggle);
  if (carries) {  // the host needs the skin, too
    last.result = method == Method::jiggle ? d.jiggle(poses, {&frame, 1}) : d.evaluate(poses);
    worn_->carry(std::span(last.result.positions).first(std::size_t{3} * basis_.mesh.output_count()), poses[0].joints);
  } else {
    last.result = method == Method::jiggle ? d.jiggle_on_device(poses, {&frame, 1}) : d.evaluate_on_device(poses);
  }
  last.poses.assign(poses.begin(), poses.end());
  last.frame = frame;
  last.weights = weights;
  return last.result;
}

void Character::reset_jiggle() {
  const auto found = deformers_.find({Method::jiggle, Use::show});
  if (found != deformers_.end()) found->second->set_state({});
  evaluated_.erase(Method::jiggle);
}

ShownSkin Character::skin(Method method) const {
  if (method == Method::truth) return {&truth_->positions, &truth_->normals};
  const DeviceSkin skin = deformers_.at({method, Use::show})->device_skin();
  return {skin.positions, skin.normals};
}

std::vector<float> Character::measure(Method method, const Pose& pose, int frame) {
  if (method != Method::truth) return deformer(method, Use::measure).evaluate({&pose, 1}).positions;
  const std::optional<std::uint32_t> sample = truth_sample(frame);
  if (!sample) return {};
  return truth_->reader.read_sample(*sample);
}

std::optional<std::uint32_t> Character::truth_sample(int frame) const {
  const double at = (frame - static_cast<double>(truth_->reader.start_frame())) /
                    std::max(1e-6, static_cast<double>(truth_->reader.sample_rate()));
  if (at <= -0.5 || at >= truth_->reader.sample_count() - 0.5) return std::nullopt;
  return static_cast<std::uint32_t>(std::lround(at));
}

void Character::show_truth(int frame) {
  const double last = truth_->reader.sample_count() - 1.0;
  const double at = (frame - static_cast<double>(truth_->reader.start_frame())) /
                    std::max(1e-6, static_cast<double>(truth_->reader.sample_rate()));
  const int sample = static_cast<int>(std::lround(std::clamp(at, 0.0, last)));
  if (sample == truth_->shown) return;
  const std::vector<float> points = truth_->reader.read_sample(static_cast<std::uint32_t>(sample));
  std::vector<float> positions(basis_.mesh.rest.size()), normals(positions.size());
  for (std::size_t o = 0; o < basis_.mesh.output_vertex.size(); ++o) {
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(3 * o), 3,
                positions.begin() + static_cast<std::ptrdiff_t>(3 * basis_.mesh.output_vertex[o]));
  }
  cpu::output_normals(basis_.mesh, positions, normals);
  truth_->positions = vulkan::upload(*device_, positions, "the truth");
  truth_->normals = vulkan::upload(*device_, normals, "the truth's normals");
  truth_->shown = sample;
}

void Character::measure_ground() {
  const std::vector<float> positions = measure(Method::full, clip_.poses.front(), clip_.first_frame);
  double low = positions.empty() ? 0 : static_cast<double>(positions[1]);
  for (std::size_t k = 1; k < positions.size(); k += 3) low = std::min(low, static_cast<double>(positions[k]));
  ground_ = low;
}

}  // namespace bodyopt
