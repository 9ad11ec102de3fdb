// Lists of shots, plans, and what lies beside outputs.
#include <nlohmann/json.hpp>

#include "farm/plan.h"
#include "farm/show_list.h"
#include "farm/task_run.h"
#include "runtime/core/error.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

using namespace farm;

void read_list(const std::string& name, const std::string& bytes) {
  std::vector<std::string> problems;
  for (const ShowElement& element : read_show_list(as_file(name, bytes), problems).elements) {
    require_finite(std::vector{element.frame_ms}, "milliseconds");
  }
}

std::vector<std::string> json_seeds() {
  return {R"({"schema": "bodyopt-shots-1", "show": "s", "defaults": {"basis": "b.safetensors", "clip": "c.glb#walk",
 "out": "{shot}/{element}.pc2", "jiggle": true}, "elements": [{"shot": "a", "element": "e", "frames": "1-9x2,12",
 "frame_ms": 8.5, "gravity_change": [0, -1.5, 0], "level": 1, "controls": "k.json"}]})"};
}
void read_json_list(const std::string& bytes) { read_list("shots.json", bytes); }

std::vector<std::string> lines_seeds() {
  return {R"({"defaults": {"basis": "b.safetensors", "clip": "c.glb", "out": "{shot}.usda"}}

{"shot": "a", "element": "e", "frames": "1-5"}
)"};
}
void read_lines_list(const std::string& bytes) { read_list("shots.jsonl", bytes); }

std::vector<std::string> csv_seeds() {
  return {
      "shot,element,basis,clip,out,jiggle,frames,gravity_change\r\n*,e,b.safetensors,c.glb,{shot}.pc2,true,,\r\n"
      "\"a, \"\"b\"\"\n\",,,,,,1-5,\r\nc,,,,,false,,0 -1.5 0\r\n"};
}
void read_csv_list(const std::string& bytes) { read_list("shots.csv", bytes); }

FarmPlan small_plan(const std::string& out) {
  FarmStep part{"a", "e", {"eval", "b.safetensors", "--clip", "c.glb", "--frames", "1-9", "--out", out}, out, 9, 1.5};
  FarmStep join{"a", "e", {"join", out, "--out", "a.pc2"}, "a.pc2", 0, 0.1, true};
  return {"show", {{0, 0, {part}}, {1, 0, {join}}}, true};
}

std::vector<std::string> plan_seeds() {
  const std::filesystem::path path = as_file("plan.json", "");
  write_plan(small_plan("a.pc2"), path.parent_path());
  return {testing::read_bytes(path)};
}
void read_plan_file(const std::string& bytes) {
  const FarmPlan plan = read_plan(as_file("plan.json", bytes).parent_path());
  summarize_show(plan, status_of(plan, "1", false), 3);
}

// Records are never refused: what cannot be read was not done.
const std::string kOutput = "output.pc2";

FarmStep recorded_step() { return small_plan(as_file(kOutput, "cache").string()).tasks[0].steps[0]; }

std::vector<std::string> record_seeds() {
  const FarmStep step = recorded_step();
  TaskRun(step.out, "1", {step.arguments.begin() + 1, step.arguments.end()}, {step.out})
      .finish({step.out}, Json::parse(R"({"seconds": 2.5, "peak_memory_mib": 100, "worst_outside": 1.5, "device": "CPU",
        "outside_frames": "2-3", "worth_a_look": [{"frame": 3, "expected_rms_mm": 2.5, "outside": 0.5}]})"));
  return {testing::read_bytes(done_beside(step.out))};
}
void read_record_file(const std::string& bytes) {
  const FarmStep step = recorded_step();
  as_file(kOutput + ".done.json", bytes);
  FarmPlan plan = small_plan(step.out);
  for (const WorthyFrame& frame : summarize_show(plan, status_of(plan, "1", true), 3).worth_a_look) {
    require_finite(std::vector{frame.expected_rms_mm, frame.outside}, "frames worth a look");
  }
}

std::vector<std::string> failure_seeds() {
  const FarmStep step = recorded_step();
  TaskRun(step.out, "1", {step.arguments.begin() + 1, step.arguments.end()}, {step.out})
      .fail(Error(ErrorKind::mismatch, "no"));
  return {testing::read_bytes(failed_beside(step.out))};
}
void read_failure_file(const std::string& bytes) {
  const FarmStep step = recorded_step();
  as_file(kOutput + ".failed.json", bytes);
  read_failure(step.out);
}

const bool added = add_target({"shots_json", json_seeds, read_json_list}) &&
                   add_target({"shots_jsonl", lines_seeds, read_lines_list}) &&
                   add_target({"shots_csv", csv_seeds, read_csv_list}) &&
                   add_target({"farm_plan", plan_seeds, read_plan_file}) &&
                   add_target({"done_record", record_seeds, read_record_file}) &&
                   add_target({"failed_record", failure_seeds, read_failure_file});

}  // namespace
}  // namespace bodyopt::fuzz
