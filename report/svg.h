// Pieces of SVG for reports on a dark page. All text is escaped; numbers have one decimal.
#pragma once

#include <array>
#include <string>

namespace bodyopt {

constexpr const char* kGridColour = "#33373f";
constexpr const char* kTextColour = "#a4a9b3";
constexpr const char* kStrongTextColour = "#e6e8ec";
constexpr double kCharacterWidth = 7.2;  // of a text in the usual size, about
constexpr double kPlotWidth = 960;       // of what is as wide as the page

std::string coordinate(double value);

// Begins an SVG of width x height units that scales with the page.
std::string open_svg(double width, double height, const std::string& description);
// An SVG of the page as a file of its own: with its namespace, on the page's ground.
std::string svg_file(const std::string& svg);

std::string line(double x0, double y0, double x1, double y1, const std::string& colour);
std::string rectangle(double x, double y, double width, double height, const std::string& colour);
// anchor: "start", "middle" or "end"; attributes: more of the element's, with a space before each.
std::string text_at(double x, double y, const char* anchor, const std::string& colour, const std::string& text,
                    const std::string& attributes = "");

// A colour of the renderer (linear RGB), for CSS.
std::string css_colour(const std::array<float, 3>& linear);

std::string escape_html(const std::string& text);

}  // namespace bodyopt
