#include "report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "draw/colours.h"
#include "report/heat_strip.h"
#include "report/page.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/support/page_contents.h"
#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::report {
namespace {

using namespace draw;

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
  data.sections = SectionsReport{"flexed", 21, {"thigh", "upper arm"}, some_picture()};
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

// What the page shows is what programs read; tests/report/page.test.mjs is of how it shows it.
TEST(Report, PageHoldsTheFiguresThatProgramsRead) {
  const TemporaryFolder folder;
  write_report(example(), folder.path());
  const Json contents = testing::page_contents(folder / "report.html");
  EXPECT_EQ(contents.at("kind"), "report");
  EXPECT_EQ(contents.at("figures"), Json::parse(testing::read_bytes(folder / "report.json")));
}

TEST(Report, PageHoldsAPictureOfEveryKind) {
  const TemporaryFolder folder;
  const ReportData data = example();
  write_report(data, folder.path());
  const Json pictures = testing::page_contents(folder / "report.html").at("pictures");
  EXPECT_EQ(pictures.at("frames").size(), data.pictures.size());
  const Json expected = {{"src", data_url("image/png", encode_png(some_picture()))}, {"width", 6}, {"height", 2}};
  EXPECT_EQ(pictures.at("frames").at(3), expected);
  for (const char* name : {"mean_error", "flexed", "sections", "regions"})
    EXPECT_EQ(pictures.at(name), expected) << name;
  EXPECT_EQ(pictures.at("jiggle").at("strip"), expected);
  const Json animation = {{"src", "data:image/webp;base64,UklGRg=="}, {"width", 6}, {"height", 2}};
  EXPECT_EQ(pictures.at("jiggle").at("animation"), animation);
  EXPECT_EQ(pictures.at("jiggle").at("slow").at("src"), "data:image/webp;base64,V0VCUA==");
}

// Nothing is measured; what training tells of itself is there.
TEST(Report, NeedsNoHeldOutFrames) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.methods.clear();
  data.heldout = {};
  data.dataset.heldout_frames = 0;
  data.dataset.how_to_hold_out = "say --heldout";
  data.coverage.reset();
  data.mean_error.reset();
  data.flexed.reset();
  data.sections.reset();
  data.region_picture.reset();
  data.pictures.clear();
  data.jiggle.reset();
  data.demo.reset();
  write_report(data, folder.path());
  const Json contents = testing::page_contents(folder / "report.html");
  EXPECT_EQ(contents.at("figures").at("methods").size(), 0u);
  EXPECT_EQ(contents.at("figures").at("dataset").at("how_to_hold_out"), "say --heldout");
  EXPECT_EQ(contents.at("figures").at("regions").size(), data.regions.size());
  EXPECT_EQ(contents.at("pictures"), (Json{{"frames", Json::array()}}));
}

TEST(Report, WithoutADeviceThereAreNoPictures) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.pictures.clear();
  data.mean_error.reset();
  data.flexed.reset();
  data.sections.reset();
  data.region_picture.reset();
  data.jiggle->pictures.reset();
  write_report(data, folder.path());
  const Json contents = testing::page_contents(folder / "report.html");
  EXPECT_EQ(contents.at("pictures"), (Json{{"frames", Json::array()}}));
  EXPECT_FALSE(contents.at("figures").at("jiggle").contains("strip_frames"));
  EXPECT_EQ(contents.at("figures").at("jiggle").at("frame_max_mm").size(), data.jiggle->max_mm.size());
}

TEST(Report, JiggleIsOfAllFramesOrNotThere) {
  const TemporaryFolder folder;
  ReportData data = example();
  data.jiggle->max_mm.pop_back();
  EXPECT_THROW(write_report(data, folder.path()), Error);
  data.jiggle.reset();
  write_report(data, folder.path());
  const Json contents = testing::page_contents(folder / "report.html");
  EXPECT_FALSE(contents.at("figures").contains("jiggle"));
  EXPECT_FALSE(contents.at("pictures").contains("jiggle"));
}

// What was not simulated here has no draft to tell of.
TEST(Report, DraftIsToldWithTheSimulationAlone) {
  const TemporaryFolder folder;
  ReportData data = example();
  write_report(data, folder.path());
  const Json told = testing::page_contents(folder / "report.html").at("figures");
  EXPECT_EQ(told.at("seconds").at("draft"), 7);
  EXPECT_EQ(told.at("simulation").at("draft_rms_mm"), 3.5);
  EXPECT_EQ(told.at("simulation").at("draft_max_mm"), 20);
  data.demo.reset();
  write_report(data, folder.path());
  EXPECT_FALSE(testing::page_contents(folder / "report.html").at("figures").contains("simulation"));
}

// A name that is markup, or would end the script that holds it, stays a text of the JSON.
TEST(Report, PageIsSelfContainedAndNamesAreInert) {
  const TemporaryFolder folder;
  ReportData data = example();
  const std::string hostile = "</script><img src=x onerror=alert(1)><!-- <script>";
  data.character.name = hostile;
  data.regions[0].name = hostile;
  write_report(data, folder.path());
  const std::string page = testing::read_bytes(folder / "report.html");
  EXPECT_EQ(testing::page_contents(folder / "report.html").at("figures").at("character").at("name"), hostile);
  EXPECT_FALSE(contains(testing::page_json(page), "<"));
  EXPECT_FALSE(contains(page, "<img"));
  EXPECT_EQ(count(page, "<script"), count(page, "</script>"));
  for (const char* outside : {"<link", "@import", "url(", "file:", "src=\"", "fetch(", "import("}) {
    EXPECT_FALSE(contains(page, outside)) << outside;
  }
  EXPECT_TRUE(contains(page, "default-src 'none'; img-src data:;"));
  EXPECT_EQ(count(page, "http://") + count(page, "https:"), 1u);
  EXPECT_EQ(count(page, "createElementNS(\"http://www.w3.org/2000/svg\""), 1u);  // a name: nothing is loaded
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));  // by which other verbs know it: runtime/core/file_kind.cpp
  EXPECT_TRUE(contains(page, "<noscript>"));
}

// Text becomes text nodes: nothing in the scripts makes markup or code of a string.
TEST(Report, PageScriptsMakeNoMarkupOfText) {
  std::size_t scripts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kSourceFolder + "/report/page")) {
    if (entry.path().extension() != ".js") continue;
    ++scripts;
    const std::string script = testing::read_bytes(entry.path());
    for (const char* maker : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "Function(",
                              "srcdoc", "DOMParser", "createContextualFragment", "setTimeout", "javascript:"}) {
      EXPECT_FALSE(contains(script, maker)) << entry.path() << ": " << maker;
    }
  }
  EXPECT_GE(scripts, 7u);
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
  EXPECT_NO_THROW(testing::page_contents(folder / "report.html"));
}

// The picture's cells are the frames and regions: decoded sizes tell how many.
TEST(HeatStrip, HasARowPerRegionAndAScale) {
  HeatStrip strip{{10, 11, 12}, {0.5, 0.25, 0.75}, {"elbow", "a & b"}, {{1, 2}, {3, 1}, {0, 3.1}}};
  const std::string svg = heat_strip(strip);
  for (const char* text : {">whole skin<", ">elbow<", ">a &amp; b<", ">10<", ">11<", ">12<", ">3.2 mm<", ">0.8<"}) {
    EXPECT_TRUE(contains(svg, text)) << text;
  }
  EXPECT_LT(svg.find(">whole skin<"), svg.find(">elbow<"));
  EXPECT_TRUE(contains(svg, "xmlns=\"http://www.w3.org/2000/svg\""));
  for (const std::string tag : {"svg", "text", "line", "rect", "image"}) {
    EXPECT_EQ(count(svg, "<" + tag + " "), count(svg, "</" + tag + ">")) << tag;
  }
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
    strip.frames.push_back(frame);
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

// Numbers of a clip's frames are round, and have room.
TEST(HeatStrip, NumbersFramesByRoundNumbers) {
  HeatStrip strip;
  for (int frame = 101; frame <= 340; ++frame) {
    strip.frames.push_back(frame);
    strip.whole_mm.push_back(1);
    strip.regions_mm.emplace_back();
  }
  const std::string svg = heat_strip(strip);
  for (const char* text : {">101<", ">120<", ">140<", ">320<", ">340<"}) EXPECT_TRUE(contains(svg, text)) << text;
  EXPECT_FALSE(contains(svg, ">130<"));
}

TEST(Page, ColoursAreTheHeatMaps) {
  const Json colours = Json::parse(testing::page_json(page_text("show", {}, {}))).at("heat_colours");
  ASSERT_EQ(colours.size(), 64u);
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
  EXPECT_EQ(colours.front(), hex(0.5f / 64));
  EXPECT_EQ(colours.back(), hex(63.5f / 64));
}

TEST(Page, ScalesAreShort) {
  EXPECT_DOUBLE_EQ(heat_scale(1.7), 2);
  EXPECT_DOUBLE_EQ(heat_scale(0.31), 0.32);
  EXPECT_DOUBLE_EQ(heat_scale(8.1), 10);
  EXPECT_DOUBLE_EQ(heat_scale(0), 1);
}

TEST(Page, Base64AsInItsStandard) {  // RFC 4648, section 10
  const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, encoded] : examples) {
    const std::string text = plain;
    EXPECT_EQ(data_url("a/b", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}),
              std::string("data:a/b;base64,") + encoded);
  }
}

}  // namespace
}  // namespace bodyopt::report
