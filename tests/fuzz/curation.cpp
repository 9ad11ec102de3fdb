// What artists and their programs write for curation and transfer: the history of a stack, frames that were given out,
// sculpted ones, markers.
#include <fstream>

#include "dataset/modifier.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/small_limb.h"
#include "trainer/curate/exported_frames.h"
#include "trainer/curate/frame_files.h"
#include "trainer/transfer/markers_file.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;

// The dataset of which the history is.
std::filesystem::path small_dataset() {
  return as_file("dataset.json", R"({"schema": "bodyopt-dataset-1", "character": "c.glb", "takes": [], "modifiers": [
 {"name": "smooth", "type": "smooth", "strength": 0.5}]})");
}

std::vector<std::string> history_seeds() {
  return {R"({"schema": "bodyopt-modifier-history-1", "now": 1, "states": [[], [{"name": "smooth", "type": "smooth",
 "enabled": true, "strength": 0.5, "frames": ["1-5"], "mask": {"joints": ["a"]}, "parameters": {"steps": 3}}]]})"};
}
void read_history_file(const std::string& bytes) {
  const std::filesystem::path path = small_dataset(), folder = path.parent_path() / "modifiers";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "history.json", std::ios::binary).write(bytes.data(), std::ssize(bytes));
  undo_modifiers(path);
}

constexpr const char* kExport =
    R"("take": "rom", "frame": 7, "skin": "modifiers/exported-0123456789abcdef.pc2", "modifiers": [{"name": "smooth",
 "type": "smooth", "enabled": true, "strength": 0.5, "frames": [], "mask": {}, "parameters": {"radius_mm": 3}}]})";

std::vector<std::string> export_seeds() {
  return {R"({"schema": "bodyopt-exported-frame-1", )" + std::string(kExport)};
}
void read_export(const std::string& bytes) { read_export_file(as_file("000001-exported.json", bytes)); }

std::vector<std::string> exports_seeds() {
  return {R"({"schema": "bodyopt-exported-frames-1", "frames": [{)" + std::string(kExport) + "]}"};
}
void read_exports(const std::string& bytes) { read_export_file(as_file("exported.json", bytes)); }

std::vector<std::string> obj_seeds() {
  std::vector<float> points;
  for (const std::uint32_t v : limb().output_vertex) {
    for (int i = 0; i < 3; ++i) points.push_back(static_cast<float>(limb().vertices(v, i)));
  }
  return {written("frame.obj", [&](const auto& path) { write_frame_obj(limb(), {}, points, path); })};
}
void read_obj_file(const std::string& bytes) {
  const WrittenSkin written{limb().vertices};
  require_finite(read_frame_mesh(limb(), {}, {&written, 1}, as_file("frame.obj", bytes)).positions, "points");
}

std::vector<std::string> markers_seeds() {
  return {R"({"schema": "bodyopt-markers-1", "markers": [{"source": 3, "target": 5}, {"source": 4, "target": 0}]})"};
}
void read_markers_file(const std::string& bytes) { read_markers(as_file("markers.json", bytes)); }

const bool added =
    add_target({"modifier_history", history_seeds, read_history_file}) &&
    add_target({"export", export_seeds, read_export}) && add_target({"exports", exports_seeds, read_exports}) &&
    add_target({"obj", obj_seeds, read_obj_file}) && add_target({"markers", markers_seeds, read_markers_file});

}  // namespace
}  // namespace bodyopt::fuzz
