// Netgen's nglib, loaded when a skin is first filled: with Open CASCADE, which it brings along, it would take most of
// the time in which the program starts.
#pragma once

#include <cstddef>

namespace nglib {
#include <nglib.h>
}

namespace bodyopt {

// What of nglib.h is used, without its prefix Ng_.
struct Netgen {
  decltype(&nglib::Ng_Init) init;
  decltype(&nglib::Ng_NewMesh) new_mesh;
  decltype(&nglib::Ng_DeleteMesh) delete_mesh;
  decltype(&nglib::Ng_AddPoint) add_point;
  decltype(&nglib::Ng_AddSurfaceElement) add_surface_element;
  decltype(&nglib::Ng_GenerateVolumeMesh) generate_volume_mesh;
  decltype(&nglib::Ng_GetNP) point_count;
  decltype(&nglib::Ng_GetPoint) point;
  decltype(&nglib::Ng_GetNE) element_count;
  decltype(&nglib::Ng_GetVolumeElement) volume_element;
  void (*reset_parameters)(nglib::Ng_Meshing_Parameters*);  // to Netgen's own
};

// The same for all, from any thread. Throws Error(file) when the library cannot be loaded.
const Netgen& netgen();

// Begins as Netgen's own: the constructor of nglib.h is not linked.
union NetgenParameters {
  NetgenParameters() { netgen().reset_parameters(&values); }
  nglib::Ng_Meshing_Parameters values;
};

}  // namespace bodyopt
