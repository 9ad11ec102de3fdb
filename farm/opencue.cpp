#include "farm/opencue.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostLayers = 1000, kMostFrames = 100'000;
constexpr char kFrameToken[] = "#IFRAME#";  // the frame's number, in a command

bool is_name(const std::string& text) {
  return text.size() >= 3 && std::ranges::all_of(text, [](unsigned char c) {
           return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '.');
         });
}

// As OpenCue takes names.
std::string cue_name(const std::string& text) {
  std::string name;
  for (const unsigned char c : text.substr(0, 60)) {
    name += c < 128 && std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  while (name.size() < 3) name += '_';
  return name;
}

std::string layer_name(int wave) { return "wave" + std::to_string(wave); }

void put(pugi::xml_node parent, const char* name, const std::string& text) {
  parent.append_child(name).text().set(text.c_str());
}

void add_layer(pugi::xml_node layers, int wave, const std::vector<int>& lanes, const std::string& command,
               const TaskNeeds& needs) {
  pugi::xml_node layer = layers.append_child("layer");
  layer.append_attribute("name") = layer_name(wave).c_str();
  layer.append_attribute("type") = "Render";
  put(layer, "cmd", command + " " + std::to_string(wave) + "." + kFrameToken);
  put(layer, "range", number_ranges(lanes));
  put(layer, "chunk", "1");
  put(layer, "cores", std::to_string(needs.cpus) + ".0");
  put(layer, "threadable", needs.cpus > 1 ? "True" : "False");
  if (needs.tasks_per_gpu == 1) put(layer, "gpus", "1");
  pugi::xml_node threads = layer.append_child("env").append_child("key");
  threads.append_attribute("name") = "OMP_NUM_THREADS";
  threads.text().set(needs.cpus);
}

void add_dependency(pugi::xml_node depends, const std::string& job, int wave, int on, const char* type) {
  pugi::xml_node depend = depends.append_child("depend");
  depend.append_attribute("type") = type;
  put(depend, "depjob", job);
  put(depend, "deplayer", layer_name(wave));
  put(depend, "onjob", job);
  put(depend, "onlayer", layer_name(on));
}

class OpencueChecker {
 public:
  std::vector<std::string> check(const std::string& xml) {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_string(xml.c_str());
    require(static_cast<bool>(result), std::string("it is no XML: ") + result.description());
    const pugi::xml_node spec = document.child("spec"), job = spec.child("job");
    in_order(spec, {"show", "shot", "user", "job", "depends"});
    for (const char* child : {"show", "shot", "user"}) name(spec.child(child).text().get(), child);
    require(spec.child("user").text().get() != std::string("root"), "no job may be root's");
    in_order(job, {"paused", "layers"});
    name(job.attribute("name").value(), "job");
    for (const pugi::xml_node layer : job.child("layers").children()) check_layer(layer);
    require(!layers_.empty() && layers_.size() <= kMostLayers, "there are no layers, or more than 1,000");
    require(frames_ <= kMostFrames, "there are more than 100,000 frames");
    for (const pugi::xml_node depend : spec.child("depends").children()) check_dependency(depend);
    return problems_;
  }

 private:
  void require(bool holds, const std::string& problem) {
    if (!holds) problems_.push_back(problem);
  }

  void name(const std::string& text, const std::string& whose) {
    require(is_name(text), "'" + text + "' is no name of a " + whose + ": 3 or more letters, digits, '.' and '_'");
  }

  void in_order(const pugi::xml_node& node, const std::vector<std::string>& names) {
    std::size_t at = 0;
    for (const pugi::xml_node child : node.children()) {
      const auto found = std::find(names.begin() + static_cast<std::ptrdiff_t>(at), names.end(), child.name());
      require(found != names.end(), std::string(node.name()) + " has an unknown or misplaced " + child.name());
      if (found != names.end()) at = static_cast<std::size_t>(found - names.begin());
    }
  }

  void check_layer(const pugi::xml_node& layer) {
    const std::string own = layer.attribute("name").value(), cores = layer.child("cores").text().get();
    name(own, "layer");
    require(layers_.insert(own).second, "two layers are called " + own);
    in_order(layer, {"cmd", "range", "chunk", "cores", "threadable", "gpus", "env"});
    require(cores.find('.') != std::string::npos, own + " has cores without a decimal point: those are hundredths");
    check_command(own, layer.child("cmd").text().get());
    count_frames(own, layer.child("range").text().get());
  }

  void check_command(const std::string& own, const std::string& command) {
    const std::size_t at = command.find(kFrameToken);
    require(at != std::string::npos && std::ranges::count(command, '#') == 2,
            own + "'s command does not hold #IFRAME# once and no other '#', which OpenCue would replace");
    require(std::ranges::none_of(command, [](unsigned char c) { return c < ' ' || c == 127; }),
            own + "'s command holds a control character");
  }

  void count_frames(const std::string& own, const std::string& range) {
    std::istringstream parts(range);
    std::size_t frames = 0;
    for (std::string part; std::getline(parts, part, ',');) {
      unsigned first = 0, last = 0;
      char end = 0;
      const int found = std::sscanf(part.c_str(), "%u-%u%c", &first, &last, &end);
      const bool is_one = found == 1 && part.find_first_not_of("0123456789") == std::string::npos;
      const bool is_range = found == 2 && last > first;
      require(is_one || is_range, own + " has the range '" + range + "', expected such as 1-5,7");
      frames += is_range ? last - first + 1 : 1;
    }
    require(frames > 0, own + " has no frames");
    frames_ += frames;
  }

  void check_dependency(const pugi::xml_node& depend) {
    in_order(depend, {"depjob", "deplayer", "onjob", "onlayer"});
    const std::string one = depend.child("deplayer").text().get(), other = depend.child("onlayer").text().get();
    const std::string type = depend.attribute("type").value();
    require(type == "LAYER_ON_LAYER" || type == "FRAME_BY_FRAME", "a dependency is of the type '" + type + "'");
    require(one != other && layers_.contains(one) && layers_.contains(other),
            "'" + one + "' depends on '" + other + "': not two layers of the job");
  }

  std::set<std::string> layers_;
  std::size_t frames_ = 0;
  std::vector<std::string> problems_;
};

}  // namespace

std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs) {
  if (needs.tasks_per_gpu > 1) {
    throw Error(ErrorKind::usage,
                "OpenCue knows shares of a GPU by their memory alone: ask for a whole one for each "
                "task (1), or for none");
  }
  std::map<int, std::vector<int>> waves;
  for (const FarmTask& task : plan.tasks) waves[task.wave].push_back(task.lane);
  const std::string job_name = "bodyopt_" + cue_name(plan.show);
  pugi::xml_document document;
  document.append_child(pugi::node_doctype)
      .set_value("spec PUBLIC \"SPI Cue  Specification Language\" \"http://localhost:8080/spcue/dtd/cjsl-1.13.dtd\"");
  pugi::xml_node spec = document.append_child("spec");
  put(spec, "show", cue_name(plan.show));
  put(spec, "shot", "farm");
  put(spec, "user", user);
  pugi::xml_node job = spec.append_child("job");
  job.append_attribute("name") = job_name.c_str();
  put(job, "paused", "False");
  pugi::xml_node layers = job.append_child("layers"), depends = spec.append_child("depends");
  const std::string command = quoted_for_shell(program) + " farm run " + quoted_for_shell(folder.string());
  const int join_wave = plan.joins ? plan.wave_count() - 1 : -1;
  for (const auto& [wave, lanes] : waves) {
    add_layer(layers, wave, lanes, command, needs);
    if (wave == join_wave) {
      for (int before = 0; before < wave; ++before) {
        add_dependency(depends, job_name, wave, before, "LAYER_ON_LAYER");
      }
    } else if (wave > 0) {
      add_dependency(depends, job_name, wave, wave - 1, "FRAME_BY_FRAME");
    }
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

std::vector<std::string> check_opencue(const std::string& xml) { return OpencueChecker().check(xml); }

}  // namespace bodyopt
