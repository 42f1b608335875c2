// Every number that decides a verdict: its name, what it does, on which seeds of tests/bench/discovery it was set and
// when, and how much it matters. `bench_discovery --recalibrate` moves each and prints what changes.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace underbody::discovery {

/// The same for every data set of a kind.
struct Calibration {
    double gate = 0.01;        ///< the gate opens below this chance
    double even_none = 0.002;  ///< chance of as much structure from noise at which "none" has even odds
    double form_share = 0.01;  ///< share of what is explained that a law of another form may miss: widens probabilities
    double unknown_share = 0.15;   ///< share of the structure that the best name may leave before it is "unknown"
    double unknown_p = 0.002;      ///< and the chance below which what is left is real
    double pair_share = 0.05;      ///< least share of the explained part that a second effect must add
    double pair_gain = 25;         ///< and its least gain in -2 log likelihood
    double most_effects = 4;       ///< at once
    double fall_tail = 0.025;      ///< chance beyond each end of the interval of the held-out error's fall
    double most_over_twins = 1.3;  ///< held-out error over that of twins in which nothing is missing: above, no noise
    double most_over_declared =
        2.5;                         ///< declared noise figures that coloured noise may reach: what is more is no noise
    double most_left = 0.08;         ///< share of what the declared model misses beyond its twins that a name may leave
    double neutral_sigmas = 2;       ///< a number nearer to where its effect does nothing is no finding
    double rest_chance = 1e-3;       ///< chance, from noise, of a static rest above most_over_twins: less is no noise
    double by_run_runs = 3;          ///< fewer runs than that say nothing of what differs between them
    double by_run_sigmas = 4;        ///< its own errors that at least one run lies from the middle of all
    double by_run_gate_share = 0.1;  ///< asked for beside the gate: its chance must be below that share of it
    double by_run_surprise = 3;      ///< -log10 of the nominal chance below which it is not looked into
    double given_to_unknown = 0.8;   ///< stated for "something unknown" where a name or none leaves what a law explains
    double left_undecided =
        0.5;  ///< stated at most for a name, or for none, that the held-out readings do not bear out
    double pair_rest_share = 0.15;    ///< share of unknown_share that two laws together may leave: they bend to much
    double kin_share = 3;             ///< times pair_share that a second effect of the same kin must add
    double further_share = 0.5;       ///< share of pair_share that a third and a fourth effect must add
    double bound_prior = 1e-4;        ///< odds of an effect that is driven against the bound of what physics allows
    double smooth_gain = 10;          ///< in -2 log likelihood, by which a law without a name must do better than names
    double smooth_far_gain = 100;     ///< more than that on all runs: it need not do better on the runs left out
    double smooth_more = 1.35;        ///< times what a name explains that a law without one must explain
    double smooth_surprise = 2;       ///< -log10 of the nominal chance below which no smooth law is asked at the gate
    double rest_surprise = 3;         ///< likewise of what a name leaves: smooth laws, and further effects
    double column_price = 9;          ///< gain that each column of a smooth law must bring to be among those fitted
    double colour_gain = 25;          ///< in -2 log likelihood, of coloured noise beside white: with less there is none
    double colour_change = 1.6;       ///< factor of the coloured noise beyond which everything is judged again
    double shift_gain = 10;           ///< in -2 log likelihood: a shift below a sample that explains less is none
    double accident_sigmas = 6;       ///< a gap reading farther from what its neighbours say is an accident
    double accident_share = 0.01;     ///< of the readings: more are no accidents
    double correct_chance = 0.01;     ///< a quantity is corrected where its structure comes from noise less often
    double correction_reach = 0.998;  ///< quantile of a correction's force over the states seen that it may not exceed
};

/// One number of Calibration, for people and for the bench.
struct CalibratedNumber {
    std::string name;
    double Calibration::*value;
    std::string source;       ///< a reference, a definition, or the seeds it was set on
    std::string date;         ///< when it was set
    std::string sensitivity;  ///< what half and twice the value do
};
const std::vector<CalibratedNumber>& calibrated_numbers();

/// Values by kind of data, with numbers of `changed` by name in their place. Throws core::InputError for an unknown
/// name.
Calibration static_calibration(const std::map<std::string, double>& changed = {});
Calibration heave_calibration(const std::map<std::string, double>& changed = {});

}  // namespace underbody::discovery
