// What leaves the program for a controller, written with the model as declared and with the model as found beside each
// other, and compared value by value.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "core/report_table.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::estimator {

struct ExportedAgain {
    /// One force or moment of both files, SI.
    struct Quantity {
        std::string name, unit;
        double largest_change = 0;  ///< |after - before| over the common grid of both tables
        std::vector<double> at;     ///< where, one value per axis
        double before_there = 0, after_there = 0;
        std::vector<double> along;  ///< values of the first axis, the others in the middle of their range
        std::vector<double> before, after;
    };
    std::string format;
    std::vector<std::filesystem::path> before, after;  ///< files; the first is the one asked for
    std::vector<std::string> axes, units;              ///< of the tables
    std::vector<double> middle;                        ///< of each axis
    std::vector<Quantity> quantities;
    core::Problems remarks;  ///< of the table as found: what was held, what was left out
    /// The chain as a table for the report, forces along the first axis.
    [[nodiscard]] std::vector<core::ReportTable> tables() const;
};

/// The export format whose files end like this one. Throws core::UsageError where none does.
std::string export_format_of(const std::filesystem::path& file);

/// Writes `folder`/declared/NAME from `before` and `folder`/NAME from `after`, in the format of the ending of NAME.
/// Identifiers in both files are the same, so that one takes the place of the other. Throws as dynamics::force_tables
/// and tables::export_tables do.
ExportedAgain export_again(const dynamics::Model& before, const dynamics::Model& after,
                           const std::filesystem::path& folder, const std::string& name, bool overwrite,
                           core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const ExportedAgain& again);

}  // namespace underbody::estimator
