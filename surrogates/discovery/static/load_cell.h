// From the log of a load cell to forces at set points: pedestals, drift, friction.
#pragma once

#include <string>

#include "core/error.h"
#include "core/table.h"

namespace underbody::discovery {

struct LoadCellOptions {
    double settle = 0;  ///< s left out at the beginning of each block
    bool without_thrust =
        false;  ///< subtract the force at the largest gap of each voltage: what is left is ground effect
};

struct LoadCellReduction {
    /// One row a pump-on block: time (its middle), gap, jet_voltage, approach_direction when logged, the reading and
    /// its sigma. SI.
    core::Table table;
    double drift_rate = 0;  ///< SI per second: slope of the pedestals over time, all heights together, each with its
                            ///< own level; NaN: no height has its zero twice
    double hysteresis = 0;  ///< half the mean difference between the two directions of approach; 0: one direction alone
    double friction = 0;    ///< one standard deviation between blocks at one set point beyond what their noise explains
    double noise = 0;       ///< of a single reading within a block
    core::Problems problems;
};

/// `log`: time, gap, jet_voltage (zero or missing: pump off) and one force or moment, in the order of measurement;
/// approach_direction when the slide was moved from both sides. A block is a stretch of rows at one set point. Pump-off
/// blocks of the same gap before and after a pump-on block give its zero, linear in time between them; where one side
/// lacks, the other is held. Zeros taken from the other side of the slide serve only where its own side has none.
///   F = mean(on) - P0(t),  sigma^2 = friction^2 + s_on^2/n_on + s_off^2/n_off
/// with numbers of readings corrected for their lag-one autocorrelation, n (1 - r)/(1 + r).
/// Throws core::InputError: no time, gap, jet_voltage or force; several forces; time runs backwards; no pump-off block
/// at all.
LoadCellReduction reduce_load_cell(const core::Table& log, const LoadCellOptions& options = {});

/// What a reduction found, in a sentence with units: blocks, drift, hysteresis, friction, noise.
std::string reduction_text(const LoadCellReduction& reduction);

/// True for a raw log: one force, several rows at each set point in a row (five in the middle), some of them with the
/// pump off.
bool is_load_cell_log(const core::Table& table);

}  // namespace underbody::discovery
