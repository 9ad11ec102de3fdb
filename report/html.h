// A self-contained HTML page: one style sheet, pictures as data, no script, nothing from elsewhere.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "draw/png.h"

namespace bodyopt {

// A cell of a table. With a value, the cell is a number: right-aligned, and compared with its column.
struct Cell {
  std::string text;
  std::optional<double> value;
};

struct Table {
  struct Column {
    std::string head;
    bool lowest_is_best = false;  // marks the lowest value
  };
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;  // each as long as columns; the first cell heads its row
};

// A figure that is read at a glance.
struct Headline {
  std::string value, unit, meaning;
};

class Page {
 public:
  Page(const std::string& title, const std::string& subtitle);

  // All text is escaped.
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  void headlines(std::span<const Headline> headlines);
  void table(const Table& table);
  // An inline SVG made by plots.h (taken as it is), and a sentence on what it shows.
  void chart(const std::string& svg, const std::string& caption);
  // A picture with labels above its equal columns, a title, a caption, and an SVG legend below.
  void picture(const Image& image, std::span<const std::string> column_labels, const std::string& title,
               const std::string& caption, const std::string& legend_svg);
  // The same of an animated WebP of width x height pixels, without a legend.
  void animation(std::span<const std::uint8_t> webp, std::uint32_t width, std::uint32_t height,
                 std::span<const std::string> column_labels, const std::string& title, const std::string& caption);

  std::string text() const;

 private:
  struct Figure;
  void figure(const Figure& figure);
  std::string title_, body_;
};

std::string encode_base64(std::span<const std::uint8_t> bytes);

}  // namespace bodyopt
