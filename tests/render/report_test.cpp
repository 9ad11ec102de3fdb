#include "cli/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/report/html.h"
#include "cli/report/plots.h"
#include "runtime/basis/error.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

MethodReport method(double rms, double bytes) {
  MethodReport report{rms, 3 * rms, 9 * rms, 0.1 * rms, {}, {}, bytes};
  for (int f = 0; f < 5; ++f) {
    report.frame_rms.push_back(rms * (1 + 0.1 * f));
    report.frame_max.push_back(9 * rms * (1 - 0.1 * f));
  }
  return report;
}

ReportData example() {
  ReportData data;
  data.character.name = "<b>Tom & \"Jerry\"</b>";
  data.character.vertices = 6123;
  data.character.joints = 9;
  data.character.muscles = 14;
  data.character.bounding_box_m = {0.5, 0.25, 0.125};
  data.dataset.train_frames = 440;
  data.dataset.heldout_frames = 5;
  data.dataset.unconverged = 3;
  data.lbs = method(8, 32);
  data.ddm = method(4, 120);
  data.linear = method(1, 350);
  data.full = method(0.5, 351);
  data.heldout_frame_numbers = {1, 3, 5, 11, 13};
  data.unposing_residual_mm.lbs = 6.25;
  data.unposing_residual_mm.ddm = 4.5;
  data.bytes_per_vertex = 351;
  data.bytes_by_stage = {{"ddm", 1024}, {"strain", 512}, {"residual", 2048}};
  data.trade_off = {{153, 7.75, 2400, 0}, {263.6, 0.625, 3100, 135}};
  data.cpu_gpu_max_difference_m = 4e-7;
  data.device = "A device";
  data.seconds.build_character = 1.5;
  data.seconds.simulate = 300;
  data.seconds.draft = 7;
  data.seconds.train = 40;
  data.seconds.eval = 0.5;
  data.peak_memory_mib = 640;
  data.simulation = SimulationReport{448, 445, 2e-5, 9e-5, 180, 3.5, 20};
  for (const char* kind : {"worst", "median", "chosen", "chosen"}) {
    PictureReport picture;
    picture.kind = kind;
    picture.frame = 11;
    picture.rms_mm = 0.75;
    picture.max_mm = 3.5;
    picture.heat_scale_mm = 2;
    picture.caption = "1 < 2";
    picture.image = {6, 2, std::vector<std::uint8_t>(48, 255)};
    data.pictures.push_back(picture);
  }
  return data;
}

TEST(Report, JsonHoldsEveryFigure) {
  const TemporaryFolder folder;
  write_report(example(), folder / "made" / "here");
  const auto json = nlohmann::ordered_json::parse(read(folder / "made" / "here" / "report.json"));
  EXPECT_EQ(json.at("character").at("vertices"), 6123);
  EXPECT_EQ(json.at("character").at("joints"), 9);
  EXPECT_EQ(json.at("character").at("muscles"), 14);
  EXPECT_EQ(json.at("character").at("bounding_box_m"), nlohmann::ordered_json({0.5, 0.25, 0.125}));
  EXPECT_EQ(json.at("dataset").at("train_frames"), 440);
  EXPECT_EQ(json.at("dataset").at("heldout_frames"), 5);
  EXPECT_EQ(json.at("dataset").at("unconverged"), 3);
  const std::pair<const char*, double> rms[] = {{"lbs", 8}, {"ddm", 4}, {"linear", 1}, {"full", 0.5}};
  for (const auto& [name, value] : rms) {
    const auto& errors = json.at("errors_mm").at(name);
    EXPECT_EQ(errors.at("rms"), value);
    EXPECT_EQ(errors.at("p99"), 3 * value);
    EXPECT_EQ(errors.at("max"), 9 * value);
    EXPECT_EQ(errors.at("jitter"), 0.1 * value);
    EXPECT_EQ(json.at("heldout_frame_errors_mm").at(name).at("rms").size(), 5u);
    EXPECT_EQ(json.at("heldout_frame_errors_mm").at(name).at("max").size(), 5u);
  }
  EXPECT_EQ(json.at("unposing_residual_mm").at("lbs"), 6.25);
  EXPECT_EQ(json.at("unposing_residual_mm").at("ddm"), 4.5);
  EXPECT_EQ(json.at("bytes_per_vertex"), 351);
  EXPECT_EQ(json.at("method_bytes_per_vertex").at("ddm"), 120);
  EXPECT_EQ(json.at("bytes_by_stage").at("residual"), 2048);
  ASSERT_EQ(json.at("trade_off").size(), 2u);
  EXPECT_EQ(json.at("trade_off")[1].at("bytes_per_vertex"), 263.6);
  EXPECT_EQ(json.at("trade_off")[1].at("expected_rms_mm"), 0.625);
  EXPECT_EQ(json.at("trade_off")[1].at("microseconds"), 3100);
  EXPECT_EQ(json.at("trade_off")[1].at("coefficients"), 135);
  EXPECT_EQ(json.at("cpu_gpu_max_difference_m"), 4e-7);
  EXPECT_EQ(json.at("device"), "A device");
  EXPECT_EQ(json.at("seconds").at("build_character"), 1.5);
  EXPECT_EQ(json.at("seconds").at("simulate"), 300);
  EXPECT_EQ(json.at("seconds").at("train"), 40);
  EXPECT_EQ(json.at("seconds").at("eval"), 0.5);
  EXPECT_EQ(json.at("peak_memory_mib"), 640);
  EXPECT_EQ(json.at("pictures").size(), 4u);
  EXPECT_EQ(json.at("pictures")[1].at("kind"), "median");
  EXPECT_EQ(json.at("simulation").at("converged"), 445);
  EXPECT_EQ(json.at("simulation").at("draft_rms_mm"), 3.5);
  EXPECT_EQ(json.at("simulation").at("draft_max_mm"), 20);
  EXPECT_EQ(json.at("seconds").at("draft"), 7);
}

// What was not simulated here has no draft to tell of.
TEST(Report, DraftIsToldWithTheSimulationAlone) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = read(folder / "report.html");
  EXPECT_TRUE(contains(page,
                       "<th scope=\"row\">draft of the held-out motion</th><td>in 7 s, 3.5 mm RMS from the "
                       "simulation, 20 mm at most</td>"));
  data.simulation.reset();
  write_report(data, folder.path());
  page = read(folder / "report.html");
  EXPECT_FALSE(contains(page, "draft"));
  EXPECT_FALSE(nlohmann::json::parse(read(folder / "report.json")).contains("simulation"));
}

TEST(Report, PageIsSelfContainedAndEscaped) {
  const TemporaryFolder folder;
  write_report(example(), folder.path());
  const std::string page = read(folder / "report.html");
  EXPECT_FALSE(contains(page, "<b>Tom"));
  EXPECT_TRUE(contains(page, "&lt;b&gt;Tom &amp; &quot;Jerry&quot;&lt;/b&gt;"));
  EXPECT_TRUE(contains(page, "1 &lt; 2"));
  EXPECT_TRUE(contains(page, "264 bytes, 3100 us"));
  EXPECT_TRUE(contains(page, "0.625 mm"));
  for (const char* outside : {"http", "href", "<script", "<link", "@import", "url(", "file:"}) {
    EXPECT_FALSE(contains(page, outside)) << outside;
  }
  EXPECT_EQ(count(page, "src=\""), 4u);
  EXPECT_EQ(count(page, "src=\"data:image/png;base64,"), 4u);
  EXPECT_FALSE(contains(page, "nan"));
  for (const char* tag : {"svg", "figure", "table", "div", "p", "h2", "main", "body", "html"}) {
    const std::string name = tag;
    EXPECT_EQ(count(page, "<" + name + " ") + count(page, "<" + name + ">"), count(page, "</" + name + ">")) << name;
  }
}

TEST(Report, PageSaysWhatIsHeldOutAndComparesHonestly) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = read(folder / "report.html");
  EXPECT_TRUE(contains(page, "5 held-out frames"));
  EXPECT_TRUE(contains(page, "<b>8</b><i>times</i><span>smaller RMS error than DDM alone (4 mm)"));
  EXPECT_TRUE(contains(page, "<b>2</b><i>times</i><span>smaller RMS error than linear"));
  data.full = method(2, 351);
  write_report(data, folder.path());
  page = read(folder / "report.html");
  EXPECT_TRUE(contains(page, "<b>2</b><i>times</i><span>larger RMS error than linear"));
}

TEST(Report, RefusesFiguresThatAreNoneAndWritesNothing) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.full.p99 = std::numeric_limits<double>::quiet_NaN();
  try {
    write_report(data, folder.path());
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(contains(error.what(), "errors_mm.full.p99")) << error.what();
  }
  data = example();
  data.linear.frame_max.pop_back();
  EXPECT_THROW(write_report(data, folder.path()), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(write_report(example(), folder / "file" / "report"), Error);
}

TEST(Report, NamesThatAreNoUtf8AreWritten) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.character.name = "a\xff\xc3";
  write_report(data, folder.path());
  EXPECT_TRUE(nlohmann::json::accept(read(folder / "report.json")));
}

TEST(Plots, BreaksTheLineWhereFramesAreMissing) {
  LinePlot plot{"frame", "mm", {1, 3, 5, 11, 13}, {{"a", "#fff", {1, 2, 1, 4, 0}, false}}};
  const std::string svg = line_plot(plot);
  const std::size_t begin = svg.find("<path d=\"") + 9;
  const std::string path = svg.substr(begin, svg.find('"', begin) - begin);
  EXPECT_EQ(count(path, "M"), 2u);
  EXPECT_EQ(count(path, "L"), 3u);
  plot.series[0].y.pop_back();
  EXPECT_THROW(line_plot(plot), Error);
  plot.series[0].y.push_back(std::numeric_limits<double>::infinity());
  EXPECT_THROW(line_plot(plot), Error);
}

TEST(Plots, LargerErrorsAreDrawnHigher) {
  const LinePlot plot{"frame", "mm", {1, 2, 3}, {{"a", "#fff", {0.1, 1, 10}, true}}};
  const std::string svg = line_plot(plot);
  const std::size_t begin = svg.find("<path d=\"") + 9;
  std::string points = svg.substr(begin, svg.find('"', begin) - begin);
  std::replace_if(
      points.begin(), points.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
  std::istringstream path(points);
  double x[3], y[3];
  for (int i = 0; i < 3; ++i) path >> x[i] >> y[i];
  EXPECT_LT(x[0], x[1]);
  EXPECT_LT(x[1], x[2]);
  EXPECT_NEAR(y[0] - y[1], y[1] - y[2], 0.2);  // logarithmic
  EXPECT_GT(y[0] - y[1], 40);
}

TEST(Plots, DrawsNothingAtAllAndAllZeros) {
  EXPECT_TRUE(contains(line_plot({"frame", "mm", {}, {}}), "</svg>"));
  EXPECT_TRUE(contains(line_plot({"frame", "mm", {1}, {{"a", "#fff", {0}, false}}}), "</svg>"));
  EXPECT_TRUE(contains(bar_chart({}), "</svg>"));
  const Bar zero[] = {{"a", "#fff", 0, "0 mm"}};
  EXPECT_FALSE(contains(bar_chart(zero), "nan"));
}

TEST(Plots, ColourBarBeginsAndEndsWithTheHeatMapsColours) {
  const std::string svg = colour_bar(2);
  EXPECT_TRUE(contains(svg, ">2 mm<"));
  EXPECT_TRUE(contains(svg, ">0.5<"));
  const auto hex = [](float t) {
    char text[8];
    int srgb[3];
    const auto colour = heat_colour(t);
    for (std::size_t i = 0; i < 3; ++i) {
      const double c = static_cast<double>(colour[i]);
      srgb[i] = static_cast<int>(std::lround(255 * (c > 0.0031308 ? 1.055 * std::pow(c, 1 / 2.4) - 0.055 : 12.92 * c)));
    }
    std::snprintf(text, sizeof(text), "#%02x%02x%02x", srgb[0] & 255, srgb[1] & 255, srgb[2] & 255);
    return std::string(text);
  };
  EXPECT_TRUE(contains(svg, hex(0.5f / 64)));
  EXPECT_TRUE(contains(svg, hex(63.5f / 64)));
}

TEST(Plots, NumbersAreShort) {
  EXPECT_EQ(number_text(0.5), "0.5");
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(12.3456), "12.3");
  EXPECT_EQ(number_text(123456), "123000");
  EXPECT_EQ(number_text(1002, 9), "1002");
  EXPECT_DOUBLE_EQ(round_up(3.3), 5);
  EXPECT_DOUBLE_EQ(round_up(0.02), 0.02);
  EXPECT_DOUBLE_EQ(round_up(0.051), 0.1);
}

TEST(Html, TablesMarkTheBestAndAlignNumbers) {
  Page page("a", "b");
  page.table(
      {{{"name"}, {"error", true}, {"size"}}, {{{"x", {}}, {"2", 2}, {"7", 7}}, {{"y", {}}, {"1", 1}, {"9", 9}}}});
  const std::string text = page.text();
  EXPECT_TRUE(contains(text, "<td class=\"number best\">1</td>"));
  EXPECT_TRUE(contains(text, "<td class=\"number\">2</td>"));
  EXPECT_EQ(count(text, "class=\"number best\""), 1u);
  EXPECT_TRUE(contains(text, "<th scope=\"row\">x</th>"));
  EXPECT_THROW(page.table({{{"name"}}, {{{"x", {}}, {"2", 2}}}}), Error);
}

TEST(Html, Base64AsInItsStandard) {  // RFC 4648, section 10
  const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, encoded] : examples) {
    const std::string text = plain;
    EXPECT_EQ(encode_base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), encoded);
  }
}

}  // namespace
}  // namespace bodyopt
