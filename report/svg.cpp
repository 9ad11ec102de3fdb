#include "report/svg.h"

#include <cstdio>

#include "draw/srgb.h"

namespace bodyopt {

std::string coordinate(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", value);
  return text;
}

std::string open_svg(double width, double height, const std::string& description) {
  return "<svg viewBox=\"0 0 " + coordinate(width) + " " + coordinate(height) + "\" role=\"img\" aria-label=\"" +
         escape_html(description) + "\" font-family=\"inherit\" font-size=\"13\">\n";
}

std::string svg_file(const std::string& svg) {
  const std::size_t end_of_tag = svg.find('>') + 1;
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"" +
         svg.substr(4, end_of_tag - 4) + "\n<g font-family=\"sans-serif\">\n" +
         "<rect width=\"100%\" height=\"100%\" fill=\"#1c1f25\"/>" +
         svg.substr(end_of_tag, svg.rfind("</svg>") - end_of_tag) + "</g>\n</svg>\n";
}

std::string line(double x0, double y0, double x1, double y1, const std::string& colour) {
  return "<line x1=\"" + coordinate(x0) + "\" y1=\"" + coordinate(y0) + "\" x2=\"" + coordinate(x1) + "\" y2=\"" +
         coordinate(y1) + "\" stroke=\"" + escape_html(colour) + "\"/>\n";
}

std::string rectangle(double x, double y, double width, double height, const std::string& colour) {
  return "<rect x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" width=\"" + coordinate(width) + "\" height=\"" +
         coordinate(height) + "\" rx=\"2\" fill=\"" + escape_html(colour) + "\"/>\n";
}

std::string text_at(double x, double y, const char* anchor, const std::string& colour, const std::string& text,
                    const std::string& attributes) {
  return "<text x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" text-anchor=\"" + anchor + "\" fill=\"" +
         escape_html(colour) + "\"" + attributes + ">" + escape_html(text) + "</text>\n";
}

std::string css_colour(const std::array<float, 3>& linear) {
  const std::array<std::uint8_t, 3> colour = srgb(linear);
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace bodyopt
