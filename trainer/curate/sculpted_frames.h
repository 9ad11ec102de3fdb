// The sculpts of a modifier of the type sculpt, and how they spread over poses:
//   offset of a frame = sum_k w_k delta_k,  w_k = f(d_k) (1 / d_k^2) / sum_j (1 / d_j^2)        (Shepard 1968)
// d_k: how far its pose is from that of sculpt k, in the joints that move what was sculpted; f: falls smoothly from 1
// at 0 to 1/2 at half the spread and to 0 at the spread. At the poses sculpted it is exact.
#pragma once

#include <string>
#include <vector>

#include "trainer/curate/pose_database.h"

namespace bodyopt {

class JsonObject;

struct SculptedFrame {
  std::size_t frame = 0;  // of the database
  Positions delta;        // V x 3, un-posed, metres
};

class SculptedFrames {
 public:
  // `parameters`: of the modifier; `place` is for messages. Throws Error(mismatch) where a sculpt is of another mesh,
  // or of no frame of the database, Error(file).
  SculptedFrames(const PoseDatabase& database, const JsonObject& parameters, const std::string& place);

  // In place of the sculpt of its frame, where there is one.
  void put(SculptedFrame sculpt);
  const std::vector<SculptedFrame>& sculpts() const { return sculpts_; }
  double spread() const { return spread_; }  // degrees
  const std::vector<std::uint32_t>& joints() const { return joints_; }
  // Of every sculpt its share w_k of a frame.
  std::vector<double> weights(std::size_t frame) const;
  // V x 3: what all of them add to a frame.
  Positions sum(std::size_t frame) const;

 private:
  void choose_joints();

  const PoseDatabase& database_;
  std::vector<SculptedFrame> sculpts_;
  std::vector<std::uint32_t> named_joints_, joints_;  // as the parameters say; or those that move what was sculpted
  double spread_;                                     // degrees
};

}  // namespace bodyopt
