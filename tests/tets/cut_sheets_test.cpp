#include <gtest/gtest.h>

#include <cmath>

#include "trainer/tets/fillable_skin.h"

namespace bodyopt::trainer {
namespace {

// Pages of a book: two triangles each, of these widths, that meet at one edge.
struct Book {
  explicit Book(const std::vector<double>& widths) {
    const auto pages = static_cast<Eigen::Index>(widths.size());
    vertices.resize(2 + 2 * pages, 3);
    triangles.resize(2 * pages, 3);
    vertices.topRows(2) << 0, 0, 0, 0, 0, 1;
    for (Eigen::Index p = 0; p < pages; ++p) {
      const double angle = 0.7 * static_cast<double>(p), width = widths[static_cast<std::size_t>(p)];
      const Eigen::RowVector3d away(width * std::cos(angle), width * std::sin(angle), 0);
      vertices.row(2 + 2 * p) = away;
      vertices.row(3 + 2 * p) = away + Eigen::RowVector3d(0, 0, 1);
      const auto low = static_cast<std::uint32_t>(2 + 2 * p);
      triangles.row(2 * p) << 0, low, low + 1;
      triangles.row(2 * p + 1) << 0, low + 1, 1;
    }
  }
  Positions vertices;
  Triangles triangles;
};

std::vector<bool> cut_pages(const Book& book) {
  const std::vector<bool> is_cut = sheet_triangles(book.vertices, book.triangles);
  std::vector<bool> pages;
  for (std::size_t t = 0; t < is_cut.size(); t += 2) {
    EXPECT_EQ(is_cut[t], is_cut[t + 1]) << "half a page";
    pages.push_back(is_cut[t]);
  }
  return pages;
}

TEST(CutSheets, TheSmallestGoFirstAndNoMoreThanMust) {
  EXPECT_EQ(cut_pages(Book({2, 3})), (std::vector{false, false}));
  EXPECT_EQ(cut_pages(Book({2, 1, 3})), (std::vector{false, true, false}));
  EXPECT_EQ(cut_pages(Book({2, 1, 3, 0.5})), (std::vector{false, true, false, true}));
}

// Two tetrahedra that share an edge have no open one, however small they are.
TEST(CutSheets, WhatIsClosedStays) {
  Positions vertices(6, 3);
  vertices << 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, -1, 0, 0, -1, -1, 0;
  Triangles triangles(8, 3);
  triangles << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2, 0, 1, 4, 0, 5, 1, 0, 4, 5, 1, 5, 4;
  EXPECT_EQ(sheet_triangles(vertices, triangles), std::vector<bool>(8, false));
}

}  // namespace
}  // namespace bodyopt::trainer
