// Workbench's table of design points (its export as CSV): the conditions of cases.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/study_spec.h"
#include "core/error.h"
#include "core/toml.h"

namespace underbody::cases {

/// A column of the table.
struct DesignParameter {
    std::string id;        ///< "P1"; empty where the export gives only names
    std::string name;      ///< "gap"
    std::string unit;      ///< as written; empty: none
    std::string quantity;  ///< the condition that it is; empty: none
};

struct DesignPoint {
    std::string name;  ///< "DP 1"
    int number = 0;    ///< 1: its folder is dp1
    Conditions conditions;
};

struct DesignPoints {
    std::vector<DesignParameter> parameters;
    std::vector<DesignPoint> points;
    core::Problems notes;  ///< parameters that are no conditions

    [[nodiscard]] const DesignPoint* find(int number) const;
};

/// Reads the CSV that Workbench exports: lines of comment with the parameters' names and units ("# ,P1 - gap [mm],P2 -
/// speed [m s^-1]") above a header "Name,P1,P2", or these names in the header itself, or a line "Units,mm,..." below
/// it. A parameter is a condition when its name is that of a known quantity, or a usual word for it (ride height, angle
/// of attack, inlet velocity ...), and its unit fits. `mapping`: by id or name, "gap" or "gap [mm]" (a unit that the
/// table does not say), a word of its own for a condition that is no known quantity, or "" for none. Without a mapping
/// a parameter that nobody knows and that varies is an error, for cases that differ in it alone would look the same;
/// results that Workbench has (names that end in -op, names of loads) and constants are left out with a note. Throws
/// core::InputError with line: ragged, numbers that do not parse, a unit that is missing or does not fit, a point
/// twice.
DesignPoints read_design_points(const std::filesystem::path& file,
                                const std::map<std::string, std::string>& mapping = {});

/// The cases of a [[case]] that has `design_points = "table.csv"`: its pattern says with {design_point} where the
/// number of the point stands ("files/dp{design_point}/FFF/Fluent/*.dat.h5").
class DesignPointCases {
public:
    /// Reads the keys `design_points` and `parameters` of a [[case]]; without the first there is nothing to do. Throws
    /// as read_design_points, and when the pattern has no {design_point}.
    explicit DesignPointCases(const core::TomlTable& table);

    /// Gives the case the conditions and the name of its point ("dp1"). False: the table has no such point, which
    /// `finish` notes. Throws core::InputError: a second file of one point.
    bool take(Case& entry);
    /// What did not find its counterpart: points without a file, files without a point.
    void finish(core::Problems& notes) const;

private:
    std::optional<DesignPoints> points_;
    core::Place place_;
    std::map<int, std::filesystem::path> files_;
    std::vector<std::string> without_point_;
};

}  // namespace underbody::cases
