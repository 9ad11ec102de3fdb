#include "base/frame_range.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Frames = std::vector<int>;

TEST(FrameRange, ReadsSinglesRangesStepsAndLists) {
  EXPECT_EQ(parse_frame_range("5"), (Frames{5}));
  EXPECT_EQ(parse_frame_range("1001-1004"), (Frames{1001, 1002, 1003, 1004}));
  EXPECT_EQ(parse_frame_range("1-8x3"), (Frames{1, 4, 7}));
  EXPECT_EQ(parse_frame_range("10,1-3,2-4"), (Frames{10, 1, 2, 3, 4}));
  EXPECT_EQ(parse_frame_range("-3--1"), (Frames{-3, -2, -1}));
}

TEST(FrameRange, RefusesAnythingElse) {
  for (const char* text :
       {"",      ",",   "1,",    ",1",          "1-",           "x",  "1-5x", "1-5x0", "1-5x-1", "5-1", "1 - 5", "1:5",
        "1-5:2", "1x2", "1-2-3", "99999999999", "1-2000000000", "+1", "1.5",  "0x10",  "1-5x2x2"}) {
    try {
      parse_frame_range(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << text;
    }
  }
}

TEST(FrameRange, ColonIsRefusedWithAHint) {
  try {
    parse_frame_range("1:10");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("1001-1100x2"), std::string::npos);
  }
}

TEST(FrameRange, LastFrameOfTheIntegersDoesNotOverflow) {
  EXPECT_EQ(parse_frame_range("2147483645-2147483647x2"), (Frames{2147483645, 2147483647}));
  EXPECT_EQ(format_frame_range({-2147483647, 0, 2147483647}), "-2147483647-2147483647x2147483647");
}

TEST(FrameRange, FormatsRuns) {
  EXPECT_EQ(format_frame_range({}), "");
  EXPECT_EQ(format_frame_range({7}), "7");
  EXPECT_EQ(format_frame_range({1, 2, 3, 4}), "1-4");
  EXPECT_EQ(format_frame_range({1, 4, 7, 12}), "1-7x3,12");
  EXPECT_EQ(format_frame_range({1, 5, 6, 7}), "1,5-7");
}

TEST(FrameRange, FormattedTextReadsBack) {
  unsigned state = 1;
  for (int round = 0; round < 200; ++round) {
    Frames frames;
    for (int frame = -20; frame < 60; ++frame) {
      state = state * 1664525u + 1013904223u;
      if ((state >> 24) % 3 != 0) frames.push_back(frame);
    }
    if (frames.empty()) continue;
    EXPECT_EQ(parse_frame_range(format_frame_range(frames)), frames);
  }
}

}  // namespace
}  // namespace bodyopt
