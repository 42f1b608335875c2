// Whether VTK can draw on the display that $DISPLAY names.
#pragma once

namespace underbody::postproc {

/// True when there is one and its X server has GLX with colours as VTK asks for: without, VTK ends the program. Asked
/// once for each name of a display; safe from any thread.
bool display_draws();

}  // namespace underbody::postproc
