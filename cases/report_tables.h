// Tables of the report that are made of several results.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

struct ReportTable {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string caption;
};

/// For each case, by name, the error that the force tables of the study take for the quantity, SI: the largest of them.
std::map<std::string, double> load_errors(const Study& study, const StudyResults& results, const std::string& quantity);

/// One row a case: its conditions (words first), lift, drag and pitch moment with the errors that force tables take for
/// them, closure. By words, then by numbers.
ReportTable loads_of_all_cases(const Study& study, const StudyResults& results);

/// Thin-film theory at the gaps where the table's lift holds the weight: squeeze damping and added mass of the film
/// under an elliptic base, beside the stiffness out of CFD. Only gaps where the film is thin; empty when the study has
/// no elliptic body for the table.
ReportTable films_at_equilibria(const Study& study, const StudyResults& results, const TableSpec& table);

}  // namespace underbody::cases
