#include "assets/caches/usda_part.h"

#include <charconv>
#include <cmath>

#include "assets/caches/usda.h"
#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"

namespace bodyopt {

UsdaPart::UsdaPart(const std::filesystem::path& path) : path_(path) {
  require_file(path);
  file_.open(path);
  if (!file_) throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
  while (next() && line_ != kUsdaPointSamples) {
    if (line_.starts_with(kUsdaLastFrame)) {
      last_frame_ = line_;
    } else if (!line_.starts_with("    startTimeCode = ")) {
      head_ += line_ + '\n';
    }
    (last_frame_.empty() ? before_ : after_) += line_ + '\n';
  }
  if (line_ != kUsdaPointSamples) refuse();
  samples_begin_ = file_.tellg();
  find_frames();
}

void UsdaPart::for_samples(const std::string& opening, const std::function<void(const std::string&)>& take) {
  file_.clear();
  file_.seekg(samples_begin_);
  line_ = kUsdaPointSamples;
  while (line_ != opening) {
    if (!next()) refuse();
  }
  while (next() && line_ != kUsdaSamplesEnd) take(line_);
  if (line_ != kUsdaSamplesEnd) refuse();
}

std::string UsdaPart::opening(const std::string& last_frame) const {
  return before_ + last_frame + after_.substr(last_frame_.size());
}

std::vector<float> UsdaPart::points(std::size_t sample) {
  std::vector<float> values;
  std::size_t at = 0;
  for_samples(kUsdaPointSamples, [&](const std::string& line) {
    if (at++ != sample) return;
    const char *place = line.data() + line.find('['), *const end = line.data() + line.size();
    while (true) {
      while (place != end && (*place == '[' || *place == '(' || *place == ')' || *place == ',' || *place == ' '))
        ++place;
      if (place == end || *place == ']') break;
      float value = 0;
      const auto [stop, failure] = std::from_chars(place, end, value);
      if (failure != std::errc() || !std::isfinite(value)) refuse();
      values.push_back(value);
      place = stop;
    }
  });
  if (values.empty() || values.size() % 3 != 0) refuse();
  return values;
}

void UsdaPart::refuse() const {
  if (head_.find("def SkelRoot") != std::string::npos) {
    throw Error(ErrorKind::file, path_,
                ": is a rig ('eval --rigged'), of which parts cannot be joined or drawn: write them without --rigged");
  }
  throw Error(ErrorKind::file, path_,
              ": is no .usda that 'bodyopt eval' wrote, or is damaged or cut off: only such can be joined or drawn");
}

void UsdaPart::find_frames() {
  for_samples(kUsdaPointSamples, [&](const std::string& line) {
    int frame = 0;
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos) refuse();
    const auto [stop, failure] = std::from_chars(line.data() + begin, line.data() + line.size(), frame);
    if (failure != std::errc() || !std::string_view(stop).starts_with(": [") || !line.ends_with("],")) refuse();
    if (!frames_.empty() && frame <= frames_.back()) refuse();
    frames_.push_back(frame);
  });
  if (frames_.empty()) refuse();
  between_ = std::string(kUsdaSamplesEnd) + '\n';
  while (next() && line_ != kUsdaNormalSamples) between_ += line_ + '\n';
  has_normals_ = line_ == kUsdaNormalSamples;
  if (!has_normals_ && !between_.ends_with("}\n}\n")) refuse();
}

}  // namespace bodyopt
