// A simulated data set as files.
#pragma once

#include <filesystem>
#include <string>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/model/measurements.h"

namespace underbody::test {

/// dataset.toml with motion and noise, and a file a run.
inline void write_runs(const dynamics::Measurements& data, const std::filesystem::path& folder,
                       const std::string& motion, const std::string& title) {
    std::filesystem::create_directories(folder);
    std::string text = "kind = \"time_series\"\nmotion = \"" + motion + "\"\ntitle = \"" + title + "\"\n\n[noise]\n";
    for (const auto& [name, sigma] : data.noise) {
        text += name + " = \"" + core::format_number(sigma, 6) + " " + core::find_quantity(name)->unit + "\"\n";
    }
    for (const dynamics::MeasuredRun& run : data.runs) {
        core::write_csv(folder / (run.name + ".csv"), run.table);
        text += "\n[[run]]\nfile = \"" + run.name + ".csv\"\n";
    }
    core::write_file(folder / "dataset.toml", text);
}

}  // namespace underbody::test
