// What the display refuses.
#pragma once

namespace bodyopt {

// From now on what an X display refuses is a warning on standard error; by itself Xlib would end the program, as when
// another program's window, from which files are dragged, goes away meanwhile. GLFW takes the handler away whenever it
// opens a window: to be called after that. Does nothing on other displays.
void survive_display_errors();

}  // namespace bodyopt
