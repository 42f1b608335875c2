// Of what the rows of a search's results.csv are: conditions, shape and water that [design] may no longer ask for.
#pragma once

#include <string>
#include <vector>

#include "cases/design.h"
#include "cases/sweep_record.h"

namespace underbody::cases {

/// A number that a row says of its run whether it varies or not.
struct OriginNumber {
    std::string name, unit;
};
/// Those of them that are no variable of the search: columns of results.csv.
std::vector<OriginNumber> origin_columns(const DesignSpec& spec);

/// One of the loads of the search is about the point of `[frame] moments_about`.
bool has_moments(const DesignSpec& spec);
/// That point as rows of results.csv say it; empty where no load is about it.
std::string moments_about(const DesignSpec& spec, const DesignWater& water);

/// Of a case that is made of a shape of the search, but for the point of its moments.
RunOrigin origin_of(const DesignSpec& spec, const geometry::BodyShape& base, const CaseRecord& record);
/// Of what is varied, whatever the varied numbers are. Empty where there is no such shape.
std::string hash_of_base(const DesignSpec& spec, geometry::BodyShape shape);
/// Both say the same of what both say.
bool agree(const RunOrigin& a, const RunOrigin& b);

/// What a case is made of by what [design] asks for now, at `at` (one of DesignSpec::all_variables()). Throws
/// core::InputError where there is no such shape.
CaseRecord asked_for(const DesignSpec& spec, const geometry::BodyShape& base, const DesignWater& water,
                     const std::vector<double>& at, const std::string& fidelity);

/// What the table's columns say of its rows; empty cells say nothing.
void read_origins(const core::Table& table, const DesignSpec& spec, std::vector<DesignRun>& runs);
/// What rows do not say, by the runs in [design] folder (results of earlier versions say little); which rows are of
/// something else than is asked for now (DesignRun::other), and how many.
void settle_origins(const core::Table& table, const DesignSpec& spec, const geometry::BodyShape& base,
                    const DesignWater& water, std::vector<DesignRun>& runs, core::Problems& notes);

/// Rows that do not say of what they are, and no run in [design] folder does: they count all the same.
void note_silent_rows(const DesignSpec& spec, const std::string& file, const std::vector<DesignRun>& runs,
                      core::Problems& notes);
/// Rows beyond the conditions that [design] computes (gaps in metres for millimetres) are learned all the same, and
/// said.
void note_other_conditions(const DesignSpec& spec, const core::Table& table, core::Problems& notes);

}  // namespace underbody::cases
