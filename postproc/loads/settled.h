// Has a solution settled? From the histories that a solver leaves beside its fields.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "postproc/loads/loads.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::postproc {

enum class SettledVerdict {
    settled,
    not_settled,  ///< a load drifts or scatters, residuals are high, or values are not finite
    unknown,      ///< nothing beside the file says it, or too little
};
/// "settled", "not settled", "unknown"
std::string to_string(SettledVerdict verdict);

/// What a drift or scatter may come to. Of a steady solution the scatter of a load over its last iterations counts
/// against the size of the force (moments: times the root of the body's area): above a twentieth the field at hand, one
/// instant of it, says too little of the mean. Above a thousandth a residual that is all there is to go by is no proof
/// (the usual criterion of Fluent); above a tenth it is proof of the opposite. Chosen, not fitted; set in 2026-11.
inline constexpr double settled_scatter = 0.05;
/// Stricter: a run that the program watches is ended before its last iteration only where lift, drag and pitch moment
/// (over a tenth of the body's length) stay within this share of the resultant over their last iterations. Whether
/// what it leaves is settled is then asked by settled_scatter as of any other case.
inline constexpr double still_range = 0.003;
inline constexpr double settled_residual = 1e-3;
inline constexpr double unsettled_residual = 0.1;

/// The end of one load's history.
struct LoadHistory {
    std::string quantity;  ///< lift_force, ...
    std::string file;
    IterationScatter scatter;  ///< in the history's own units
    double sigma = 0;     ///< N or N m, of the whole body: one standard uncertainty of the field's value by iteration
    std::string fault{};  ///< why it has not settled; empty when it has
};

struct ResidualLevel {
    std::string equation;
    double last = 0;
    double decades = 0;  ///< below its largest
    std::string file;
};

struct Settled {
    SettledVerdict verdict = SettledVerdict::unknown;
    std::string why;                 ///< one line
    bool transient = false;          ///< a run in time: a scatter is its flow, and one instant is not its mean
    std::vector<LoadHistory> loads;  ///< of the whole body
    std::vector<ResidualLevel> residuals;
};

/// The verdict on the field that `result` was integrated from. `stated`: what is known already of the loads by name
/// (the solver's own forces, monitors that the user names). Beside `file` are read: logs of an OpenFOAM case; texts
/// named after the file (STEM.trn, STEM-lift.out ...), and where the folder holds no other case every .out, .trn and
/// .log: residuals of transcripts and of CFX's output, and monitors whose column or file says what it is (lift, drag,
/// cl ...): their unit is not known, so that they count by their share of the mean, and where they swing about zero by
/// what their value at the field's time, or another monitor of the kind, says of their unit; what nothing says a unit
/// of is no proof either way. Histories count up to the time of
/// the field. A file that cannot be read as it should is passed over; `notes` says so.
Settled settled_by(const LoadsResult& result, const std::vector<StatedLoad>& stated, const std::filesystem::path& file,
                   core::Problems& notes);

/// Why a history has not settled, in words: "drifts by ...", "scatters by ..."; empty when it has. `force`: what its
/// drift and scatter count against, in the history's unit.
std::string fault_of(const IterationScatter& history, double force, bool transient);

void to_json(nlohmann::json& json, const Settled& settled);

}  // namespace underbody::postproc
