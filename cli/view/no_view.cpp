// bodyopt view where the viewport was not built: says so.
#include "cli/arguments/common.h"
#include "cli/view/view.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {

void add_view(CLI::App& app) {
  CLI::App& verb = add_verb(app, "view", "The animators' viewport, which this program was built without");
  verb.allow_extras();
  verb.callback([] {
    throw Error(ErrorKind::usage,
                "this program was built without the viewport, as nodes of a farm have it: configure it with "
                "-D BODYOPT_BUILD_VIEWER=ON, which needs GLFW, X11 and Dear ImGui (viewer_packages of "
                "scripts/packages.sh), or run 'view' where that is done");
  });
}

}  // namespace bodyopt::cli
