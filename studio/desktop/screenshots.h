// --screenshot: visits every panel of an opened study and saves pictures of the window.
#pragma once

#include <filesystem>

namespace underbody::studio {

class MainWindow;

/// Opens the study, waits for it, visits each panel (and has it demonstrate itself), writes `window.png`, `PANEL.png`
/// and `effects.png` into the folder. Returns the exit code: 0, or 3 when the study could not be opened (said on
/// stderr).
int take_screenshots(MainWindow& window, const std::filesystem::path& study, const std::filesystem::path& folder);

}  // namespace underbody::studio
