#include "report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "report/page.h"
#include "report/report_json.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

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

// As report/page/report.js takes them.
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

}  // namespace bodyopt
