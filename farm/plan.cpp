#include "farm/plan.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <tuple>

#include "assets/caches/cache_writer.h"
#include "assets/caches/join_caches.h"
#include "assets/clips/bvh.h"
#include "assets/clips/clip.h"
#include "assets/clips/clip_source.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "base/written_over.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "shots/shot_files.h"

namespace bodyopt::farm {
namespace {

namespace fs = std::filesystem;

constexpr char kPlanSchema[] = "bodyopt-plan-1";
constexpr double kMillisecondsPerStep = 100;  // what a command takes beside its frames
constexpr double kLongestShare = 1.5;         // of a task's time: an element that takes longer is cut

// Frames of an element, and how it goes on from the part before it.
struct Part {
  std::vector<int> frames;
  std::string out, state_in, state_out;
};

double seconds_of(const CheckedElement& checked, std::size_t frames) {
  return 1e-3 * (checked.frame_ms * static_cast<double>(frames) + kMillisecondsPerStep);
}

FarmStep step_of(const CheckedElement& checked, const Part& part, bool is_first) {
  const ShowElement& element = *checked.element;
  FarmStep step{element.shot, element.element, {"eval", element.basis, "--clip", element.clip}, part.out};
  if (!element.session.empty()) step.arguments = {"eval", "--session", element.session};
  const auto add = [&](std::initializer_list<std::string> words) {
    step.arguments.insert(step.arguments.end(), words.begin(), words.end());
  };
  add({"--frames", format_frame_range(part.frames)});
  for (const auto& [option, words] : element.options) {
    if (option == "preroll" && !is_first) continue;
    add({"--" + option});
    step.arguments.insert(step.arguments.end(), words.begin(), words.end());
  }
  if (!part.state_in.empty()) add({"--state-in", part.state_in});
  if (!part.state_out.empty()) add({"--state-out", part.state_out});
  add({"--out", part.out, "--json", part.out + ".report.json", "--resume"});
  step.frames = part.frames.size();
  step.seconds = seconds_of(checked, step.frames);
  return step;
}

FarmStep join_of(const CheckedElement& checked, const std::vector<std::string>& parts, const std::string& out) {
  FarmStep step{checked.element->shot, checked.element->element, {"join"}, out};
  step.arguments.insert(step.arguments.end(), parts.begin(), parts.end());
  for (const std::string& word : {std::string("--out"), out, std::string("--resume")}) step.arguments.push_back(word);
  step.frames = 0;
  step.seconds = 1e-3 * kMillisecondsPerStep;
  step.is_delivered = true;
  return step;
}

// Parts of about equal length in a folder beside the output.
std::vector<Part> parts_of(const CheckedElement& checked, std::size_t count) {
  const fs::path out = checked.element->out, folder = fs::path(out) += ".parts";
  std::vector<Part> parts;
  for (std::size_t k = 0; k < count; ++k) {
    const auto begin = checked.frames.begin() + static_cast<std::ptrdiff_t>(k * checked.frames.size() / count);
    const auto end = checked.frames.begin() + static_cast<std::ptrdiff_t>((k + 1) * checked.frames.size() / count);
    Part part{{begin, end}, "", "", ""};
    const std::string stem =
        (folder / (std::to_string(part.frames.front()) + "_" + std::to_string(part.frames.back()))).string();
    part.out = stem + out.extension().string();
    if (checked.element->has("jiggle")) {
      if (k > 0) part.state_in = parts.back().state_out;
      if (k + 1 < count) part.state_out = stem + ".state";
    }
    parts.push_back(part);
  }
  return parts;
}

class Planner {
 public:
  explicit Planner(double seconds_per_task) : limit_(seconds_per_task) {}

  void add(const CheckedElement& checked) {
    const double seconds = seconds_of(checked, checked.frames.size());
    const auto count = std::min(checked.frames.size(), static_cast<std::size_t>(std::ceil(seconds / limit_)));
    const bool can_be_joined = can_join(checked.element->out) && !checked.element->has("rigged");
    if (seconds <= kLongestShare * limit_ || count < 2 || !can_be_joined) {
      FarmStep step = step_of(checked, {checked.frames, checked.element->out, "", ""}, true);
      step.is_delivered = true;
      return pack(std::move(step));
    }
    const std::vector<Part> parts = parts_of(checked, count);
    const bool is_chain = checked.element->has("jiggle");
    const int lane = is_chain ? lanes_++ : 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      FarmStep step = step_of(checked, parts[k], k == 0);
      if (is_chain) {
        tasks_.push_back({static_cast<int>(k), lane, {std::move(step)}});
      } else {
        pack(std::move(step));
      }
    }
    join(checked, parts);
  }

  FarmPlan finish(const std::string& show) {
    FarmPlan plan{show, std::move(tasks_), !joins_.empty()};
    int waves = 0;
    for (const FarmTask& task : plan.tasks) waves = std::max(waves, task.wave + 1);
    for (std::size_t k = 0; k < joins_.size(); ++k) {
      plan.tasks.push_back({waves, static_cast<int>(k), std::move(joins_[k])});
    }
    std::ranges::stable_sort(plan.tasks, [](const FarmTask& a, const FarmTask& b) {
      return std::pair(a.wave, a.lane) < std::pair(b.wave, b.lane);
    });
    return plan;
  }

 private:
  // Short steps share a task.
  void pack(FarmStep step) {
    if (open_ < 0 || filled_ + step.seconds > limit_) {
      open_ = static_cast<int>(tasks_.size());
      filled_ = 0;
      tasks_.push_back({0, lanes_++, {}});
    }
    filled_ += step.seconds;
    tasks_[static_cast<std::size_t>(open_)].steps.push_back(std::move(step));
  }

  void join(const CheckedElement& checked, const std::vector<Part>& parts) {
    std::vector<FarmStep>& steps = joins_.emplace_back();
    const auto add = [&](const std::string& extension) {
      std::vector<std::string> files;
      for (const Part& part : parts) files.push_back(fs::path(part.out).replace_extension(extension).string());
      steps.push_back(join_of(checked, files, fs::path(checked.element->out).replace_extension(extension).string()));
    };
    const std::string extension = fs::path(checked.element->out).extension().string();
    add(extension);
    for (const std::string& mesh : checked.attached) add("." + mesh + extension);
  }

  double limit_, filled_ = 0;
  int open_ = -1, lanes_ = 0;
  std::vector<FarmTask> tasks_;
  std::vector<std::vector<FarmStep>> joins_;
};

Json to_json(const FarmStep& step) {
  return {{"shot", step.shot},     {"element", step.element}, {"arguments", step.arguments},   {"out", step.out},
          {"frames", step.frames}, {"seconds", step.seconds}, {"delivered", step.is_delivered}};
}

FarmStep step_from(const JsonObject& object) {
  object.allow({"shot", "element", "arguments", "out", "frames", "seconds", "delivered"});
  FarmStep step{object.text("shot"), object.text("element"), {}, object.name("out")};
  for (const Json& word : object.array("arguments")) {
    if (!word.is_string()) object.refuse("has arguments that are no texts");
    step.arguments.push_back(word.get<std::string>());
  }
  if (step.arguments.size() < 2 || (step.arguments[0] != "eval" && step.arguments[0] != "join")) {
    object.refuse("has arguments of something else than 'eval' or 'join'");
  }
  for (const char* option : {step.option("--session").empty() ? "--clip" : "--session", "--frames", "--out"}) {
    if (step.arguments[0] == "eval" && step.option(option).empty()) {
      object.refuse("has arguments without '", option, "'");
    }
  }
  step.frames = static_cast<std::size_t>(object.integer("frames", 0));
  step.seconds = object.number("seconds", 0, 1e12);
  step.is_delivered = object.boolean("delivered");
  return step;
}

// Measured on one core of the machine of docs/notes (The farm): of the skin per vertex, of the jiggle per tetrahedron.
constexpr double kMillisecondsPerPoint = 7e-4, kMillisecondsPerTet = 4e-3;

// Reads each thing once; what could not be read is reported to every caller.
template <typename Key, typename Value>
class Once {
 public:
  template <typename Read>
  const Value& get(const Key& key, const Read& read) {
    auto found = values_.find(key);
    if (found == values_.end()) {
      found = values_.emplace(key, Entry{}).first;
      try {
        found->second.value.emplace(read());
      } catch (const Error& error) {
        found->second.failure.emplace(error);
      }
    }
    if (found->second.failure) throw Error(*found->second.failure);
    return *found->second.value;
  }

 private:
  struct Entry {
    std::optional<Value> value;
    std::optional<Error> failure;
  };
  std::map<Key, Entry> values_;
};

// Each part of a range begins after the end of the one before. None is all frames.
void require_rising(const std::string& range) {
  std::istringstream parts(range);
  std::optional<int> last;
  for (std::string part; std::getline(parts, part, ',');) {
    const std::vector<int> frames = parse_frame_range(part);
    if (last && frames.front() <= *last) {
      throw Error(ErrorKind::usage, "the parts of frames ", range, " overlap or are not in order");
    }
    last = frames.back();
  }
}

ClipOptions clip_options(const ShowElement& element) {
  ClipOptions options;
  options.fps = std::atof(element.option("fps", "24").c_str());
  options.first_frame = std::atoi(element.option("first-frame", "1").c_str());
  options.controls = element.option("controls", "");
  options.joint_map = element.option("joint-map", "");
  options.up = element.option("up", "");
  options.unit = std::atof(element.option("unit", "0").c_str());
  return options;
}

// What `eval` reads of the element.
shots::ShotFiles shot_files(const ShowElement& element) {
  shots::ShotFiles files;
  files.basis = element.basis;
  files.level = std::strtoul(element.option("level", "0").c_str(), nullptr, 10);
  files.clip = {element.clip, element.frames, clip_options(element)};
  files.character = element.option("character", "");
  files.modifiers = element.option("modifiers", "");
  files.attached = element.option("attached", "");
  files.jiggle.jiggle = element.has("jiggle");
  files.jiggle.dynamics = element.option("dynamics", "");
  if (!element.session.empty()) shots::take_session(element.session, files);
  return files;
}

// What tells one character from another: of an untrained one its session gives the unit and the first frame.
using CharacterKey = std::tuple<std::string, std::size_t, std::string, int>;

CharacterKey character_key(const shots::ShotFiles& files) {
  if (!files.is_untrained()) return {files.basis, files.level, "", 0};
  return {files.basis, files.level, files.session.file, files.clip.options.first_frame};
}

using ClipKey = std::tuple<std::string, std::string, double, int, double, std::string, std::string, std::string>;

ClipKey clip_key(const shots::ShotFiles& files) {
  const ClipOptions& options = files.clip.options;
  return {files.clip.source, files.basis,      options.fps,       options.first_frame,
          options.unit,      options.controls, options.joint_map, options.up};
}

std::string about(const ShowElement& element, const std::string& what) {
  return element.place + " (" + element.shot + ", " + element.element + "): " + what;
}

// What eval reads; of files that cannot be read, which is said where they are, their names alone.
std::vector<fs::path> inputs_of(const shots::ShotFiles& files) {
  try {
    return files.paths();
  } catch (const Error&) {
    return {files.basis, split_source(files.clip.source).path, files.character};
  }
}

// Reads what a clip tells without the character that it moves.
void require_clip(const shots::ClipChoice& clip) {
  if (clip.source.empty()) return;
  const fs::path path = split_source(clip.source).path;
  if (lower_case_extension(path) == ".bvh") {
    read_bvh(path);
  } else {
    clip_keys(clip.source, clip.options);
  }
}

class ShowChecker {
 public:
  explicit ShowChecker(std::vector<std::string>& problems) : problems_(problems) {}

  // Nothing where something is wrong with it. One fault does not hide another that does not follow from it.
  std::optional<CheckedElement> check(const ShowElement& element) {
    const std::size_t before = problems_.size();
    const auto try_to = [&](const auto& body) {
      try {
        body();
        return true;
      } catch (const Error& error) {
        problems_.push_back(about(element, error.what()));
        return false;
      }
    };
    CheckedElement checked{&element, {}, 0, {}};
    shots::ShotFiles files;
    const shots::OpenedCharacter* opened = nullptr;
    const bool is_placed = try_to([&] { check_output(element); });
    const bool are_rising = try_to([&] { require_rising(element.frames); });
    if (!try_to([&] { files = shot_files(element); })) return std::nullopt;
    try_to([&] {
      refuse_over("out", element.out, inputs_of(files));
      require_replaceable_cache(element.out);
    });
    if (!try_to([&] { opened = &characters_.get(character_key(files), [&] { return shots::open_level(files); }); })) {
      try_to([&] { require_clip(files.clip); });
      return std::nullopt;
    }
    const Basis& basis = opened->levels.front().basis;
    try_to([&] {
      const shots::ClipSpan& clip =
          clips_.get(clip_key(files), [&] { return shots::read_own_clip(files.clip, basis, opened->clip); });
      if (are_rising) checked.frames = shots::shot_frames(files, clip);
    });
    checked.frame_ms = kMillisecondsPerPoint * static_cast<double>(basis.mesh.output_count());
    try_to([&] {
      if (files.jiggle.jiggle) checked.frame_ms += kMillisecondsPerTet * tets(files, basis);
    });
    if (element.frame_ms > 0) checked.frame_ms = element.frame_ms;
    try_to([&] {
      checked.attached = attached_.get({character_key(files), files.attached}, [&] {
        return names_of(shots::read_attachments(files, basis, opened->attached).meshes);
      });
      if (!is_placed) return;  // where the skin cannot be, they cannot either
      for (const std::string& mesh : checked.attached) check_attached(element, mesh);
    });
    if (problems_.size() > before) return std::nullopt;
    checked.note = shots::missing_jiggle(files);
    return checked;
  }

 private:
  double tets(const shots::ShotFiles& files, const Basis& basis) {
    if (files.is_untrained()) shots::refuse_jiggle(files.session.file);
    const std::string file = files.jiggle.file(files.basis);
    return tets_.get({character_key(files), file},
                     [&] { return static_cast<double>(load_dynamics(file, basis).tets.tet_count()); });
  }

  void check_output(const ShowElement& element) {
    const fs::path out = element.out;
    if (const std::string wanted = missing_ending(element.out, kCacheEndings); !wanted.empty()) {
      throw Error(ErrorKind::usage, "out '", element.out, "' does not end in ", wanted);
    }
    const bool has_character = !element.option("character", "").empty() || !element.session.empty();
    if (!element.option("character", "").empty() && !holds_triangles(out)) {
      throw Error(ErrorKind::usage, "'character' is for an out that ends in .glb or .usda, not '", element.out, "'");
    }
    if (element.has("rigged") && (!holds_triangles(out) || !has_character)) {
      throw Error(ErrorKind::usage,
                  "'rigged' needs an out that ends in .glb or .usda, and 'character', which has weights");
    }
    if (element.out.find_first_of("#{}") != std::string::npos) {
      throw Error(
          ErrorKind::usage, "out '", element.out,
          "' holds '#' or an unknown {field}: known are {shot} and {element}; parts of a shot are named by the plan");
    }
    folders_.get(out.parent_path(), [&] {
      require_writable_folder(out.parent_path());
      return true;
    });
    claim(element.out, element);
  }

  void check_attached(const ShowElement& element, const std::string& mesh) {
    const fs::path out = element.out;
    const std::string file = fs::path(out).replace_extension("." + mesh + out.extension().string()).string();
    claim(file, element);
    require_replaceable_cache(file);
  }

  void claim(const std::string& file, const ShowElement& element) {
    const auto [known, is_new] = writers_.emplace(file, &element);
    if (is_new) return;
    throw Error(ErrorKind::usage, "writes ", file, ", as does ", known->second->place,
                ": give them names of their own, with {shot} and {element}");
  }

  std::vector<std::string>& problems_;
  Once<CharacterKey, shots::OpenedCharacter> characters_;
  Once<ClipKey, shots::ClipSpan> clips_;
  Once<std::pair<CharacterKey, std::string>, double> tets_;
  Once<std::pair<CharacterKey, std::string>, std::vector<std::string>> attached_;
  Once<fs::path, bool> folders_;
  std::map<std::string, const ShowElement*> writers_;
};

}  // namespace

std::vector<std::string> FarmStep::option(const std::string& name) const {
  auto at = std::ranges::find(arguments, name);
  std::vector<std::string> words;
  while (at != arguments.end() && ++at != arguments.end() && !at->starts_with("--")) words.push_back(*at);
  return words;
}

FarmPlan plan_show(const ShowList& list, double minutes_per_task, std::vector<std::string>& problems) {
  Planner planner(60 * minutes_per_task);
  std::vector<std::string> notes;
  for (const CheckedElement& checked : check_show(list, problems)) {
    planner.add(checked);
    if (!checked.note.empty()) notes.push_back(about(*checked.element, checked.note));
  }
  FarmPlan plan = planner.finish(list.show);
  plan.notes = std::move(notes);
  return plan;
}

fs::path plan_file(const fs::path& folder) { return folder / "plan.json"; }

void write_plan(const FarmPlan& plan, const fs::path& folder) {
  Json tasks = Json::array();
  for (const FarmTask& task : plan.tasks) {
    const Json steps = transformed(task.steps, [&](const FarmStep& step) { return to_json(step); });
    tasks.push_back({{"wave", task.wave}, {"lane", task.lane}, {"steps", steps}});
  }
  write_json({{"schema", kPlanSchema}, {"show", plan.show}, {"joins", plan.joins}, {"tasks", tasks}},
             plan_file(folder));
}

FarmPlan read_plan(const fs::path& folder) {
  const fs::path path = plan_file(folder);
  const JsonFile top(path, kPlanSchema, "the top level", {"schema", "show", "joins", "tasks"});
  FarmPlan plan{top.text("show"), {}, top.boolean("joins")};
  for (const JsonObject& object : top.objects("tasks")) {
    object.allow({"wave", "lane", "steps"});
    FarmTask task{object.integer("wave", 0), object.integer("lane", 0), {}};
    for (const Json& step : object.array("steps")) task.steps.push_back(step_from(JsonObject(step, path, "a step")));
    if (!plan.tasks.empty() &&
        std::pair(plan.tasks.back().wave, plan.tasks.back().lane) >= std::pair(task.wave, task.lane)) {
      object.refuse("is out of order");
    }
    plan.tasks.push_back(std::move(task));
  }
  return plan;
}

std::string number_ranges(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t end = k + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[k]);
    if (end - k > 1) text += "-" + std::to_string(numbers[end - 1]);
    k = end;
  }
  return text;
}

std::string quoted_for_shell(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<CheckedElement> check_show(const ShowList& list, std::vector<std::string>& problems) {
  ShowChecker checker(problems);
  std::vector<CheckedElement> checked;
  for (const ShowElement& element : list.elements) {
    if (std::optional<CheckedElement> sound = checker.check(element)) checked.push_back(std::move(*sound));
  }
  return checked;
}

}  // namespace bodyopt::farm
