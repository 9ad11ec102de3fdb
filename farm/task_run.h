// One piece of work that is done once: skipped where it is done, taken up where it was interrupted, and recorded.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "farm/task_record.h"
#include "runtime/core/error.h"

namespace bodyopt {

// What an interrupted run left in the folder FILE.checkpoint.
struct Checkpoint {
  std::size_t frames = 0;  // that are done
  Json log;                // what is known of them
};

class TaskRun {
 public:
  // Reads the inputs. Throws Error(file).
  TaskRun(std::filesystem::path output, const std::string& version, const std::vector<std::string>& arguments,
          const std::vector<std::filesystem::path>& inputs);

  // The record of the same work on the same inputs, where its outputs are what they were. `outputs` must be among them.
  std::optional<TaskRecord> done(const std::vector<std::filesystem::path>& outputs) const;
  // Throws Error(interrupted) where an input is another than when this began: what was made of it is of neither.
  void require_same_inputs() const;
  void finish(const std::vector<std::filesystem::path>& outputs, const Json& summary) const;
  // Says beside the output why there is none. Not of interruptions.
  void fail(const Error& error) const;

  std::filesystem::path checkpoint_folder() const;
  // `files`: in that folder, written already; all that taking up needs.
  void write_checkpoint(const Checkpoint& checkpoint, const std::vector<std::filesystem::path>& files) const;
  // Nothing where there is none of this work and these inputs, or where one of its files is damaged.
  std::optional<Checkpoint> read_checkpoint() const;
  void remove_checkpoint() const;

 private:
  std::filesystem::path output_;
  TaskKey key_;
};

}  // namespace bodyopt
