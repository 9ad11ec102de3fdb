#include "report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "report/page.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::report {
namespace {

// A number, or null where there is none.
Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json methods(const ReportData& data) {
  Json list = Json::array();
  for (const MethodResult& method : data.methods) {
    Json entry = {{"name", method.name}};
    entry.update(to_json(method));
    entry["frame_rms_mm"] = method.errors.frame_rms;
    entry["frame_max_mm"] = method.errors.frame_max;
    list.push_back(entry);
  }
  return list;
}

Json heldout_frames(const ReportData& data) {
  Json takes = Json::array();
  for (const TakeStart& take : data.heldout.takes) takes.push_back({{"name", take.name}, {"first_index", take.column}});
  return {{"frames", data.heldout.frames}, {"takes", takes}};
}

Json regions(const ReportData& data) {
  return transformed(data.regions, [&](const RegionReport& region) {
    return Json{{"name", region.name},
                {"moves_rms_mm", region.moves_mm},
                {"validation_rms_mm", region.left_mm},
                {"heldout_expected_rms_mm", optional_number(region.expected_mm)},
                {"heldout_true_rms_mm", optional_number(region.true_mm)}};
  });
}

Json muscles(const ReportData& data) {
  return transformed(data.muscles, [&](const MuscleReport& muscle) {
    return Json{{"name", muscle.name}, {"explains_percent", muscle.percent}};
  });
}

Json coverage(const CoverageReport& coverage) {
  return {{"expected_rms_mm", coverage.rms_mm},
          {"frame_expected_rms_mm", coverage.frame_mm},
          {"regions", coverage.regions},
          {"frame_region_expected_mm", coverage.region_mm},
          {"rank_correlation", optional_number(coverage.rank_correlation)},
          {"worth_simulating_index", coverage.worth_simulating}};
}

Json area_errors(const AreaErrorsReport& errors) {
  return {{"ddm_mm", errors.ddm_mm}, {"full_mm", errors.full_mm}, {"expected_mm", errors.expected_mm}};
}

Json takes(const ReportData& data) {
  Json list = Json::array();
  for (const TakeReport& take : data.takes) {
    Json parts = Json::array();
    for (const TakeReport::Part& part : take.parts) {
      Json entry = {{"part", part.name}, {"area_m2", part.area_m2}};
      entry.update(area_errors(part.errors));
      parts.push_back(entry);
    }
    Json entry = {{"take", take.name}, {"foreign", take.foreign}, {"frames", take.frames}};
    entry.update(area_errors(take.errors));
    entry["rank_correlation"] = optional_number(take.rank_correlation);
    entry["parts"] = parts;
    list.push_back(entry);
  }
  return list;
}

Json trade_off(const ReportData& data) {
  return transformed(data.trade_off, [&](const TradeOffPoint& point) { return to_json(point); });
}

Json pictures(const ReportData& data) {
  return transformed(data.pictures, [&](const PictureReport& picture) {
    return Json{{"kind", picture.kind},      {"take", picture.take},     {"frame", picture.frame},
                {"rms_mm", picture.rms_mm},  {"max_mm", picture.max_mm}, {"heat_scale_mm", picture.heat_scale_mm},
                {"caption", picture.caption}};
  });
}

Json pairs(const auto& entries) {
  Json json = Json::object();
  for (const auto& [name, value] : entries) json[name] = value;
  return json;
}

Json flexed(const FlexReport& flexed) {
  return {{"take", flexed.take},
          {"frame", flexed.frame},
          {"controls", pairs(flexed.controls)},
          {"max_mm", flexed.max_mm},
          {"heat_scale_mm", flexed.heat_scale_mm}};
}

Json provenance(const ProvenanceReport& provenance) {
  Json files = Json::array(), takes = Json::array();
  for (const auto& file : provenance.files) {
    files.push_back({{"what", file.what}, {"path", file.path}, {"xxh3", file.xxh3}});
  }
  for (const auto& take : provenance.takes) {
    takes.push_back(
        {{"name", take.name}, {"trained", take.trained}, {"heldout", take.heldout}, {"left_out", take.left_out}});
  }
  return {{"program", provenance.program},
          {"command_line", provenance.command_line},
          {"options", pairs(provenance.options)},
          {"basis_checksum", provenance.basis_checksum},
          {"topology_hash", provenance.topology_hash},
          {"skeleton_hash", provenance.skeleton_hash},
          {"files", files},
          {"takes", takes}};
}

Json jiggle(const JiggleReport& jiggle) {
  Json json = {{"tets", jiggle.tets},
               {"nodes", jiggle.nodes},
               {"worst_quality", jiggle.worst_quality},
               {"diffuse_mb", jiggle.diffuse_mb},
               {"jiggle_mb", jiggle.jiggle_mb},
               {"moves_after", jiggle.moves_after},
               {"stops", jiggle.stops},
               {"frames_per_second", jiggle.frames_per_second},
               {"frames", jiggle.frames},
               {"frame_rms_mm", jiggle.rms_mm},
               {"frame_max_mm", jiggle.max_mm},
               {"frame_inverted_tets", jiggle.inverted_tets},
               {"diffuse_ms", jiggle.diffuse_ms},
               {"jiggle_ms", jiggle.jiggle_ms},
               {"device", jiggle.device}};
  if (jiggle.pictures) {
    json["strip_frames"] = jiggle.pictures->strip_frames;
    json["heat_scale_mm"] = jiggle.pictures->heat_scale_mm;
  }
  return json;
}

void add_demo(const DemoReport& demo, Json& json) {
  json["quick"] = demo.quick;
  json["cpu_gpu_max_difference_m"] = demo.cpu_gpu_max_difference_m;
  json["simulation"] = {{"frames", demo.frames},
                        {"converged", demo.converged},
                        {"median_residual", demo.median_residual},
                        {"worst_residual", demo.worst_residual},
                        {"mean_iterations", demo.mean_iterations},
                        {"draft_rms_mm", demo.draft_rms_mm},
                        {"draft_max_mm", demo.draft_max_mm}};
  json["seconds"]["build_character"] = demo.seconds.build_character;
  json["seconds"]["simulate"] = demo.seconds.simulate;
  json["seconds"]["draft"] = demo.seconds.draft;
  json["seconds"]["eval"] = demo.seconds.eval;
}

Json report_json(const ReportData& data) {
  Json json;
  json["character"] = {{"name", data.character.name},
                       {"vertices", data.character.vertices},
                       {"joints", data.character.joints},
                       {"muscles", data.character.muscles},
                       {"bounding_box_m", data.character.bounding_box_m}};
  json["dataset"] = {{"train_frames", data.dataset.train_frames},
                     {"heldout_frames", data.dataset.heldout_frames},
                     {"unconverged", data.dataset.unconverged},
                     {"how_to_hold_out", data.dataset.how_to_hold_out}};
  json["methods"] = methods(data);
  json["heldout"] = heldout_frames(data);
  json["takes"] = takes(data);
  json["unposing_residual_mm"] = {{"lbs", data.unposing_residual_mm.lbs}, {"ddm", data.unposing_residual_mm.ddm}};
  json["bytes_per_vertex"] = data.bytes_per_vertex;
  json["bytes_by_stage"] = pairs(data.bytes_by_stage);
  json["expected_rms_mm"] = data.expected_rms_mm;
  json["trade_off"] = trade_off(data);
  json["regions"] = regions(data);
  json["muscles"] = muscles(data);
  if (data.coverage) json["coverage"] = coverage(*data.coverage);
  json["warnings"] = data.warnings;
  json["device"] = data.device;
  json["seconds"] = {{"train", data.train_seconds}};
  json["peak_memory_mib"] = data.peak_memory_mib;
  json["pictures"] = pictures(data);
  if (data.mean_error) {
    json["mean_error"] = {{"largest_mm", data.mean_error->largest_mm},
                          {"heat_scale_mm", data.mean_error->heat_scale_mm}};
  }
  if (data.flexed) json["flexed"] = flexed(*data.flexed);
  if (data.sections) {
    json["sections"] = {
        {"take", data.sections->take}, {"frame", data.sections->frame}, {"names", data.sections->names}};
  }
  if (data.jiggle) json["jiggle"] = jiggle(*data.jiggle);
  json["provenance"] = provenance(data.provenance);
  if (data.demo) add_demo(*data.demo, json);
  return json;
}

// JSON has no way to write a number that is not finite; a report that holds one is wrong.
void require_finite(const Json& json, const std::string& where) {
  if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    throw Error(ErrorKind::mismatch, "report: ", where, " is not a finite number");
  }
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) require_finite(value, where.empty() ? key : where + "." + key);
}

void require_curves(const ReportData& data) {
  const std::size_t frames = data.heldout.frames.size();
  for (const MethodResult& method : data.methods) {
    if (method.errors.frame_rms.size() != frames || method.errors.frame_max.size() != frames) {
      throw Error(ErrorKind::mismatch, "report: ", method.name, " has errors of ", method.errors.frame_rms.size(),
                  " and ", method.errors.frame_max.size(), " frames, expected ", frames);
    }
  }
}

void require_jiggle(const JiggleReport& jiggle) {
  const std::size_t frames = jiggle.frames.size();
  if (frames > 0 && jiggle.rms_mm.size() == frames && jiggle.max_mm.size() == frames &&
      jiggle.inverted_tets.size() == frames) {
    return;
  }
  throw Error(ErrorKind::mismatch, "report: the jiggle has displacements of ", jiggle.rms_mm.size(), " and ",
              jiggle.max_mm.size(), " frames and inverted tets of ", jiggle.inverted_tets.size(), ", expected ",
              frames);
}

// Lays pictures out as report/page/report.js takes them.
Json pictures_of(const ReportData& data) {
  Json pictures = {{"frames", Json::array()}};
  for (const PictureReport& picture : data.pictures) pictures["frames"].push_back(page_picture(picture.image));
  if (data.mean_error) pictures["mean_error"] = page_picture(data.mean_error->image);
  if (data.flexed) pictures["flexed"] = page_picture(data.flexed->image);
  if (data.sections) pictures["sections"] = page_picture(data.sections->image);
  if (data.region_picture) pictures["regions"] = page_picture(*data.region_picture);
  if (data.jiggle && data.jiggle->pictures) {
    const JiggleReport::Pictures& jiggle = *data.jiggle->pictures;
    pictures["jiggle"] = {{"animation", page_animation(jiggle.animation, jiggle.width, jiggle.height)},
                          {"slow", page_animation(jiggle.slow_animation, jiggle.width, jiggle.height)},
                          {"strip", page_picture(jiggle.strip)}};
  }
  return pictures;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace

Json write_report(const ReportData& data, const std::filesystem::path& folder) {
  require_curves(data);
  if (data.jiggle) require_jiggle(*data.jiggle);
  Json json = report_json(data);
  require_finite(json, "");
  // A name may hold bytes that are no UTF-8: they are replaced, not refused.
  const std::string json_text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::string page = page_text("report", json, pictures_of(data));
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw Error(ErrorKind::file, folder, ": the report's folder cannot be made: ", failure.message());
  write_text(folder / "report.json", json_text);
  write_text(folder / "report.html", page);
  return json;
}

}  // namespace bodyopt::report
