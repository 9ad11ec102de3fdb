#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "runtime/core/error.h"
#include "viewport/picture_files.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

std::string name(const std::string& pattern, int frame) { return FrameSequenceName(pattern, 100)(frame).string(); }

TEST(FrameSequenceName, EachHashIsADigit) {
  EXPECT_EQ(name("img.####.png", 7), "img.0007.png");
  EXPECT_EQ(name("img.####.png", 1001), "img.1001.png");
  EXPECT_EQ(name("img.####.png", 123456), "img.123456.png");
  EXPECT_EQ(name("#", 42), "42");
  EXPECT_EQ(name("out/##_x.png", 3), "out/03_x.png");
}

TEST(FrameSequenceName, PercentIsAsPrintfWritesIt) {
  for (const int frame : {0, 7, -5, -12345, 99999, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    char expected[64];
    std::snprintf(expected, sizeof(expected), "img.%04d.png", frame);
    EXPECT_EQ(name("img.%04d.png", frame), expected);
    EXPECT_EQ(name("img.####.png", frame), expected);
    std::snprintf(expected, sizeof(expected), "img.%d.png", frame);
    EXPECT_EQ(name("img.%d.png", frame), expected);
    std::snprintf(expected, sizeof(expected), "img.%012d.png", frame);
    EXPECT_EQ(name("img.%012d.png", frame), expected);
  }
}

TEST(FrameSequenceName, FoldersMayHaveAnyName) {
  EXPECT_EQ(name("/a/sh#1/100%d/img.##.png", 5), "/a/sh#1/100%d/img.05.png");
  EXPECT_FALSE(shows_motion("/a/sh#1/100%d/img.png"));
  EXPECT_TRUE(shows_motion("/a/sh#1/100%d/img.##.png"));
}

TEST(FrameSequenceName, OnePictureNeedsNoPlace) {
  EXPECT_EQ(FrameSequenceName("a/img.png", 1)(1001), "a/img.png");
  EXPECT_EQ(FrameSequenceName("a/100%.png", 1)(1001), "a/100%.png");
  EXPECT_EQ(FrameSequenceName("a/img.##.png", 1)(8), "a/img.08.png");
}

TEST(FrameSequenceName, RefusesNamesThatFramesWouldShareOrThatAreAmbiguous) {
  for (const char* pattern : {"img.png", "img.%5d.png", "a#b/img.png", "img.%s.png", "##.##.png", "%04d#.png", ""}) {
    try {
      FrameSequenceName refused(pattern, 2);
      ADD_FAILURE() << pattern;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(error.what()).find("img.####.png"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace bodyopt::testing
