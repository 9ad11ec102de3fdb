#include "geometry/mesh.h"

#include <algorithm>

namespace bodyopt {

double shared_weight(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b) {
  double sum = 0;
  for (const JointWeight& wa : a) {
    for (const JointWeight& wb : b) sum += wa.joint == wb.joint ? std::min(wa.weight, wb.weight) : 0;
  }
  return sum;
}

}  // namespace bodyopt
