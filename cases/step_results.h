// What the steps of a study hand to the report, to comparisons and to those who show them: values with types. As JSON
// they stand in the store and at the edge only; a key that is missing there is an error, not a dash in a report.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/table.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::cases {

/// Where lift balances the net weight. SI; NaN where the step does not know it.
struct EquilibriumResult {
    double gap = 0;
    bool stable = false;
    double stiffness = 0;
    double sigma = std::numeric_limits<double>::quiet_NaN();            ///< of the gap; 0: the table has no error
    double stiffness_sigma = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not known
    double frequency = std::numeric_limits<double>::quiet_NaN();        ///< Hz
    double frequency_sigma = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not known
    double kick_velocity = std::numeric_limits<double>::quiet_NaN();    ///< m/s
    double probability = std::numeric_limits<double>::quiet_NaN();      ///< that there is one; NaN: not known
    /// Not so sure that it could pass in silence.
    [[nodiscard]] bool doubtful() const { return probability < tables::sure_enough; }
};

/// A [[table]].
struct TableResult {
    std::string name;
    std::string quantity;
    std::string fit;     ///< in words: "monotone cubic, one axis"
    core::Table points;  ///< table_points
    std::vector<EquilibriumResult> equilibria;
    std::vector<std::string> remarks;
    struct File {
        std::string format;
        std::string file;  ///< beside the report
    };
    std::vector<File> exports;
};

/// A [[mesh_uncertainty]].
struct MeshResult {
    std::string name;
    std::vector<double> cells;  ///< coarse to fine
    struct Quantity {
        std::string name;
        std::vector<double> values;  ///< likewise, SI
        std::string verdict;         ///< postproc::MeshVerdict in words
        double standard_uncertainty = 0;
    };
    std::vector<Quantity> quantities;

    /// nullptr: the mesh study does not cover it.
    [[nodiscard]] const Quantity* find(const std::string& quantity) const;
};

/// A [[region]].
struct RegionResult {
    std::string name;
    std::size_t columns = 0, rows = 0;
    struct End {
        std::string name;
        std::string kind;  ///< "attractor", "contact", ...
        double fraction = 0;
        double gap = std::numeric_limits<double>::quiet_NaN();  ///< of an attractor
    };
    std::vector<End> ends;
    std::vector<EquilibriumResult> equilibria;
    std::vector<std::string> remarks;
};

/// A [[verify]].
struct VerifyResult {
    std::string name;
    std::size_t values = 0;
    double worst = 0;  ///< share of the force's size, beyond the run's own swing
    std::string worst_case;
    std::size_t failed = 0;
    double tolerance = 0;
};

/// Of an equilibrium's document, whose `frequency_unit` says in what it is given (without one: Hz); `key`: frequency or
/// frequency_sigma. NaN: not known.
double frequency_in_hertz(const nlohmann::json& equilibrium, const std::string& key = "frequency");

// Out of the documents of the steps. A missing key throws nlohmann::json::out_of_range, a wrong type type_error:
// defects.
TableResult table_result(const std::string& name, const nlohmann::json& document);
MeshResult mesh_result(const std::string& name, const nlohmann::json& document);
RegionResult region_result(const std::string& name, const nlohmann::json& document);
VerifyResult verify_result(const std::string& name, const nlohmann::json& document);

/// The one of that name; nullptr: its step gave none.
template <class Result>
const Result* find_result(const std::vector<Result>& all, const std::string& name) {
    for (const auto& one : all) {
        if (one.name == name) {
            return &one;
        }
    }
    return nullptr;
}

}  // namespace underbody::cases
