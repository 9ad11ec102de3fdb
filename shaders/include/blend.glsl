// What residual_blend and modify_blend share: the sum of a vertex' entries. The including kernel declares push,
// blend_begin, blend and coefficients. Values are `precise`: a multiply and an add stay two roundings, as on the CPU.

// `entry`: of those bound.
float blend_number(uint entry, uint component, uint lane) {
  uint word = blend[entry].numbers[component * kLaneWords + lane / 4];
  return float(bitfieldExtract(int(word), int(8 * (lane % 4)), 8));
}

// first_coefficient: of the frame.
void blend_sum(uint vertex, uint first_coefficient, out float sum[3]) {
  uint block = vertex / kBlockSize, lane = vertex % kBlockSize;
  precise float x = 0.0, y = 0.0, z = 0.0;
  uint end = blend_begin[block + 1] - push.first_entry;
  for (uint e = blend_begin[block] - push.first_entry; e < end; ++e) {
    uint head = blend[e].scale_coefficient;
    precise float weight = coefficients[first_coefficient + (head >> 16)] * (unpackHalf2x16(head).x * kBlendFraction);
    x += weight * blend_number(e, 0, lane);
    y += weight * blend_number(e, 1, lane);
    z += weight * blend_number(e, 2, lane);
  }
  sum[0] = x;
  sum[1] = y;
  sum[2] = z;
}
