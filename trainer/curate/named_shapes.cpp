#include "trainer/curate/named_shapes.h"

#include <algorithm>
#include <optional>

#include "assets/caches/pc2.h"
#include "base/wording.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

// A dataset.json, and the take of it; an empty one means all. Nothing where it is no name of a dataset.
std::optional<std::pair<fs::path, std::string>> split_take(const std::string& name) {
  const std::size_t mark = name.rfind('#');
  const bool has_take = mark != std::string::npos && !fs::exists(name);
  const std::string folder = has_take ? name.substr(0, mark) : name;
  if (!is_dataset(folder)) return std::nullopt;
  return std::pair(fs::is_directory(folder) ? fs::path(folder) / "dataset.json" : fs::path(folder),
                   has_take ? name.substr(mark + 1) : "");
}

bool same_weights(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b) {
  return std::ranges::equal(
      a, b, [](const JointWeight& x, const JointWeight& y) { return x.joint == y.joint && x.weight == y.weight; });
}

// Un-posed space is of both then.
bool have_one_skin(const Character& a, const Character& b) {
  return skeleton_hash(a.skeleton) == skeleton_hash(b.skeleton) && a.vertices.rows() == b.vertices.rows() &&
         a.vertices == b.vertices && a.triangles.rows() == b.triangles.rows() && a.triangles == b.triangles &&
         std::ranges::equal(a.weights, b.weights, same_weights);
}

}  // namespace

bool is_dataset(const std::string& name) {
  const fs::path path = name;
  return fs::is_directory(path) ? fs::exists(path / "dataset.json")
                                : path.filename() == "dataset.json" && fs::exists(path);
}

NamedShapes::NamedShapes(const std::string& name, const SpaceOf& space_of) : name_(name) {
  if (const auto take = split_take(name)) {
    open_dataset_frames(take->first, take->second, space_of);
  } else {
    reader_ = std::make_shared<const ShapeReader>(name);
  }
}

void NamedShapes::open_dataset_frames(const fs::path& dataset, const std::string& take, const SpaceOf& space_of) {
  dataset_ = dataset;
  std::error_code none;  // reported when it is read
  written_ = fs::last_write_time(dataset, none);
  PoseDatabase read = read_pose_database(read_dataset(dataset));
  std::shared_ptr<const UnposedSpace> space = space_of ? space_of(read) : nullptr;
  stack_ = std::make_shared<const ShapeStack>(std::move(read), std::move(space));
  const PoseDatabase& database = stack_->database();
  const int number = take.empty() ? -1 : database.take_named(take, name_);
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    const bool is_asked = take.empty() || database.frames[n].take == number;
    if (is_asked && !stack_->is_dropped(n)) numbers_.push_back(n);
  }
  if (numbers_.empty()) throw Error(ErrorKind::mismatch, name_, ": no frame of it is solved and not dropped");
  if (!take.empty()) {
    std::ranges::sort(
        numbers_, [&](std::size_t a, std::size_t b) { return database.frames[a].frame < database.frames[b].frame; });
  }
  for (const std::size_t n : numbers_) {
    frames_.push_back(take.empty() ? static_cast<int>(frames_.size()) + 1 : database.frames[n].frame);
  }
}

std::uint32_t NamedShapes::point_count() const {
  return reader_ ? reader_->point_count() : stack_->database().character.output_count();
}

std::uint32_t NamedShapes::sample_count() const {
  return reader_ ? reader_->sample_count() : static_cast<std::uint32_t>(frames_.size());
}

float NamedShapes::start_frame() const {
  return reader_ ? reader_->start_frame() : static_cast<float>(frames_.front());
}

float NamedShapes::sample_rate() const { return reader_ ? reader_->sample_rate() : frame_spacing(frames_); }

std::size_t NamedShapes::number_of(std::uint32_t k) const {
  if (k < numbers_.size()) return numbers_[k];
  throw Error(ErrorKind::file, name_, ": it has ", numbers_.size(), " frames now, asked for the ", k + 1,
              "th: some were dropped meanwhile");
}

std::vector<float> NamedShapes::sample(std::uint32_t k) const {
  if (reader_) return reader_->sample(k);
  return output_from_welded(stack_->database().character, stack_->shape(number_of(k)));
}

std::vector<float> NamedShapes::raw_sample(std::uint32_t k) const {
  return output_from_welded(stack_->database().character, stack_->begun(number_of(k)));
}

bool NamedShapes::was_edited() const {
  std::error_code gone;
  return !reader_ && fs::last_write_time(dataset_, gone) != written_;
}

NamedShapes NamedShapes::as_they_are() const {
  if (!reader_ && !was_edited()) return *this;
  NamedShapes now(name_, [this](const PoseDatabase& database) {
    const bool is_of = stack_ && have_one_skin(stack_->database().character, database.character);
    return is_of ? stack_->made_space() : nullptr;
  });
  if (now.point_count() == point_count()) return now;
  throw Error(ErrorKind::mismatch, name_, ": it was written anew with ", now.point_count(), " points, it had ",
              point_count());
}

}  // namespace bodyopt::trainer
