// Where an unknown of one of many right sides stands, as runtime/cpu/right_side.h. The including kernel declares push.
uint right_side_at(uint right_side, uint unknown) {
  return right_side / push.interleave * push.unknown_count * push.interleave + unknown * push.interleave +
         right_side % push.interleave;
}
