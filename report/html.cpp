#include "report/html.h"

#include <limits>

#include "report/svg.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: dark; --ground: #14161a; --panel: #1c1f25; --line: #2d3139; --text: #e6e8ec; --quiet: #a4a9b3;
        --accent: #f2b866; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--text);
       font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 40px 24px 72px; }
h1 { font-size: 2.1rem; line-height: 1.2; margin: 0 0 6px; font-weight: 650; letter-spacing: -0.01em; }
h2 { font-size: 1.25rem; margin: 52px 0 10px; font-weight: 620; }
p { margin: 8px 0 14px; max-width: 78ch; }
.subtitle { color: var(--quiet); margin-bottom: 28px; }
.headlines { display: grid; grid-template-columns: repeat(auto-fit, minmax(200px, 1fr)); gap: 14px; margin: 22px 0; }
.headline { background: var(--panel); border: 1px solid var(--line); border-radius: 10px; padding: 16px 18px; }
.headline b { font-size: 2rem; font-weight: 640; color: var(--accent); letter-spacing: -0.02em; }
.headline i { font-style: normal; color: var(--accent); margin-left: 5px; }
.headline span { display: block; color: var(--quiet); font-size: 0.9rem; line-height: 1.4; margin-top: 4px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; margin: 10px 0 18px; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 9px 14px; border-bottom: 1px solid var(--line); vertical-align: top; }
thead th { color: var(--quiet); font-weight: 550; font-size: 0.9rem; }
tbody th { font-weight: 620; white-space: nowrap; }
.number { text-align: right; white-space: nowrap; }
.best { color: var(--accent); font-weight: 650; }
figure { margin: 18px 0 30px; background: var(--panel); border: 1px solid var(--line); border-radius: 10px;
         overflow: hidden; }
figure.chart { padding: 18px 18px 4px; }
figure svg { display: block; width: 100%; height: auto; }
figure img { display: block; width: 100%; height: auto; }
figcaption { padding: 12px 18px 14px; color: var(--quiet); font-size: 0.94rem; }
figcaption b { color: var(--text); display: block; font-weight: 620; font-size: 1.05rem; }
.columns { display: flex; }
.columns span { flex: 1; text-align: center; padding: 10px 4px; color: var(--text); font-size: 0.92rem; }
.under { display: flex; flex-wrap: wrap; align-items: center; justify-content: space-between; }
.under figcaption { flex: 1 1 380px; }
.legend { flex: 0 1 400px; padding: 10px 18px; }
)";

double best_of(const Table& table, std::size_t column) {
  double best = std::numeric_limits<double>::infinity();
  for (const std::vector<Cell>& row : table.rows) {
    if (row[column].value && *row[column].value < best) best = *row[column].value;
  }
  return best;
}

bool is_numeric(const Table& table, std::size_t column) {
  for (const std::vector<Cell>& row : table.rows) {
    if (row[column].value) return true;
  }
  return false;
}

}  // namespace

Page::Page(const std::string& title, const std::string& subtitle) : title_(title) {
  body_ = "<h1>" + escape_html(title) + "</h1>\n<p class=\"subtitle\">" + escape_html(subtitle) + "</p>\n";
}

void Page::heading(const std::string& text) { body_ += "<h2>" + escape_html(text) + "</h2>\n"; }

void Page::paragraph(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }

void Page::headlines(std::span<const Headline> headlines) {
  body_ += "<div class=\"headlines\">\n";
  for (const Headline& h : headlines) {
    body_ += "<div class=\"headline\"><b>" + escape_html(h.value) + "</b><i>" + escape_html(h.unit) + "</i><span>" +
             escape_html(h.meaning) + "</span></div>\n";
  }
  body_ += "</div>\n";
}

void Page::table(const Table& table) {
  for (const std::vector<Cell>& row : table.rows) {
    if (row.size() != table.columns.size()) {
      throw Error(ErrorKind::mismatch, "table: a row of " + std::to_string(row.size()) + " cells under " +
                                           std::to_string(table.columns.size()) + " columns");
    }
  }
  body_ += "<div class=\"scroll\"><table>\n<thead><tr>";
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    body_ += std::string("<th scope=\"col\"") + (is_numeric(table, c) ? " class=\"number\">" : ">") +
             escape_html(table.columns[c].head) + "</th>";
  }
  body_ += "</tr></thead>\n<tbody>\n";
  for (const std::vector<Cell>& row : table.rows) {
    body_ += "<tr><th scope=\"row\">" + escape_html(row[0].text) + "</th>";
    for (std::size_t c = 1; c < row.size(); ++c) {
      const bool best = table.columns[c].lowest_is_best && row[c].value && *row[c].value <= best_of(table, c);
      const char* style = best ? " class=\"number best\">" : row[c].value ? " class=\"number\">" : ">";
      body_ += std::string("<td") + style + escape_html(row[c].text) + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::chart(const std::string& svg, const std::string& caption) {
  body_ += "<figure class=\"chart\">\n" + svg + "<figcaption>" + escape_html(caption) + "</figcaption></figure>\n";
}

struct Page::Figure {
  const char* type;  // of the bytes
  std::span<const std::uint8_t> bytes;
  std::uint32_t width, height;
  std::span<const std::string> column_labels;
  const std::string &title, &caption, &legend_svg;
};

void Page::figure(const Figure& figure) {
  body_ += "<figure>\n<div class=\"columns\">";
  for (const std::string& label : figure.column_labels) body_ += "<span>" + escape_html(label) + "</span>";
  body_ += "</div>\n<img alt=\"" + escape_html(figure.title) + "\" width=\"" + std::to_string(figure.width) +
           "\" height=\"" + std::to_string(figure.height) + "\" src=\"data:" + figure.type + ";base64," +
           encode_base64(figure.bytes) + "\">\n<div class=\"under\"><figcaption><b>" + escape_html(figure.title) +
           "</b>" + escape_html(figure.caption) + "</figcaption><div class=\"legend\">" + figure.legend_svg +
           "</div></div></figure>\n";
}

void Page::picture(const Image& image, std::span<const std::string> column_labels, const std::string& title,
                   const std::string& caption, const std::string& legend_svg) {
  const std::vector<std::uint8_t> png = encode_png(image);
  figure({"image/png", png, image.width, image.height, column_labels, title, caption, legend_svg});
}

void Page::animation(std::span<const std::uint8_t> webp, std::uint32_t width, std::uint32_t height,
                     std::span<const std::string> column_labels, const std::string& title, const std::string& caption) {
  figure({"image/webp", webp, width, height, column_labels, title, caption, ""});
}

std::string Page::text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_html(title_) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body><main>\n" + body_ +
         "</main></body>\n</html>\n";
}

std::string encode_base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

}  // namespace bodyopt
