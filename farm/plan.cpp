#include "farm/plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/frame_range.h"
#include "assets/json_file.h"
#include "farm/check_show.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
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
    if (seconds <= kLongestShare * limit_ || count < 2) {
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
  const auto is_given = [&](const char* option) {
    const auto at = std::ranges::find(step.arguments, option);
    return at != step.arguments.end() && at + 1 != step.arguments.end() && !(at + 1)->starts_with("--");
  };
  for (const char* option : {is_given("--session") ? "--session" : "--clip", "--frames", "--out"}) {
    if (step.arguments[0] == "eval" && !is_given(option)) object.refuse("has arguments without '", option, "'");
  }
  step.frames = static_cast<std::size_t>(object.integer("frames", 0));
  step.seconds = object.number("seconds", 0, 1e12);
  step.is_delivered = object.boolean("delivered");
  return step;
}

fs::path plan_file(const fs::path& folder) { return folder / "plan.json"; }

}  // namespace

FarmPlan plan_show(const ShowList& list, double minutes_per_task, std::vector<std::string>& problems) {
  Planner planner(60 * minutes_per_task);
  for (const CheckedElement& checked : check_show(list, problems)) planner.add(checked);
  return planner.finish(list.show);
}

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
  const Json json = read_json(path, kPlanSchema);
  const JsonObject top(json, path, "the top level");
  top.allow({"schema", "show", "joins", "tasks"});
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

}  // namespace bodyopt
