// What the columns of a CFD-Post export become: coordinates, arrays with canonical names, components of vectors; in SI.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/importers/csv/csv_sections.h"

namespace underbody::postproc {

struct CsvColumn {
    std::string name;  ///< in the file
    std::string unit;  ///< in the file, or as somebody stated it
    bool has_unit = false;
    const char* at = nullptr;  ///< in the header
    int coordinate = -1;       ///< 0 x, 1 y, 2 z
    std::string array;         ///< its name, "" when the column is skipped or a coordinate of points
    int component = -1;        ///< of the vector `array`; -1: an array of its own
    std::string si_unit;
    core::Conversion conversion;  ///< to it
};

/// Of a row more columns than this are no export but damage.
inline constexpr std::size_t most_csv_columns = 10000;

/// The columns of a header line; those that `options.arrays` does not ask for are skipped. Throws InputError where the
/// unit of a coordinate, a pressure or a wall shear has to be stated or is of another dimension; `problems` gets
/// repeated columns, missing, odd and unknown units, columns of one meaning and incomplete vectors.
std::vector<CsvColumn> plan_columns(std::string_view header, char separator, const std::string& zone,
                                    const CsvText& text, const ReadOptions& options, core::Problems& problems);

/// Which of x, y, z there are. Without x and y a block is a table, with its coordinates among the arrays.
std::array<bool, 3> coordinates_in(const std::vector<CsvColumn>& columns);

}  // namespace underbody::postproc
