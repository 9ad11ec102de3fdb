#include "report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "draw/heat_colour.h"
#include "report/heat_strip.h"
#include "report/html.h"
#include "report/plots.h"
#include "report/svg.h"
#include "report/trade_off_plot.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

MethodResult method(const std::string& name, double rms, double bytes) {
  ErrorStatistics errors{rms, 3 * rms, 9 * rms, 0.1 * rms, 0, 0, {}, {}};
  for (int f = 0; f < 5; ++f) {
    errors.frame_rms.push_back(rms * (1 + 0.1 * f));
    errors.frame_max.push_back(9 * rms * (1 - 0.1 * f));
  }
  return {name, errors, bytes, 7, 12.5};
}

Image some_picture() { return {6, 2, std::vector<std::uint8_t>(48, 255)}; }

void add_learning(ReportData& data) {
  data.regions = {{"hip", 12, 2, 1.5, 1.25}, {"knee", 3, 0.25, {}, 0.125}, {"toe", 0.5, 0.4, 0.375, 0.3125}};
  data.region_picture = some_picture();
  data.muscles = {{"gluteus", 24.5}, {"soleus", 0.75}, {"plantaris", 0}};
  data.coverage = CoverageReport{0.625, {0.5, 0.6, 0.7, 0.8, 0.9}, {"hip", "toe"}, {}, 0.875, {4, 1}};
  for (int f = 0; f < 5; ++f) data.coverage->region_mm.push_back({1.0 + f, 0.25});
  data.warnings = {"control 'breath' is 0 in every training frame"};
}

void add_provenance(ReportData& data) {
  data.provenance.program = "bodyopt 1.2.3";
  data.provenance.command_line = "bodyopt train data --out hero.safetensors --report report";
  data.provenance.options = {{"seed", "42"}, {"budget", "none"}};
  data.provenance.basis_checksum = "00000000000000aa";
  data.provenance.topology_hash = "00000000000000bb";
  data.provenance.skeleton_hash = "00000000000000cc";
  data.provenance.files = {{"dataset", "data/dataset.json", "0123456789abcdef"}};
  data.provenance.takes = {{"rom", "1-440", "", "7-9"}, {"shot", "", "1-5x2,11,13", ""}};
}

void add_jiggle(ReportData& data) {
  JiggleReport& jiggle = data.jiggle.emplace();
  jiggle = {20000,
            6000,
            0.25,
            3,
            24.5,
            2,
            3,
            24,
            {1, 2, 3, 4, 5, 6, 7},
            {0, 0, 4, 0.25, 1, 0.1, 0.1},
            {0, 0, 8, 0.5, 2, 0.75, 0.25},
            {0, 0, 5, 2, 0, 0, 0},
            0.5,
            6.25,
            "A device",
            {}};
  JiggleReport::Pictures& pictures = jiggle.pictures.emplace();
  pictures.strip = some_picture();
  pictures.strip_frames = {3, 5};
  pictures.heat_scale_mm = 8;
  pictures.animation = {'R', 'I', 'F', 'F'};
  pictures.slow_animation = {'W', 'E', 'B', 'P'};
  pictures.width = 6;
  pictures.height = 2;
}

// As bodyopt demo makes it: with everything.
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
  data.methods = {method("LBS", 8, 32), method("DDM", 4, 120), method("DDM + joints, linear, dense", 1, 350),
                  method("DDM + joints, linear, local", 1.5, 340), method("full: everything", 0.5, 351)};
  data.heldout = {{1, 3, 5, 11, 13}, {{"shot", 0}}};
  data.takes = {{"rom", false, 2, {3, 1, 2}, {{"hip", 0.5, {3, 1, 2}}}, {}},
                {"shot", true, 3, {4, 2, 2.5}, {{"hip", 0.25, {8, 2, 3}}, {"knee", 0.125, {1, 0.75, 0.5}}}, 0.75}};
  data.unposing_residual_mm.lbs = 6.25;
  data.unposing_residual_mm.ddm = 4.5;
  data.bytes_per_vertex = 351;
  data.expected_rms_mm = 0.6;
  data.bytes_by_stage = {{"ddm", 1024}, {"strain", 512}, {"residual", 2048}};
  data.trade_off = {{153, 7.75, 2400, 0}, {263.6, 0.625, 3100, 135}};
  add_learning(data);
  data.device = "A device";
  data.train_seconds = 40;
  data.peak_memory_mib = 640;
  data.demo = DemoReport{false, 448, 445, 2e-5, 9e-5, 180, 3.5, 20, 4e-7, {1.5, 300, 7, 0.5}};
  for (const char* kind : {"worst", "median", "chosen", "chosen"}) {
    PictureReport picture;
    picture.kind = kind;
    picture.take = "shot";
    picture.frame = 11;
    picture.rms_mm = 0.75;
    picture.max_mm = 3.5;
    picture.heat_scale_mm = 2;
    picture.caption = "1 < 2";
    picture.image = some_picture();
    data.pictures.push_back(picture);
  }
  data.mean_error = MeanErrorReport{2, 1.5, some_picture()};
  data.flexed = FlexReport{"flexed", 21, {{"biceps", 1}, {"triceps", 0.25}}, 6.5, 10, some_picture()};
  add_jiggle(data);
  add_provenance(data);
  return data;
}

// Programs read it: a key that goes or changes its meaning breaks them. Kept beside this file.
TEST(Report, JsonIsAsItWas) {
  const TemporaryFolder folder;
  write_report(example(), folder / "made" / "here");
  const auto written = Json::parse(testing::read_bytes(folder / "made" / "here" / "report.json"));
  const auto kept = Json::parse(testing::read_bytes(kSourceFolder + "/tests/report/report.json"));
  EXPECT_EQ(written, kept) << written.dump(2);
}

TEST(Report, TakesAreToldByAreaAndPart) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "On motion that shares nothing with what was trained on"));
  EXPECT_TRUE(contains(page, "rom (between trained frames)"));
  const std::size_t take = page.find("<th scope=\"row\">shot</th>"), knee = page.find("knee</th>", take),
                    hip = page.find("hip</th>", take);
  ASSERT_NE(take, std::string::npos);
  EXPECT_LT(knee, hip);  // which gained least
  EXPECT_LT(hip, page.find("truth, Direct Delta Mush, result, and where it differs"));

  data.takes.resize(1);
  write_report(data, folder.path());
  page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "not how a shot will look"));
}

TEST(Report, PageSaysWhatWouldHelp) {
  const TemporaryFolder folder;
  write_report(example(), folder.path());
  const std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "The skin at hip moves 12 mm, of which nothing explains 2 mm: a muscle there may help."));
  EXPECT_FALSE(contains(page, "The skin at knee"));
  EXPECT_FALSE(contains(page, "The skin at toe"));  // much of its motion, but less than the whole skin keeps
  EXPECT_TRUE(contains(page, "no region listens to them (1): plantaris."));
  EXPECT_TRUE(contains(page, "take &#39;shot&#39;: 3, 13."));
  EXPECT_TRUE(contains(page, "rank alike with Spearman&#39;s rho 0.875"));
  EXPECT_TRUE(contains(page, "control &#39;breath&#39; is 0 in every training frame"));
  EXPECT_TRUE(contains(page,
                       "<th scope=\"row\">2. knee</th><td class=\"number\">3</td><td class=\"number\">0.25</td>"
                       "<td>-</td><td class=\"number\">0.125</td>"));
}

TEST(Report, PageShowsDirectDeltaMushBesideTheResultAndWhatFlexingDoes) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_EQ(
      count(page, "<span>truth</span><span>Direct Delta Mush</span><span>Bodyopt (result)</span><span>distance</span>"),
      data.pictures.size());
  EXPECT_TRUE(contains(page, "<span>at rest</span><span>flexed</span><span>what flexing moves</span>"));
  EXPECT_TRUE(contains(page, "frame 21 of take &#39;flexed&#39;"));
  EXPECT_TRUE(contains(page, "moves it most, by 6.5 mm: biceps 1, triceps 0.25."));

  for (const char* more : {"a", "b", "c", "d", "e"}) data.flexed->controls.emplace_back(more, 0.125);
  write_report(data, folder.path());
  page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "d 0.12 and 1 control more."));
}

// Nothing is measured, and the page says so; what training tells of itself is there.
TEST(Report, NeedsNoHeldOutFrames) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.methods.clear();
  data.heldout = {};
  data.dataset.heldout_frames = 0;
  data.coverage.reset();
  data.mean_error.reset();
  data.flexed.reset();
  data.region_picture.reset();
  data.pictures.clear();
  data.jiggle.reset();
  data.demo.reset();
  write_report(data, folder.path());
  const std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "holds out no frames"));
  EXPECT_TRUE(contains(page, "The skin at hip"));
  EXPECT_TRUE(contains(page, "this basis, expected: 0.6 mm"));
  EXPECT_FALSE(contains(page, "held out: "));
  EXPECT_FALSE(contains(page, "need a Vulkan device"));
  EXPECT_EQ(Json::parse(testing::read_bytes(folder / "report.json")).at("methods").size(), 0u);
}

TEST(Report, WithoutADeviceThePageSaysSo) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.pictures.clear();
  data.mean_error.reset();
  data.flexed.reset();
  data.region_picture.reset();
  data.jiggle->pictures.reset();
  write_report(data, folder.path());
  const std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "need a Vulkan device"));
  EXPECT_EQ(count(page, "src=\""), 0u);
}

// 8 mm at the stop; below 0.8 mm from frame 6 on, three frames later: frame 4 does not count, frame 5 is above again.
TEST(Report, SaysHowFleshSwings) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(
      contains(page, "up to 8 mm from where it would be at rest in its pose, in frame 3; from frame 6 on, 0.12 s"));
  EXPECT_TRUE(contains(page, "A frame on A device: diffuse 0.5 ms, jiggle 6.2"));
  EXPECT_TRUE(contains(page, "width=\"6\" height=\"2\" src=\"data:image/webp;base64,UklGRg==\""));
  EXPECT_TRUE(contains(page, "src=\"data:image/webp;base64,V0VCUA==\""));
  EXPECT_TRUE(contains(page, "<span>frame 3</span><span>frame 5</span>"));
  EXPECT_TRUE(contains(page, "In 2 of the frames some are turned inside out, 5 at most."));
  data.jiggle->inverted_tets = {0, 0, 0, 0, 0, 0, 0};
  data.jiggle->diffuse_ms = data.jiggle->jiggle_ms = 0;
  data.jiggle->max_mm.back() = 3;
  write_report(data, folder.path());
  page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "it is still moving when the clip ends"));
  EXPECT_TRUE(contains(page, "Computed on A device, which tells no times."));
  EXPECT_TRUE(contains(page, "None of them is turned inside out."));
  data.jiggle->max_mm.pop_back();
  EXPECT_THROW(write_report(data, folder.path()), Error);
  data.jiggle.reset();
  write_report(data, folder.path());
  EXPECT_FALSE(contains(testing::read_bytes(folder / "report.html"), "Jiggle"));
}

// What was not simulated here has no draft to tell of.
TEST(Report, DraftIsToldWithTheSimulationAlone) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page,
                       "<th scope=\"row\">draft of the held-out motion</th><td>in 7 s, 3.5 mm RMS from the "
                       "simulation, 20 mm at most</td>"));
  data.demo.reset();
  write_report(data, folder.path());
  page = testing::read_bytes(folder / "report.html");
  EXPECT_FALSE(contains(page, "draft"));
  EXPECT_FALSE(Json::parse(testing::read_bytes(folder / "report.json")).contains("simulation"));
}

TEST(Report, PageIsSelfContainedAndEscaped) {
  const TemporaryFolder folder;
  write_report(example(), folder.path());
  const std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_FALSE(contains(page, "<b>Tom"));
  EXPECT_TRUE(contains(page, "&lt;b&gt;Tom &amp; &quot;Jerry&quot;&lt;/b&gt;"));
  EXPECT_TRUE(contains(page, "1 &lt; 2"));
  EXPECT_TRUE(contains(page,
                       "<th scope=\"row\">264</th><td class=\"number\">0.625</td><td class=\"number\">135</td><td "
                       "class=\"number\">3100</td>"));
  for (const char* outside : {"http", "<script", "<link", "@import", "url(", "file:"}) {
    EXPECT_FALSE(contains(page, outside)) << outside;
  }
  EXPECT_EQ(count(page, "src=\""), 10u);
  EXPECT_EQ(count(page, "src=\"data:image/png;base64,"), 8u);
  EXPECT_EQ(count(page, "src=\"data:image/webp;base64,"), 2u);
  EXPECT_EQ(count(page, "href"), 1u);  // the cells of the heat strip
  EXPECT_EQ(count(page, "href=\"data:image/png;base64,"), 1u);
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
  std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "5 held-out frames"));
  EXPECT_TRUE(contains(page, "<b>8</b><i>times</i><span>smaller RMS error than DDM alone (4 mm)"));
  EXPECT_TRUE(contains(page, "<b>2</b><i>times</i><span>smaller RMS error than linear"));
  data.methods.back() = method("full", 2, 351);
  write_report(data, folder.path());
  page = testing::read_bytes(folder / "report.html");
  EXPECT_TRUE(contains(page, "<b>2</b><i>times</i><span>larger RMS error than linear"));
}

TEST(Report, RefusesFiguresThatAreNoneAndWritesNothing) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.methods[4].errors.p99 = std::numeric_limits<double>::quiet_NaN();
  try {
    write_report(data, folder.path());
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(contains(error.what(), "methods.4.errors_mm.p99")) << error.what();
  }
  data = example();
  data.methods[2].errors.frame_max.pop_back();
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
  EXPECT_TRUE(Json::accept(testing::read_bytes(folder / "report.json")));
}

TEST(Plots, BreaksTheLineWhereFramesAreMissing) {
  LinePlot plot{"frame", "mm", {{1, 3, 5, 11, 13}, {}}, {{"a", "#fff", {1, 2, 1, 4, 0}, false}}};
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

// A take of every tenth frame is one curve beside a take of every frame; a frame by itself is a dot.
TEST(Plots, EveryTakeHasItsOwnStep) {
  const FrameAxis axis{{1, 2, 3, 1, 11, 21, 51}, {{"rom", 0}, {"flexed", 3}}};
  EXPECT_EQ(gaps(axis), (std::vector<bool>{true, false, false, true, false, false, true}));
  const std::string svg = line_plot({"frame", "mm", axis, {{"a", "#fff", {1, 2, 1, 4, 1, 2, 3}, false}}});
  EXPECT_EQ(count(svg, "h0"), 1u);
  EXPECT_TRUE(contains(svg, ">flexed</text>"));
}

TEST(Plots, LargerErrorsAreDrawnHigher) {
  const LinePlot plot{"frame", "mm", {{1, 2, 3}, {}}, {{"a", "#fff", {0.1, 1, 10}, true}}};
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
  EXPECT_TRUE(contains(line_plot({"frame", "mm", {{1}, {}}, {{"a", "#fff", {0}, false}}}), "</svg>"));
  EXPECT_TRUE(contains(bar_chart({}), "</svg>"));
  const Bar zero[] = {{"a", "#fff", 0, "0 mm"}};
  EXPECT_FALSE(contains(bar_chart(zero), "nan"));
}

TEST(Plots, TradeOffMarksTheBasisWhereItLies) {
  const std::string svg = trade_off_plot({{{100, 8}, {200, 4}, {300, 2}}, {200, 4}, 5});
  const auto centre = [&](const std::string& radius, std::size_t which) {
    std::size_t at = 0;
    for (std::size_t k = 0; k <= which; ++k) at = svg.find("r=\"" + radius + "\"", at + 1);
    const std::size_t begin = svg.rfind("<circle", at);
    double x = 0, y = 0;
    EXPECT_EQ(std::sscanf(svg.c_str() + begin, "<circle cx=\"%lf\" cy=\"%lf\"", &x, &y), 2);
    return std::pair(x, y);
  };
  EXPECT_EQ(centre("6.5", 0), centre("3.0", 1));              // the chosen one is the second of the curve
  EXPECT_EQ(centre("6.5", 1).first, centre("6.5", 0).first);  // as many bytes
  EXPECT_LT(centre("6.5", 1).second, centre("6.5", 0).second);
  EXPECT_LT(centre("3.0", 0).first, centre("3.0", 2).first);
  EXPECT_TRUE(contains(svg, ">this basis, expected: 4 mm<"));
  EXPECT_TRUE(contains(svg, ">held out: 5 mm<"));
}

// The picture's cells are the frames and regions: decoded sizes tell how many.
TEST(HeatStrip, HasARowPerRegionAndAScale) {
  HeatStrip strip{{{10, 11, 12}, {}}, {0.5, 0.25, 0.75}, {"elbow", "a & b"}, {{1, 2}, {3, 1}, {0, 3.1}}};
  const std::string svg = heat_strip(strip);
  for (const char* text : {">whole skin<", ">elbow<", ">a &amp; b<", ">10<", ">11<", ">12<", ">3.2 mm<", ">0.8<"}) {
    EXPECT_TRUE(contains(svg, text)) << text;
  }
  EXPECT_LT(svg.find(">whole skin<"), svg.find(">elbow<"));
  const std::string file = svg_file(svg);
  EXPECT_TRUE(contains(file, "xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(count(file, "<g "), count(file, "</g>"));
  HeatStrip hotter = strip;
  hotter.regions_mm[1][1] = 3.1;
  EXPECT_NE(heat_strip(hotter), svg);
  strip.regions_mm[2].pop_back();
  EXPECT_THROW(heat_strip(strip), Error);
  EXPECT_THROW(heat_strip({}), Error);
}

// More frames than pixels: the worst of those that share a column is seen, whichever it is.
TEST(HeatStrip, HidesNoFrameOfALongClip) {
  HeatStrip strip;
  for (int frame = 0; frame < 2000; ++frame) {
    strip.frames.frames.push_back(frame);
    strip.whole_mm.push_back(1);
    strip.regions_mm.emplace_back();
  }
  const std::string even = heat_strip(strip);
  for (const std::size_t bad : {std::size_t{999}, std::size_t{1000}, std::size_t{1001}}) {
    HeatStrip other = strip;
    other.whole_mm[bad] = 1.2;
    EXPECT_NE(heat_strip(other), even) << bad;
    EXPECT_TRUE(contains(heat_strip(other), ">1.2 mm<")) << bad;
  }
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
  EXPECT_DOUBLE_EQ(heat_scale(1.7), 2);
  EXPECT_DOUBLE_EQ(heat_scale(0.31), 0.32);
  EXPECT_DOUBLE_EQ(heat_scale(8.1), 10);
  EXPECT_DOUBLE_EQ(heat_scale(0), 1);
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
