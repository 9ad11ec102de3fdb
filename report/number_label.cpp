#include "report/number_label.h"

#include <algorithm>
#include <string>

namespace bodyopt {
namespace {

constexpr int kColumns = 3, kRows = 5, kScale = 3, kMargin = 3;  // of a digit; pixels a dot; pixels around the number

// Dots of every digit, row by row from the top left.
constexpr int kDigits[10] = {0b111'101'101'101'111, 0b010'110'010'010'111, 0b111'001'111'100'111, 0b111'001'111'001'111,
                             0b101'101'111'001'001, 0b111'100'111'001'111, 0b111'100'111'101'111, 0b111'001'001'001'001,
                             0b111'101'111'101'111, 0b111'101'111'001'111};

bool is_dot(const std::string& digits, int x, int y) {
  if (x < 0 || y < 0) return false;
  const int dot_x = x / kScale, row = y / kScale, column = dot_x % (kColumns + 1);
  const auto place = static_cast<std::size_t>(dot_x / (kColumns + 1));
  if (place >= digits.size() || column >= kColumns || row >= kRows) return false;
  return kDigits[digits[place] - '0'] >> (kRows * kColumns - 1 - (row * kColumns + column)) & 1;
}

}  // namespace

void draw_number(Image& image, int number, int x, int y) {
  const std::string digits = std::to_string(number);
  const int width = kScale * ((kColumns + 1) * static_cast<int>(digits.size()) - 1) + 2 * kMargin;
  const int height = kScale * kRows + 2 * kMargin;
  const int right = static_cast<int>(image.width) - width, bottom = static_cast<int>(image.height) - height;
  const int left = std::max(0, std::min(x - width / 2, right)), top = std::max(0, std::min(y - height / 2, bottom));
  for (int j = 0; j < std::min(height, static_cast<int>(image.height)); ++j) {
    for (int i = 0; i < std::min(width, static_cast<int>(image.width)); ++i) {
      const std::uint8_t shade = is_dot(digits, i - kMargin, j - kMargin) ? 255 : 30;
      const auto pixel = static_cast<std::size_t>(top + j) * image.width + static_cast<std::size_t>(left + i);
      std::fill_n(image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel), 3, shade);
    }
  }
}

}  // namespace bodyopt
