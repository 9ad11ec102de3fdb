// Frame ranges: "1001-1100", "1001-1100x2", "5", and comma lists of them.
#pragma once

#include <string>
#include <vector>

namespace bodyopt {

// The frames in the order written, duplicates dropped. Throws Error(usage) on anything else; ':' is refused with a hint
// (farm systems disagree on what it means).
std::vector<int> parse_frame_range(const std::string& text);

// Range text for ascending frames; three or more with equal steps become a range, e.g. "1-7x3,12".
std::string format_frame_range(const std::vector<int>& frames);

// The frames of both, rising, each once.
std::vector<int> unite_frames(const std::vector<int>& a, const std::vector<int>& b);

}  // namespace bodyopt
