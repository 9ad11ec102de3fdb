// A panel of the block inverse times a vector, in the order of runtime/cpu/panel_product.h: a workgroup is one panel,
// kBlockSize rows by kSumParts parts of the sum. The including kernel declares push, values and
// float panel_input(uint c), what column c is multiplied with.
shared float part_sums[kWorkgroupSize];

// All lanes of a workgroup must come here; the sum of row lane % kBlockSize is given to every lane.
float panel_product(InversePanel panel, uint lane) {
  uint row = lane % kBlockSize;
  uint column = panel.first_value - push.first_value + row;
  precise float sum = 0.0;
  for (uint c = lane / kBlockSize; c < panel.input_count; c += kSumParts) {
    sum += values[column + c * kBlockSize] * panel_input(c);
  }
  part_sums[lane] = sum;
  barrier();
  precise float low = part_sums[row] + part_sums[row + kBlockSize];
  precise float high = part_sums[row + 2 * kBlockSize] + part_sums[row + 3 * kBlockSize];
  precise float all = low + high;
  return all;
}
