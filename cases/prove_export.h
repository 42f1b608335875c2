// A C header of a force table, compiled and run: does it give what the table gives?
#pragma once

#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::cases {

struct Proof {
    bool equal = false;
    std::size_t points = 0;  ///< that were compared: in the range of the table, and a quarter of the coordinates beyond
    std::string sentence;    ///< how it went: how far off a value is at most; why it was not compared
};

/// Writes the header of `tables` with its self-test at 10,000 points into a folder of its own, compiles both by the C
/// compiler of this machine (cc, C99) and runs them: values, slopes, errors and flags are compared, to rounding (2e-15
/// of the numbers they are made of, 1e-6 for float, some units for whole numbers). `options`: as for the export that is
/// proved; its paths are not touched. Throws as tables::export_tables, core::Cancelled.
Proof prove_export(const std::vector<tables::ForceTable>& tables, tables::ExportOptions options,
                   core::Progress& progress = core::Progress::none());

}  // namespace underbody::cases
