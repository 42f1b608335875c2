// What the columns of a CFD-Post export become: coordinates, arrays with canonical names, components of vectors; in SI.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "postproc/field.h"
#include "postproc/importers/csv_sections.h"

namespace underbody::postproc {

struct CsvColumn {
    std::string name;  ///< in the file
    std::string unit;  ///< in the file, or as somebody stated it
    bool has_unit = false;
    const char* at = nullptr;  ///< in the header
    int coordinate = -1;       ///< 0 x, 1 y, 2 z
    std::string array;         ///< canonical name, "" when the column is skipped or a coordinate
    int component = 0;
    std::string si_unit;
    core::Conversion conversion;  ///< to it
};

/// The columns of a header line. Throws InputError where a unit has to be stated (coordinates, pressure, wall shear) or is
/// of another dimension; `problems` gets repeated columns, missing and unknown units.
std::vector<CsvColumn> plan_columns(std::string_view header, char separator, const std::string& zone, const CsvText& text,
                                    const ReadOptions& options, core::Problems& problems);

}  // namespace underbody::postproc
