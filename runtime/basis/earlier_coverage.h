// Coverage as files of older versions have it: JSON among the metadata, in millimetres and by joints' names.
#pragma once

#include <string>

#include "runtime/basis/basis.h"

namespace bodyopt {

// `basis`: with skeleton and residual. Regions without a name get that of their first joint. Throws Error(file) whose
// text starts with `origin`; counts that do not fit the residual are left for validate() to refuse.
CoverageTable earlier_coverage(const std::string& text, const Basis& basis, const std::string& origin);

}  // namespace bodyopt
