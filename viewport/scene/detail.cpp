#include "viewport/scene/detail.h"

#include <algorithm>
#include <cmath>

#include "draw/view.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

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

std::vector<draw::FibreSegment> segments_of(const StrainTable& strain) {
  std::vector<draw::FibreSegment> segments;
  for (std::uint32_t fibre = 0; fibre < strain.fibre_count(); ++fibre) {
    for (std::uint32_t p = strain.fibre_begin[fibre] + 1; p < strain.fibre_begin[fibre + 1]; ++p) {
      segments.push_back({p - 1, p, fibre});
    }
  }
  return segments;
}

double rms_distance(const CarriedSkin& carried) {
  double sum = 0;
  for (const CarriedPoint& point : carried.points) {
    for (const std::int16_t steps : {point.along_normal, point.along_edge, point.across})
      sum += static_cast<double>(steps) * steps;
  }
  return carried.empty() ? 0 : double{carried.step} * std::sqrt(sum / static_cast<double>(carried.size()));
}

// Another where a file is another.
std::string stamp_of(const std::vector<fs::path>& files) {
  std::string stamp;
  for (const fs::path& file : files) {
    std::error_code absent;
    const fs::file_time_type time = fs::last_write_time(file, absent);
    stamp += fs::weakly_canonical(file, absent).string() + '\n';
    if (fs::exists(file, absent)) {
      stamp += std::to_string(fs::file_size(file, absent)) + ' ' + std::to_string(time.time_since_epoch().count());
    }
    stamp += '\n';
  }
  return stamp;
}

// Weights select the method.
Weights weights_of(SkinMethod method, Weights weights) {
  if (method == SkinMethod::ddm) weights.correction = 0;
  weights.kernels = method != SkinMethod::linear;
  return weights;
}

bool same(const JointTransform& a, const JointTransform& b) {
  return a.translation == b.translation && a.rotation == b.rotation && a.scale == b.scale;
}

}  // namespace

LevelOnDevice::LevelOnDevice(const std::shared_ptr<const vulkan::Device>& device_, Level level,
                             std::optional<Dynamics> dynamics)
    : device(device_),
      model(make_character_model(std::move(level.basis), std::move(dynamics))),
      tables(device->only_draws() ? nullptr : std::make_shared<const vulkan::DeviceModel>(device, model)),
      following(basis(), {}, std::move(level.carried)),
      distance(rms_distance(following.full_skin())) {
  vulkan::Uploads uploads(*device);
  triangles = vulkan::upload(uploads, basis().mesh.triangles, "the triangles");
  const std::vector<draw::FibreSegment> segments = segments_of(basis().strain);
  fibre_segments = vulkan::upload(uploads, segments, "the fibres");
  fibre_points = vulkan::upload(uploads, points_on_skin(basis().strain), "the fibre points");
  uploads.finish();
  fibre_segment_count = static_cast<std::uint32_t>(segments.size());
  if (basis().coverage.empty()) return;
  expectation.emplace(basis());
  shares = RegionShares(basis());
}

std::unique_ptr<Deformer> LevelOnDevice::make_deformer(const std::optional<JiggleOptions>& jiggle) const {
  if (tables) return std::make_unique<Deformer>(tables, jiggle);
  return std::make_unique<Deformer>(model, device, jiggle);
}

LevelPool::Levels LevelPool::get(const std::vector<fs::path>& files, const std::function<Levels()>& make) {
  std::erase_if(made_, [](const auto& entry) { return entry.second.front().expired(); });
  const std::string stamp = stamp_of(files);
  Levels levels;
  if (const auto known = made_.find(stamp); known != made_.end()) {
    for (const auto& level : known->second) levels.push_back(level.lock());
    return levels;
  }
  levels = make();
  made_[stamp].assign(levels.begin(), levels.end());
  return levels;
}

LevelPool::Materials LevelPool::materials(const std::vector<fs::path>& files, const std::function<Materials()>& make) {
  std::erase_if(materials_, [](const auto& entry) { return entry.second.first.expired(); });
  auto& [known, images] = materials_[stamp_of(files)];
  Materials materials = known.lock();
  if (materials && stamp_of(materials->files) == images) return materials;
  known = materials = make();
  images = stamp_of(materials->files);
  return materials;
}

bool same(std::span<const Pose> a, std::span<const Pose> b) {
  return std::ranges::equal(a, b, [](const Pose& p, const Pose& q) {
    return p.controls == q.controls && p.modifiers == q.modifiers &&
           std::ranges::equal(p.joints, q.joints, [](const auto& s, const auto& t) { return same(s, t); });
  });
}

Detail::Detail(std::shared_ptr<const vulkan::Device> device, std::shared_ptr<const LevelOnDevice> level)
    : device_(std::move(device)), level_(std::move(level)) {}

Deformer& Detail::deformer(SkinMethod method, Use use) {
  std::unique_ptr<Deformer>& made = deformers_[{method, use}];
  if (!made && method == SkinMethod::jiggle) made = level_->make_deformer(JiggleOptions{});
  if (!made) made = level_->make_deformer();
  return *made;
}

// Returns nothing where the request equals the last.
std::optional<DeformerCall> Detail::call_of(const SkinRequest& request) {
  Evaluated& last = evaluated_[request.method];
  const bool again = request.frame == last.frame && request.weights == last.weights && request.host <= last.host &&
                     same(request.poses, last.poses);
  if (again) return std::nullopt;
  last.poses.clear();  // should it fail
  Deformer& d = deformer(request.method, Use::show);
  d.set_weights(weights_of(request.method, request.weights));
  d.require_one_batch(request.poses);  // what is drawn is on the device
  DeformerCall call{.deformer = &d, .poses = request.poses, .stays_on_device = !request.host, .is_one_batch = true};
  if (request.method == SkinMethod::jiggle) call.frames = {&request.frame, 1};
  return call;
}

void Detail::keep(const SkinRequest& request, Evaluation result) {
  evaluated_[request.method] = {request.poses, request.frame,  request.weights,
                                request.host,  ++evaluations_, std::move(result)};
}

void evaluate_together(std::span<const SkinRequest> requests) {
  std::vector<const SkinRequest*> anew;
  std::vector<DeformerCall> calls;
  for (const SkinRequest& request : requests) {
    const std::optional<DeformerCall> call = request.detail->call_of(request);
    if (!call) continue;
    anew.push_back(&request);
    calls.push_back(*call);
  }
  std::exception_ptr error;
  std::vector<Evaluation> results(calls.size());
  for (std::size_t k = 0; k < calls.size(); ++k) calls[k].evaluation = &results[k];
  evaluate_together(calls);
  for (std::size_t k = 0; k < anew.size(); ++k) {
    if (!calls[k].error) {
      anew[k]->detail->keep(*anew[k], std::move(results[k]));
    } else if (!error) {
      error = calls[k].error;
    }
  }
  if (error) std::rethrow_exception(error);
}

const ExpectedSkin& Detail::expected_skin(SkinMethod method) {
  const Evaluated& of = last(method);
  if (expected_ && expected_->first == of.number) return expected_->second;
  const ExpectedError error = level_->expectation->of(of.result, 0);
  std::vector<float> vertices = level_->shares.carry(error.region_mm);
  ExpectedSkin skin{error.rms_mm, 0, 0, vulkan::upload(*device_, vertices, "expected errors")};
  if (!vertices.empty()) {
    skin.largest_mm = 1e3 * double{*std::ranges::max_element(vertices)};
    const auto p99 = vertices.begin() + static_cast<std::ptrdiff_t>(99 * (vertices.size() - 1) / 100);
    std::ranges::nth_element(vertices, p99);
    skin.p99_mm = 1e3 * double{*p99};
  }
  return expected_.emplace(of.number, std::move(skin)).second;
}

DeviceSkin Detail::skin(SkinMethod method) const { return deformers_.at({method, Use::show})->device_skin(); }

void Detail::reset_jiggle() {
  const auto found = deformers_.find({SkinMethod::jiggle, Use::show});
  if (found != deformers_.end()) found->second->set_state({});
  const auto last = evaluated_.find(SkinMethod::jiggle);
  if (last != evaluated_.end()) last->second.poses.clear();  // is evaluated again
}

std::optional<int> Detail::jiggle_frame() const {
  const auto last = evaluated_.find(SkinMethod::jiggle);
  return last != evaluated_.end() ? std::optional(last->second.frame) : std::nullopt;
}

Evaluation Detail::measure(SkinMethod method, const Pose& pose, float correction) {
  Deformer& d = deformer(method == SkinMethod::jiggle ? SkinMethod::full : method, Use::measure);
  d.set_weights(weights_of(method, {.correction = correction}));
  return d.evaluate({&pose, 1});
}

// N x 3, metres, world.
std::vector<float> Detail::tet_nodes(const Pose& pose, std::optional<float> jiggle) {
  Deformer& d = deformer(SkinMethod::jiggle, jiggle ? Use::show : Use::measure);
  if (!jiggle && !same(tet_poses_, {&pose, 1})) {  // without a past: where the skin takes them
    const int frame = 0;
    d.set_state({});
    d.jiggle({&pose, 1}, {&frame, 1});
    tet_poses_ = {pose};
  }
  const JiggleState state = d.state();
  std::vector<float> nodes(state.motion.nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const float away = jiggle.value_or(0) * state.motion.displacement[k];
    nodes[k] = static_cast<float>(state.origin[k % 3] + static_cast<double>(state.motion.nodes[k] + away));
  }
  return nodes;
}

const CutTets& Detail::cut_tets(const Pose& pose, std::optional<float> jiggle, const Vec3& towards, double share) {
  if (!cut_tets_) cut_tets_ = std::make_unique<CutTets>(*device_, *level_->model->dynamics);
  cut_tets_->cut(tet_nodes(pose, jiggle), towards, share);
  return *cut_tets_;
}

std::size_t DetailChoice::choose(double seconds, bool playing, std::size_t count) {
  if (!playing || count <= 1) {
    sum_ = pictures_ = 0;
    return 0;
  }
  level_ = std::min(level_, count - 1);
  sum_ += seconds;
  ++pictures_;
  if (sum_ < kPatience) return level_;
  const double mean = sum_ / pictures_;
  waited_ += sum_;
  sum_ = pictures_ = 0;
  if (mean > 1 / kRate && level_ + 1 < count) {
    if (has_tried_) retry_ = std::min(2 * retry_, kLongestRetry);
    too_slow_ = level_;
    waited_ = 0;
    ++level_;
  } else if (mean < 0.5 / kRate && level_ > 0) {
    const bool was_too_slow = too_slow_ && level_ - 1 <= *too_slow_;
    if (was_too_slow && waited_ < retry_) return level_;
    has_tried_ = was_too_slow;
    --level_;
  }
  return level_;
}

}  // namespace bodyopt::viewport
