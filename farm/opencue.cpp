#include "farm/opencue.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostLayers = 1000, kMostFrames = 100'000;
constexpr char kLayerRule[] = "there are no layers, or more than 1,000";
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

std::map<int, std::vector<int>> lanes_by_wave(const FarmPlan& plan) {
  std::map<int, std::vector<int>> waves;
  for (const FarmTask& task : plan.tasks) waves[task.wave].push_back(task.lane);
  return waves;
}

}  // namespace

std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs) {
  if (needs.tasks_per_gpu > 1) {
    throw Error(ErrorKind::usage,
                "OpenCue knows shares of a GPU by their memory alone: ask for a whole one for each "
                "task (1), or for none");
  }
  const std::map<int, std::vector<int>> waves = lanes_by_wave(plan);
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

std::string opencue_problem(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                            const std::string& user) {
  if (!is_name(user)) return "'" + user + "' is no name of a user: 3 or more letters, digits, '.' and '_'";
  if (user == "root") return "no job may be root's";
  const std::size_t layers = lanes_by_wave(plan).size();
  if (layers == 0) return kLayerRule;
  const std::string first = layer_name(plan.tasks.front().wave), words = program + folder.string();
  if (words.find('#') != std::string::npos) {
    return first + "'s command does not hold #IFRAME# once and no other '#', which OpenCue would replace";
  }
  if (std::ranges::any_of(words, [](unsigned char c) { return c < ' ' || c == 127; })) {
    return first + "'s command holds a control character";
  }
  if (layers > kMostLayers) return kLayerRule;
  return plan.tasks.size() > kMostFrames ? "there are more than 100,000 frames" : "";
}

}  // namespace bodyopt
