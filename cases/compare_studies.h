// Two campaigns side by side: what moved beyond its error, in loads, tables, equilibria and maps.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cases/moved.h"
#include "cases/study.h"

namespace underbody::cases {

/// One campaign: a study with what is known of it, or those of its cases that have some conditions.
struct Campaign {
    std::string name;  ///< what people call it: its title, its folder
    const Study* study = nullptr;
    const StudyResults* results = nullptr;
    Conditions where;  ///< only cases that have all of these; all when empty
};

/// One load of a case that both sides have.
struct MovedLoad {
    Moved load;
    std::string case_a, case_b;
    std::string conditions;            ///< that both have
    std::string settled_a, settled_b;  ///< "settled", "not settled", "unknown"
};

/// One force table that both have: where they lie furthest apart in units of their joint error.
struct MovedTable {
    Moved force;  ///< there
    std::string table;
    std::vector<std::pair<std::string, double>> at;  ///< there: axis -> SI value
    double beyond_share = 0;                         ///< of the places compared, share beyond twice the joint error
    double root_mean_square = 0;                     ///< of the difference over all of them
    std::size_t places = 0;
    std::size_t unsettled_a = 0, unsettled_b = 0;  ///< points whose solution has not settled
    std::string why_not;                           ///< empty: compared
};

/// An equilibrium of a table, or a class or attractor of a map.
struct MovedResult {
    Moved value;
    std::string result;  ///< "table/lift", "region/map"
};

struct StudyComparison {
    std::string a, b;
    /// In what the sides differ as a whole, so that it does not part their cases: ("mesh", "coarse", "fine").
    struct Apart {
        std::string condition, a, b;
    };
    std::vector<Apart> apart;
    std::size_t cases = 0;                         ///< on both sides
    std::vector<std::string> only_a, only_b;       ///< cases with loads that the other side has not
    std::size_t unsettled_a = 0, unsettled_b = 0;  ///< of the cases on both sides
    std::vector<MovedLoad> loads;                  ///< what moved most first
    std::vector<MovedTable> tables;                ///< of one name; likewise
    std::vector<MovedResult> equilibria;
    std::vector<MovedResult> maps;

    [[nodiscard]] std::size_t beyond() const;  ///< numbers beyond their error
};

/// Cases belong together whose conditions are alike, but for those in which the sides differ as a whole; a mesh (or
/// its cells) parts them only where one side has several. A load's error is the one that a force table takes for it,
/// else its scatter from iteration to iteration; where none is known, numbers that differ by more than 1e-9 of the
/// force are told with their share of it. Tables, equilibria and maps are those of one name. An equilibrium's error is
/// the table's; the share of a class in a map is known to a cell along its boundary. Throws core::InputError: the sides
/// have no case, table or map in common; two cases of one side that only their names tell apart.
StudyComparison compare_studies(const Campaign& a, const Campaign& b,
                                core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const StudyComparison& comparison);

}  // namespace underbody::cases
