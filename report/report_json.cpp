#include "report/report_json.h"

#include <nlohmann/json.hpp>

#include "runtime/core/transformed.h"

namespace bodyopt {
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

}  // namespace

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

}  // namespace bodyopt
