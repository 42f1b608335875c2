// Measured heave runs made ready for filtering: steps of bounded rate, known inputs, noise of each reading.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::discovery {

/// One run. Readings within a step (HeaveRecords::step) are averaged (anti-aliasing), so that 50 and 500 Hz tell the
/// same story.
struct HeaveRecord {
    std::string name;
    std::size_t run = 0;                                ///< index into the data set's runs
    std::shared_ptr<const dynamics::HeavePlant> plant;  ///< of the model as declared, under this run's conditions
    std::vector<double> time;                           ///< s, mean time of each step's readings, ascending
    std::vector<double> gap;                            ///< m, mean reading; NaN: none in this step
    std::vector<double> gap_share;                      ///< 1/sqrt(readings) of the step
    std::vector<double> velocity;                       ///< m/s; empty: not measured; NaN: none in this step
    std::vector<double> velocity_share;
    std::vector<double> raw_time;      ///< of the recorded input
    std::vector<double> raw_input;     ///< N; zero when none was recorded
    std::vector<double> held_input;    ///< N, mean of the recorded input over each step, held between its samples
    std::vector<double> linear_input;  ///< the same, linear between its samples
    double lift_factor = 1;            ///< multiplies the folded lift curve
    std::vector<double>
        lift_scale;  ///< likewise over each step, where a condition changed within the run; empty: it did not
};

/// Steps of the filter, s. Runs of less than a hundred of them get shorter ones: HeaveRecords::step.
inline constexpr double record_step = 0.04;

/// What was found while preparing.
struct HeaveRecords {
    std::vector<HeaveRecord> records;
    bool velocity_measured = false;
    bool velocity_turned = false;  ///< its sign was found turned round and is mended here
    bool input_recorded = false;
    double step = record_step;  ///< s: readings within it are averaged
    double raw_step = 0;        ///< median step of the files, s
    double gap_noise = 0;       ///< estimated white noise of a single reading, m
    double velocity_noise = 0;  ///< m/s; 0: not measured
    core::Problems problems;
};

/// Outliers (beyond 8 robust deviations from a running median) are dropped with a remark; stuck sensors, runs without
/// motion, runs outside the tables, swapped or mis-scaled channels are reported. Of a run that leaves the tables for a
/// while the longest stretch inside is used. Runs that cannot be used are left out with a remark. Throws
/// core::InputError when no run is left.
HeaveRecords prepare_heave_records(const dynamics::Model& model, const dynamics::Measurements& data);

}  // namespace underbody::discovery
