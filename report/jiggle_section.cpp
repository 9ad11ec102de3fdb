// How flesh swings when a motion stops, and what that costs.
#include <algorithm>

#include "report/plots.h"
#include "report/report_sections.h"

namespace bodyopt {
namespace {

void add_flip_book(const JiggleReport& jiggle, const JiggleReport::Pictures& pictures, Page& page) {
  const std::string labels[] = {"static", "jiggling"};
  page.animation(pictures.animation, pictures.width, pictures.height, labels, "An arm that stops suddenly",
                 "All frames of the motion, in time.");
  page.animation(pictures.slow_animation, pictures.width, pictures.height, labels, "The same at half the speed",
                 "All frames, each twice as long.");
  std::vector<std::string> frames;
  for (const int frame : pictures.strip_frames) frames.push_back("frame " + std::to_string(frame));
  page.picture(
      pictures.strip, frames, "Around the stop",
      "Static above; jiggling below, coloured by the distance from the static skin. The pose is held from frame " +
          std::to_string(jiggle.stops) + " on.",
      colour_bar(pictures.heat_scale_mm));
}

// The frame from which on the largest displacement stays below a tenth of its peak, as an index.
std::size_t settled(const std::vector<double>& max_mm) {
  const double tenth = 0.1 * *std::max_element(max_mm.begin(), max_mm.end());
  std::size_t frame = max_mm.size();
  while (frame > 0 && max_mm[frame - 1] < tenth) --frame;
  return frame;
}

std::string motion_text(const JiggleReport& jiggle) {
  const auto peak = std::max_element(jiggle.max_mm.begin(), jiggle.max_mm.end());
  const auto frame_of = [&](std::size_t k) { return std::to_string(jiggle.frames[k]); };
  std::string text = "The skin is up to " + millimetres(*peak) +
                     " from where it would be at rest in its pose, in frame " +
                     frame_of(static_cast<std::size_t>(peak - jiggle.max_mm.begin())) + "; ";
  const std::size_t end = settled(jiggle.max_mm);
  if (end == jiggle.max_mm.size()) return text + "it is still moving when the clip ends.";
  const double seconds = (jiggle.frames[end] - jiggle.stops) / jiggle.frames_per_second;
  return text + "from frame " + frame_of(end) + " on, " + number_text(seconds, 2) +
         " s after the stop, less than a tenth of that is left.";
}

std::string time_text(const JiggleReport& jiggle) {
  if (jiggle.diffuse_ms == 0 && jiggle.jiggle_ms == 0)
    return "Computed on " + jiggle.device + ", which tells no times.";
  return "A frame on " + jiggle.device + ": diffuse " + number_text(jiggle.diffuse_ms) + " ms, jiggle " +
         number_text(jiggle.jiggle_ms) + " ms.";
}

std::string inverted_text(const JiggleReport& jiggle) {
  const std::uint32_t most = *std::max_element(jiggle.inverted_tets.begin(), jiggle.inverted_tets.end());
  if (most == 0) return "None of them is turned inside out. ";
  const auto frames = std::count_if(jiggle.inverted_tets.begin(), jiggle.inverted_tets.end(),
                                    [](std::uint32_t inverted) { return inverted > 0; });
  return "In " + std::to_string(frames) + " of the frames some are turned inside out, " + std::to_string(most) +
         " at most. ";
}

std::string cost_text(const JiggleReport& jiggle) {
  return "The flesh is " + std::to_string(jiggle.tets) + " tetrahedra of " + std::to_string(jiggle.nodes) +
         " nodes, quality " + number_text(jiggle.worst_quality, 2) + " at worst (1: regular). " +
         inverted_text(jiggle) + "Tables: diffuse " + number_text(jiggle.diffuse_mb) + " MB, jiggle " +
         number_text(jiggle.jiggle_mb) + " MB. " + time_text(jiggle);
}

}  // namespace

void add_jiggle(const ReportData& data, Page& page) {
  if (!data.jiggle) return;
  const JiggleReport& jiggle = *data.jiggle;
  page.heading("Jiggle");
  page.paragraph(
      "Flesh has inertia: it lags while the arm is swung up, and swings on when the arm stops dead. A linear "
      "finite-element step on the quasi-static skin adds that; a pose that is held adds nothing.");
  if (jiggle.pictures) add_flip_book(jiggle, *jiggle.pictures, page);
  page.chart(line_plot({"frame",
                        "displacement, mm",
                        {jiggle.frames, {}},
                        {{"largest", "#f2b866", jiggle.max_mm, true}, {"RMS", "#62aee8", jiggle.rms_mm, false}}}),
             "How far the jiggling skin is from the static one in every frame of the motion.");
  page.paragraph(motion_text(jiggle));
  page.paragraph(cost_text(jiggle));
}

}  // namespace bodyopt
