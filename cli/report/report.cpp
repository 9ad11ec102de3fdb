#include "cli/report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "cli/report/report_page.h"
#include "runtime/basis/atomic_file.h"
#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

using Json = nlohmann::ordered_json;

Json errors(const MethodReport& method) {
  return {{"rms", method.rms}, {"p99", method.p99}, {"max", method.max}, {"jitter", method.jitter}};
}

Json curves(const ReportData& data) {
  Json json = {{"frames", data.heldout_frame_numbers}};
  const auto add = [&](const char* name, const MethodReport& method) {
    json[name] = {{"rms", method.frame_rms}, {"max", method.frame_max}};
  };
  add("lbs", data.lbs);
  add("ddm", data.ddm);
  add("linear", data.linear);
  add("full", data.full);
  return json;
}

Json pictures(const ReportData& data) {
  Json json = Json::array();
  for (const PictureReport& picture : data.pictures) {
    json.push_back({{"kind", picture.kind},
                    {"frame", picture.frame},
                    {"rms_mm", picture.rms_mm},
                    {"max_mm", picture.max_mm},
                    {"heat_scale_mm", picture.heat_scale_mm},
                    {"caption", picture.caption}});
  }
  return json;
}

Json trade_off(const ReportData& data) {
  Json json = Json::array();
  for (const TradeOffReport& point : data.trade_off) {
    json.push_back({{"bytes_per_vertex", point.bytes_per_vertex},
                    {"expected_rms_mm", point.expected_rms_mm},
                    {"microseconds", point.microseconds},
                    {"coefficients", point.coefficients}});
  }
  return json;
}

Json bytes_by_stage(const ReportData& data) {
  Json json = Json::object();
  for (const auto& [stage, bytes] : data.bytes_by_stage) json[stage] = bytes;
  return json;
}

Json to_json(const ReportData& data) {
  Json json;
  json["quick"] = data.quick;
  json["character"] = {{"name", data.character.name},
                       {"vertices", data.character.vertices},
                       {"joints", data.character.joints},
                       {"muscles", data.character.muscles},
                       {"bounding_box_m", data.character.bounding_box_m}};
  json["dataset"] = {{"train_frames", data.dataset.train_frames},
                     {"heldout_frames", data.dataset.heldout_frames},
                     {"unconverged", data.dataset.unconverged}};
  json["errors_mm"] = {{"lbs", errors(data.lbs)},
                       {"ddm", errors(data.ddm)},
                       {"linear", errors(data.linear)},
                       {"full", errors(data.full)}};
  json["unposing_residual_mm"] = {{"lbs", data.unposing_residual_mm.lbs}, {"ddm", data.unposing_residual_mm.ddm}};
  json["bytes_per_vertex"] = data.bytes_per_vertex;
  json["method_bytes_per_vertex"] = {{"lbs", data.lbs.bytes_per_vertex},
                                     {"ddm", data.ddm.bytes_per_vertex},
                                     {"linear", data.linear.bytes_per_vertex},
                                     {"full", data.full.bytes_per_vertex}};
  json["method_coefficients"] = {{"lbs", data.lbs.coefficients},
                                 {"ddm", data.ddm.coefficients},
                                 {"linear", data.linear.coefficients},
                                 {"full", data.full.coefficients}};
  json["bytes_by_stage"] = bytes_by_stage(data);
  json["trade_off"] = trade_off(data);
  json["cpu_gpu_max_difference_m"] = data.cpu_gpu_max_difference_m;
  json["device"] = data.device;
  json["seconds"] = {{"build_character", data.seconds.build_character},
                     {"simulate", data.seconds.simulate},
                     {"draft", data.seconds.draft},
                     {"train", data.seconds.train},
                     {"eval", data.seconds.eval}};
  json["peak_memory_mib"] = data.peak_memory_mib;
  json["heldout_frame_errors_mm"] = curves(data);
  json["pictures"] = pictures(data);
  if (data.simulation) {
    json["simulation"] = {{"frames", data.simulation->frames},
                          {"converged", data.simulation->converged},
                          {"median_residual", data.simulation->median_residual},
                          {"worst_residual", data.simulation->worst_residual},
                          {"mean_iterations", data.simulation->mean_iterations},
                          {"draft_rms_mm", data.simulation->draft_rms_mm},
                          {"draft_max_mm", data.simulation->draft_max_mm}};
  }
  return json;
}

// JSON has no way to write a number that is not finite; a report that holds one is wrong.
void require_finite(const Json& json, const std::string& where) {
  if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    throw Error(ErrorKind::mismatch, "report: " + where + " is not a finite number");
  }
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) require_finite(value, where.empty() ? key : where + "." + key);
}

void require_curves(const ReportData& data) {
  const std::size_t frames = data.heldout_frame_numbers.size();
  for (const MethodReport* method : {&data.lbs, &data.ddm, &data.linear, &data.full}) {
    if (method->frame_rms.size() != frames || method->frame_max.size() != frames) {
      throw Error(ErrorKind::mismatch, "report: errors of " + std::to_string(method->frame_rms.size()) + " and " +
                                           std::to_string(method->frame_max.size()) + " frames, expected " +
                                           std::to_string(frames));
    }
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace

void write_report(const ReportData& data, const std::filesystem::path& folder) {
  require_curves(data);
  const Json json = to_json(data);
  require_finite(json, "");
  // A name may hold bytes that are no UTF-8: they are replaced, not refused.
  const std::string json_text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::string page = report_page(data);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    throw Error(ErrorKind::file, folder.string() + ": the report's folder cannot be made: " + failure.message());
  }
  write_text(folder / "report.json", json_text);
  write_text(folder / "report.html", page);
}

}  // namespace bodyopt
