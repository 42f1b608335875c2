// Pictures of the window without anybody at it.
#pragma once

#include <filesystem>

namespace underbody::studio {

class MainWindow;

/// Lets the window work until nothing runs beside it and it has drawn itself.
void settle(MainWindow& window);

/// Opens the study (or replays the log), visits each workspace, and writes `empty.png`, `window.png`, WORKSPACE.png,
/// WORKSPACE-used.png and `effects.png`. Returns the exit code.
int take_screenshots(MainWindow& window, const std::filesystem::path& study, const std::filesystem::path& log,
                     const std::filesystem::path& folder);

}  // namespace underbody::studio
