// A frame of the database as tables and JSON name it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "assets/json_file.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::cli {

inline std::string frame_text(const PoseDatabase& database, std::size_t n) {
  const DatabaseFrame& frame = database.frames[n];
  return database.takes[static_cast<std::size_t>(frame.take)] + " " + std::to_string(frame.frame);
}

inline Json frame_json(const PoseDatabase& database, std::size_t n) {
  const DatabaseFrame& frame = database.frames[n];
  return {{"take", database.takes[static_cast<std::size_t>(frame.take)]}, {"frame", frame.frame}};
}

}  // namespace bodyopt::cli
