// Deformation gradient of a tet, in the order of runtime/cpu/deformation.h. The including kernel declares tets, shapes
// and nodes.

// F = D(X) D^-1, row-major. first: offset of the frame's nodes.
void deformation_gradient(uint tet, uint first, out float f[9]) {
  uint origin = first + 3 * tets[4 * tet];
  precise float edges[9];
  for (uint j = 0; j < 3; ++j) {
    uint corner = first + 3 * tets[4 * tet + 1 + j];
    for (uint i = 0; i < 3; ++i) edges[3 * i + j] = nodes[corner + i] - nodes[origin + i];
  }
  for (uint i = 0; i < 3; ++i) {
    for (uint k = 0; k < 3; ++k) {
      precise float value = edges[3 * i] * shapes[tet].inverse_edges[k] +
                            edges[3 * i + 1] * shapes[tet].inverse_edges[3 + k] +
                            edges[3 * i + 2] * shapes[tet].inverse_edges[6 + k];
      f[3 * i + k] = value;
    }
  }
}
