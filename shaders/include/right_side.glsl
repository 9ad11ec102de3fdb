// The index of an unknown of one of many right sides, as RightSide in runtime/cpu/dynamics_kernels.h. The including
// kernel declares push.
uint right_side_at(uint right_side, uint unknown) {
  return right_side / push.interleave * push.unknown_count * push.interleave + unknown * push.interleave +
         right_side % push.interleave;
}
