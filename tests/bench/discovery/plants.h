// Data sets with known truth for the bench of discovery. The plants, their integrator and the form of each law are this
// bench's own: nothing of the program's catalogue is used, only its types for measurements and tables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"

namespace underbody::bench {

/// What a rig does beside the effect: by default it feeds its controller a reading of its own.
struct Rig {
    bool feedback = false;  ///< the controller is fed the reading that is logged
    double ar = 0;          ///< correlation of the reading's noise from one to the next (first order)
    double gusts = 0;       ///< random force: its strength as `level`
    double drift = 0;       ///< of the gap sensor over a run, in noises
    double rounding = 0;    ///< step of the readings, in noises
    double outliers = 0;    ///< share of readings that are far off
    double dropouts = 0;    ///< share of readings that are missing
};

struct Case {
    std::string family;  ///< heave; static: glide, towed (with pitch and depth), jet, both (glide and jet at once)
    std::vector<std::string> names;  ///< true effects; empty: clean; "unknown": out of the catalogue
    std::string law;                 ///< which out-of-catalogue law
    double level = 1;                ///< strength in units of the noise (heave: error of a 2 s prediction; static: RMS)
    bool velocity = false;           ///< heave velocity measured as well
    bool coloured = false;           ///< sensor noise with a correlation time of 0.3 s beside the white
    double declared_noise = 1;       ///< declared noise over the true one; 0: not declared
    double rate = 50;                ///< Hz
    Rig rig;                         ///< heave
    bool strong = false;             ///< heave: a tether of 1.5 to 6 N/m, whatever `level` says
    std::uint64_t seed = 1;
    /// Sets of one seed with other numbers have other signs and shapes of their laws, controllers (heave) or order of
    /// set points (static) and noise; static sets with the same number have the same noise.
    std::uint64_t draw = 0;
    int runs = 8, held_out = 4;  ///< heave: that discover() fits, and those kept from every fit
    double seconds = 40;         ///< heave: of a run
    bool fresh = true;           ///< heave: with runs that discover() never sees
    [[nodiscard]] std::string text() const;
};

struct Sample {
    dynamics::Measurements train;
    dynamics::Measurements test;  ///< another controller and excitation (heave), other set points (static)
    dynamics::Measurements
        fresh;  ///< heave: the same rig once more, another controller again: discover() never sees it
    std::vector<std::string> names;
    std::vector<std::string> depends_on;         ///< of an unknown law
    std::vector<std::vector<std::string>> also;  ///< other verdicts that are right ({"none"}: nothing)
    double in_catalogue_terms = 0;  ///< what the catalogue's first parameter should come out as; NaN: another form
    std::function<double(double t, double h, double w, double u)>
        missing;  ///< heave, unknown laws: the force that the model lacks, N
};

/// Writes model.toml and its tables for a family into a folder; returns the model file.
std::filesystem::path write_declared_model(const std::string& family, const std::filesystem::path& folder);

Sample make_sample(const Case& wanted);
Sample make_heave(const Case& wanted);
Sample make_static(const Case& wanted);

/// The best that can be reached: the true law with its strength refitted to the training data; RMSE on the test data by
/// quantity.
std::map<std::string, double> static_oracle(const Case& wanted, const Sample& sample);
/// One standard deviation of a reading of the static plants.
double static_noise(const std::string& family, const std::string& quantity);

std::vector<std::string> effects_of(const std::string& family);
std::vector<std::string> unknown_laws(const std::string& family);

/// Case::law of a static set with a scale and an offset of usual sizes, whatever its level.
inline constexpr const char* scale_and_offset = "usual sizes";

// the declared physics, as this bench computes it
double jet_lift(double gap);
double glide_lift(double gap);
double glide_drag(double gap);

}  // namespace underbody::bench
