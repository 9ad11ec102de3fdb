// Shapes by their names on command lines: a cache; DATASET#TAKE, one take of a dataset through its modifiers; or
// DATASET, all takes, numbered from 1.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "assets/caches/shape_reader.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::trainer {

// Is it the name of a dataset: a folder with a dataset.json, or that file?
bool is_dataset(const std::string& name);

// A '#' may be part of a cache's name. DATASET: a folder or its dataset.json. Of a take come the frames that are solved
// and not dropped, by rising number.
class NamedShapes {
 public:
  // Throws Error(file), and Error(mismatch) where the dataset has no such take, or it has no frame.
  explicit NamedShapes(const std::string& name) : NamedShapes(name, SpaceOf()) {}
  // Throws the same. `space_of`: un-posed space of a dataset's character where it is there, as it takes long to make.
  using SpaceOf = std::function<std::shared_ptr<const UnposedSpace>(const PoseDatabase& database)>;
  NamedShapes(const std::string& name, const SpaceOf& space_of);

  const std::string& name() const { return name_; }
  std::uint32_t point_count() const;
  std::uint32_t sample_count() const;
  float start_frame() const;
  float sample_rate() const;                                  // frames from one sample to the next
  const std::vector<int>& frames() const { return frames_; }  // of the samples; empty: as the cache says
  // Sample k: point_count x 3, metres. On any thread. Throws Error(file) at a damaged one, and where there is none.
  std::vector<float> sample(std::uint32_t k) const;

  // The shapes of a dataset, and which of its database's frames the samples are. Null and empty of a cache.
  const std::shared_ptr<const ShapeStack>& stack() const { return stack_; }
  const std::vector<std::size_t>& numbers() const { return numbers_; }
  bool is_whole() const { return is_dataset(name_); }
  // Sample k of a dataset, before any modifier.
  std::vector<float> raw_sample(std::uint32_t k) const;

  // Whether the dataset's stack was edited since. Never of a cache.
  bool was_edited() const;
  // Opens the files as they are now. Throws as the constructor, Error(mismatch) where they have other points.
  NamedShapes as_they_are() const;

 private:
  void open_dataset_frames(const std::filesystem::path& dataset, const std::string& take, const SpaceOf& space_of);
  std::size_t number_of(std::uint32_t k) const;

  std::string name_;
  std::shared_ptr<const ShapeReader> reader_;  // of a cache
  std::filesystem::path dataset_;              // its dataset.json, otherwise
  std::filesystem::file_time_type written_{};
  std::shared_ptr<const ShapeStack> stack_;
  std::vector<int> frames_;
  std::vector<std::size_t> numbers_;  // of the samples, in the database
};

}  // namespace bodyopt::trainer
