#include "trainer/tets/netgen.h"

#include <dlfcn.h>

#include <string>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kLibrary = BODYOPT_NETGEN;

[[noreturn]] void refuse_library() {
  throw Error(ErrorKind::file, kLibrary, ": expected Netgen's library, which fills skins with ",
              "tetrahedra: ", dlerror(), "; is the package libnglib-6.2 installed?");
}

// `name`: as compilers write a C++ function's name into a library.
template <typename Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) refuse_library();
}

Netgen load() {
  void* library = dlopen(kLibrary, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) refuse_library();
  Netgen functions{};
  find(library, "_ZN5nglib7Ng_InitEv", functions.init);
  find(library, "_ZN5nglib10Ng_NewMeshEv", functions.new_mesh);
  find(library, "_ZN5nglib13Ng_DeleteMeshEPPv", functions.delete_mesh);
  find(library, "_ZN5nglib11Ng_AddPointEPPvPd", functions.add_point);
  find(library, "_ZN5nglib20Ng_AddSurfaceElementEPPvNS_23Ng_Surface_Element_TypeEPi", functions.add_surface_element);
  find(library, "_ZN5nglib21Ng_GenerateVolumeMeshEPPvPNS_21Ng_Meshing_ParametersE", functions.generate_volume_mesh);
  find(library, "_ZN5nglib8Ng_GetNPEPPv", functions.point_count);
  find(library, "_ZN5nglib11Ng_GetPointEPPviPd", functions.point);
  find(library, "_ZN5nglib8Ng_GetNEEPPv", functions.element_count);
  find(library, "_ZN5nglib19Ng_GetVolumeElementEPPviPi", functions.volume_element);
  find(library, "_ZN5nglib21Ng_Meshing_Parameters16Reset_ParametersEv", functions.reset_parameters);
  return functions;
}

}  // namespace

const Netgen& netgen() {
  static const Netgen functions = load();
  return functions;
}

}  // namespace bodyopt
