// Every text of the panels that people wrote, in any script: names in files, messages, what is being typed.
#pragma once

#include <functional>
#include <string>

#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/panels/snapshot.h"

namespace bodyopt {

void visit_texts(const Snapshot& snapshot, const Controls& controls,
                 const std::function<void(const std::string&)>& visit);

}  // namespace bodyopt
