#include "runtime/vulkan/kernels/jiggle_tables.h"

namespace bodyopt::vulkan {

std::vector<NodeRows> node_rows(const TetTable& tets, const JiggleTable& jiggle) {
  std::vector<NodeRows> rows(tets.corner_begin.size());
  for (std::size_t n = 0; n < rows.size(); ++n) rows[n] = {tets.corner_begin[n], jiggle.held_begin[n]};
  return rows;
}

std::vector<HeldNode> held_nodes(const JiggleTable& jiggle) {
  std::vector<HeldNode> held(jiggle.held_columns.size());
  for (std::size_t k = 0; k < held.size(); ++k) held[k] = {jiggle.held_columns[k], jiggle.held_values[k]};
  return held;
}

}  // namespace bodyopt::vulkan
