#include "surrogates/discovery/calibration.h"

#include <algorithm>
#include <cstddef>

#include "core/error.h"

namespace underbody::discovery {

const std::vector<CalibratedNumber>& calibrated_numbers() {
    using C = Calibration;
    const char* const unmeasured = "not measured since the guards judge the verdict";
    const char* const heave_bench = "the heave bench; its seeds were not written down";
    static const std::vector<CalibratedNumber> list{
        {"gate", &C::gate, "heave seeds 4000 to 4501, static seeds 1 to 99", "2026-11-21", unmeasured},
        {"even_none", &C::even_none,
         "static: weak sets of seeds 15500 to 15505, as many clean ones assumed; runs: weak and clean sets in heave of "
         "seeds 18100 to 18115, as many of each",
         "2026-11-28",
         "static: of 522 weak sets 6, 4, 1, 3 and 3 had a chance up to 0.005, 0.01, 0.02, 0.05 and 1, of as many clean "
         "ones 1.6, 2.6, 5, 16 and 496 have; so none is right 0.21, 0.39, 0.8, 0.84 and 0.99 (stated 0.18, 0.38, 0.67, "
         "0.86 and 0.99; with 0.002 it was 0.71, 0.87, 0.93, 0.97 and 1.00); heave: of weak sets 94.4, 3.6, 0.3 and "
         "1.7 % had "
         "a chance up to 0.002, 0.1, 0.2 and 1, of clean ones 0, 1.1, 4.4 and 94.4 %: none is right 0, 0.24, 0.93 and "
         "0.98 (stated with 0.002 0.5 to 0.99 from 0.002 to 0.1, with 0.03 0.03 to 0.85)"},
        {"form_share", &C::form_share, "heave 4000 to 4501, static 1 to 99: stated against frequencies", "2026-11-22",
         unmeasured},
        {"unknown_share", &C::unknown_share, "heave 5000 and 5001 (laws outside), static 1 to 99", "2026-11-22",
         unmeasured},
        {"unknown_p", &C::unknown_p, "heave 4000 to 4501, static 1 to 99", "2026-11-21", unmeasured},
        {"pair_share", &C::pair_share, "pairs: heave 40 to 43, static 40 to 43", "2026-11-21", unmeasured},
        {"pair_gain", &C::pair_gain, "pairs: heave 40 to 43, static 40 to 43", "2026-11-21", unmeasured},
        {"most_effects", &C::most_effects, "definition", "2026-11-22", unmeasured},
        {"fall_tail", &C::fall_tail, "definition: a two-sided interval of 95 %", "2026-11-22", unmeasured},
        {"most_over_twins", &C::most_over_twins, "definition: a third more than noise", "2026-11-22", unmeasured},
        {"most_over_declared", &C::most_over_declared,
         "chosen: a figure wrong by two is held to be noise (rigs), one wrong by more is not; not set on simulations",
         "2026-11-27", unmeasured},
        {"most_left", &C::most_left, "rigs of seed 15001; thruster by gap and backlash", "2026-11-22", unmeasured},
        {"neutral_sigmas", &C::neutral_sigmas, "definition: two standard deviations", "2026-11-22", unmeasured},
        {"rest_chance", &C::rest_chance, "definition: one in a thousand", "2026-11-22", unmeasured},
        {"by_run_runs", &C::by_run_runs, "definition: two runs that differ do not say which is odd", "2026-11-22",
         unmeasured},
        {"by_run_sigmas", &C::by_run_sigmas, "chosen: one in 16,000 of a normal number, not set on simulations",
         "2026-11-22", unmeasured},
        {"by_run_gate_share", &C::by_run_gate_share,
         "chosen: all effects are asked once more, by run; not set on simulations", "2026-11-22", unmeasured},
        {"by_run_surprise", &C::by_run_surprise, "saves time: no chance above it passes the gate", "2026-11-22",
         unmeasured},
        {"given_to_unknown", &C::given_to_unknown, "chosen: four to one, not set on simulations", "2026-11-22",
         unmeasured},
        {"left_undecided", &C::left_undecided, "definition: even odds", "2026-11-22", unmeasured},
        {"pair_rest_share", &C::pair_rest_share,
         "static: four rigs of the bench; runs: the heave bench; seeds were not written down", "2026-11-22",
         unmeasured},
        {"kin_share", &C::kin_share, heave_bench, "2026-11-21", unmeasured},
        {"further_share", &C::further_share, heave_bench, "2026-11-22", unmeasured},
        {"bound_prior", &C::bound_prior, "chosen, not set on simulations", "2026-11-22", unmeasured},
        {"smooth_gain", &C::smooth_gain, heave_bench, "2026-11-22", unmeasured},
        {"smooth_far_gain", &C::smooth_far_gain, heave_bench, "2026-11-22", unmeasured},
        {"smooth_more", &C::smooth_more, heave_bench, "2026-11-22", unmeasured},
        {"smooth_surprise", &C::smooth_surprise, "saves time: no chance above it passes the gate", "2026-11-22",
         unmeasured},
        {"rest_surprise", &C::rest_surprise, "saves time: one in a thousand among some thirty that are asked",
         "2026-11-22", unmeasured},
        {"column_price", &C::column_price, "definition: three standard deviations", "2026-11-22", unmeasured},
        {"colour_gain", &C::colour_gain, heave_bench, "2026-11-21", unmeasured},
        {"colour_change", &C::colour_change, heave_bench, "2026-11-21", unmeasured},
        {"shift_gain", &C::shift_gain, "chosen, not set on simulations", "2026-11-22", unmeasured},
        {"accident_sigmas", &C::accident_sigmas, "definition: one in 500 million of a normal number", "2026-11-22",
         unmeasured},
        {"accident_share", &C::accident_share, "definition: one in a hundred", "2026-11-22", unmeasured},
        {"correct_chance", &C::correct_chance, "definition: one in a hundred", "2026-11-23", unmeasured},
        {"correction_reach", &C::correction_reach, "definition: all but two states in a thousand", "2026-11-22",
         unmeasured}};
    return list;
}

namespace {

Calibration changed_by(Calibration c, const std::map<std::string, double>& changed) {
    std::vector<std::string> known;
    for (const CalibratedNumber& number : calibrated_numbers()) {
        known.push_back(number.name);
    }
    for (const auto& [name, value] : changed) {
        const auto place = std::find(known.begin(), known.end(), name);
        if (place == known.end()) {
            throw core::InputError("name", "no number of discovery is called '" + name + "'", {},
                                   core::did_you_mean(name, known));
        }
        c.*calibrated_numbers()[static_cast<std::size_t>(place - known.begin())].value = value;
    }
    return c;
}

}  // namespace

Calibration static_calibration(const std::map<std::string, double>& changed) {
    Calibration c;
    c.gate = 0.002;
    c.even_none = 0.01;
    c.form_share = 0.003;
    c.unknown_share = 0.12;
    c.unknown_p = 0.002;
    c.pair_share = 0.05;
    c.pair_gain = 20;
    return changed_by(c, changed);
}

Calibration heave_calibration(const std::map<std::string, double>& changed) {
    Calibration c;
    c.gate = 0.002;
    c.even_none = 0.03;
    c.form_share = 0.01;
    c.unknown_share = 0.3;
    c.unknown_p = 1e-4;
    c.pair_share = 0.1;
    c.pair_gain = 40;
    c.pair_rest_share = 0.5;
    return changed_by(c, changed);
}

}  // namespace underbody::discovery
