// What a solver's report holds, in numbers: for `info`.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "postproc/importers/reports/reports.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::postproc {

struct ReportSummary {
    std::string file;
    std::optional<Monitor> monitor;
    std::vector<std::optional<IterationScatter>>
        scatter;  ///< one a column of the monitor; nothing for the first, and where it is too short
    std::optional<Plot> plot;
    std::vector<ForceReport> forces;
    core::Problems problems;
};

/// Monitors, transcripts, plots and force reports; nothing for any other file. Throws core::InputError for one that is
/// damaged.
std::optional<ReportSummary> summarise_report(const std::filesystem::path& path);

/// All numbers: columns and curves whole. Forces in N, moments in N m, the rest in the solver's units.
void to_json(nlohmann::json& json, const ReportSummary& summary);

}  // namespace underbody::postproc
