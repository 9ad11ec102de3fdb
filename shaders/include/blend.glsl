// The sum of a vertex' entries: shared by residual_blend and modify_blend. The including kernel declares kFrames, push,
// blend_begin, blend and coefficients. Values are `precise`: a multiply and an add stay two roundings, as on the CPU.

// `entry`: of those bound.
float blend_number(uint entry, uint component, uint lane) {
  uint word = blend[entry].numbers[component * kLaneWords + lane / 4];
  return float(bitfieldExtract(int(word), int(8 * (lane % 4)), 8));
}

// Sums for kFrames frames, whose coefficients stand one after the other.
void blend_sums(uint vertex, uint first_frame, uint coefficient_count, precise out float sum[kFrames][3]) {
  uint block = vertex / kBlockSize, lane = vertex % kBlockSize;
  for (uint f = 0; f < kFrames; ++f) {
    for (int i = 0; i < 3; ++i) sum[f][i] = 0.0;
  }
  uint end = blend_begin[block + 1] - push.first_entry;
  for (uint e = blend_begin[block] - push.first_entry; e < end; ++e) {
    uint head = blend[e].scale_coefficient;
    float scale = unpackHalf2x16(head).x * kBlendFraction;
    float x = blend_number(e, 0, lane), y = blend_number(e, 1, lane), z = blend_number(e, 2, lane);
    for (uint f = 0; f < kFrames; ++f) {
      precise float weight = coefficients[(first_frame + f) * coefficient_count + (head >> 16)] * scale;
      sum[f][0] += weight * x;
      sum[f][1] += weight * y;
      sum[f][2] += weight * z;
    }
  }
}
