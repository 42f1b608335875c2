// Static sets of others. Their channels are not the program's: what stands for what is said at each study.
#include <array>
#include <cmath>

#include "cases/measured/foreign_table.h"
#include "cases/measured/studies.h"
#include "core/file.h"
#include "core/text.h"
#include "core/water.h"

namespace underbody::cases {

namespace {

constexpr double newton_per_gram = 1e-3 * core::standard_gravity;

/// Factor c of measured = c shape by least squares: the one number of a simple declared model.
double factor_of(const std::vector<double>& shape, const std::vector<double>& measured) {
    double above = 0, below = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        above += shape[i] * measured[i];
        below += shape[i] * shape[i];
    }
    return above / below;
}

struct StaticSet {
    std::string title;
    std::string quantity, unit;
    std::string table;  ///< of the declared model, as CSV
    std::string scale;  ///< of its force source, as TOML
    std::vector<std::pair<std::string, std::vector<double>>> channels;
    std::vector<double> values;
    double noise = 0;  ///< 0: not known
};

const char* unit_of(const std::string& channel) {
    return channel == "speed"         ? "m/s"
           : channel == "time"        ? "s"
           : channel == "gap"         ? "m"
           : channel == "jet_voltage" ? "V"
           : channel == "jet_flow"    ? "m^3/s"
                                      : "1";
}

MeasuredStudy close_the_loop(MeasuredStudy study, const StaticSet& set, const std::filesystem::path& source,
                             core::Progress& progress) {
    study.scratch = std::make_shared<core::TemporaryFolder>("measured");
    const std::filesystem::path here = study.scratch->path();
    core::write_file(here / "table.csv", set.table);
    core::write_file(here / "model.toml", "[vehicle]\nmass = 1\n[[force]]\nquantity = \"" + set.quantity +
                                              "\"\ntable = \"table.csv\"\n" + set.scale);
    study.model = dynamics::read_model(here / "model.toml");
    study.model.name = study.name + ", declared: " + study.declared;
    study.measured.kind = dynamics::MeasurementKind::steady;
    study.measured.title = set.title;
    dynamics::MeasuredRun run;
    run.name = source.stem().string();
    run.table.source = source.string();
    for (const auto& [name, values] : set.channels) {
        run.table.add_numbers(name, unit_of(name), values);
    }
    run.table.add_numbers(set.quantity, set.unit, set.values);
    study.measured.runs.push_back(std::move(run));
    if (set.noise > 0) {
        study.measured.noise[set.quantity] = set.noise;
    }
    study.found = discovery::discover(study.model, study.measured, {}, progress);
    return study;
}

std::string text(double value) { return core::format_number(value, 9); }

std::vector<double> powers(const std::vector<double>& values, double power) {
    std::vector<double> result;
    for (const double value : values) {
        result.push_back(std::pow(value, power));
    }
    return result;
}

/// Torque of a turning shaft over its speed, with a declared power law by least squares.
StaticSet turning_set(const std::filesystem::path& source, const std::string& title, const std::string& rpm,
                      const std::string& torque, int exponent) {
    constexpr double rad_per_second = 0.10471975511965977;  // of a turn per minute
    const ForeignTable tare = read_foreign(source);
    StaticSet set;
    set.title = title + " (speed: of a point one metre from the shaft)";
    set.quantity = "yaw_moment";
    set.unit = "N m";
    std::vector<double> speed = tare.numbers(rpm);
    for (double& value : speed) {
        value *= rad_per_second;
    }
    set.values = tare.numbers(torque);
    const std::string factor = text(factor_of(exponent == 1 ? speed : powers(speed, exponent), set.values));
    set.table = "gap [m], yaw_moment [N m]\n0, " + factor + "\n1, " + factor + "\n";
    set.scale = "scale.speed = { reference = 1, exponent = " + std::to_string(exponent) + " }\n";
    set.channels = {{"gap", std::vector<double>(speed.size(), 0.5)}, {"speed", speed}};
    return set;
}

}  // namespace

MeasuredStudy bearing_study(const std::filesystem::path& folder, core::Progress& progress) {
    const std::filesystem::path source = folder / "rm2_tow_tank" / "Tare-torque.csv";
    MeasuredStudy study;
    study.name = "bearing";
    study.data = "Tare-torque.csv, UNH-CORE RM2 tow tank, CC BY 4.0, doi:10.6084/m9.figshare.1373899";
    study.declared = "torque proportional to the shaft's speed, slope by least squares";
    study.known = "Coulomb friction, with a slope that falls: 0.413 N m of error becomes 0.032 and 0.0117";
    return close_the_loop(std::move(study),
                          turning_set(source, "bearing of a tow-tank turbine", "rpm", "tare_torque", 1), source,
                          progress);
}

MeasuredStudy strut_study(const std::filesystem::path& folder, core::Progress& progress) {
    const std::filesystem::path source = folder / "rm2_tow_tank" / "Strut-torque.csv";
    MeasuredStudy study;
    study.name = "struts";
    study.data = "Strut-torque.csv, UNH-CORE RM2 tow tank, CC BY 4.0, doi:10.6084/m9.figshare.1373899";
    study.declared = "torque as the square of the shaft's speed, factor by least squares";
    study.known = "a part linear in the speed is missing: the power is below two";
    return close_the_loop(
        std::move(study),
        turning_set(source, "struts of a tow-tank turbine turning without blades", "mean_rpm", "mean_torque", 2),
        source, progress);
}

std::vector<MeasuredStudy> bank_studies(const std::filesystem::path& folder, core::Progress& progress) {
    const std::filesystem::path source = folder / "mashcon2009_bank" / "subset1_sinkage.csv";
    const ForeignTable bank = read_foreign(source);
    const std::vector<double> speed = bank.numbers("U_mps"), fore = bank.numbers("sinkage_fore_mm"),
                              aft = bank.numbers("sinkage_aft_mm");
    std::vector<double> away = bank.numbers("y_m");
    for (double& y : away) {
        y = 1 - y;  // gap: the way to a line one metre off the middle, on the bank's side
    }
    std::vector<MeasuredStudy> studies;
    for (const bool trim : {false, true}) {
        StaticSet set;
        set.title = trim ? "trim of a ship model along a bank (N m: mm of sinkage aft less fore)"
                         : "mean sinkage of a ship model along a bank (N: mm)";
        set.quantity = trim ? "pitch_moment" : "lift_force";
        set.unit = trim ? "N m" : "N";
        for (std::size_t i = 0; i < speed.size(); ++i) {
            set.values.push_back(trim ? aft[i] - fore[i] : -0.5 * (fore[i] + aft[i]));
        }
        const std::string factor = text(factor_of(powers(speed, 2), set.values));
        set.table = "gap [m], " + set.quantity + " [" + set.unit + "]\n0.3, " + factor + "\n2.5, " + factor + "\n";
        set.scale = "scale.speed = { reference = 1, exponent = 2 }\n";
        set.channels = {{"gap", away}, {"speed", speed}};
        set.noise = trim ? 0.14 : 0.1;  // readings off a plot in steps of 0.05 mm, two of them
        MeasuredStudy study;
        study.name = trim ? "ship along a bank: trim" : "ship along a bank: sinkage";
        study.data = "subset1_sinkage.csv, Lataire, Vantorre and Eloot, Antwerp 2009, open data";
        study.declared = trim ? "trim as the square of the speed" : "sinkage as the square of the speed";
        study.known =
            trim ? "no simple law explains the trim at the highest speed"
                 : "growth near the critical speed and nearness of the bank, both: leave-one-out error 1.19 to 0.34 mm";
        studies.push_back(close_the_loop(std::move(study), set, source, progress));
    }
    return studies;
}

namespace {

/// Parabola c0 + c1 d + c2 d^2 by least squares through moments of d.
std::array<double, 3> parabola(const std::vector<double>& duty, const std::vector<double>& values) {
    double m[5] = {}, r[3] = {};
    for (std::size_t i = 0; i < duty.size(); ++i) {
        for (int k = 0; k < 5; ++k) {
            m[k] += std::pow(duty[i], k);
        }
        for (int k = 0; k < 3; ++k) {
            r[k] += std::pow(duty[i], k) * values[i];
        }
    }
    const auto determinant = [](const double(&a)[3][3]) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    const double whole[3][3] = {{m[0], m[1], m[2]}, {m[1], m[2], m[3]}, {m[2], m[3], m[4]}};
    std::array<double, 3> c{};
    for (int k = 0; k < 3; ++k) {
        double with[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                with[i][j] = j == k ? r[i] : whole[i][j];
            }
        }
        c[k] = determinant(with) / determinant(whole);  // Cramer
    }
    return c;
}

}  // namespace

MeasuredStudy thrust_stand_study(const std::filesystem::path& folder, core::Progress& progress) {
    const std::filesystem::path source = folder / "cf21_thrust_stand" / "cf2.1-stock-prop.csv";
    const ForeignTable stand = read_foreign(source);
    const std::vector<double> weight = stand.numbers("weight[g]"), command = stand.numbers("pwm"),
                              battery = stand.numbers("vbat[V]");
    StaticSet set;
    set.title = "thrust stand (jet_flow: motor command, 0 to 1; jet_voltage: the battery's)";
    set.quantity = "lift_force";
    set.unit = "N";
    std::vector<double> duty, volt;
    for (std::size_t i = 0; i + 1 < weight.size(); ++i) {
        if (command[i + 1] == command[i]) {
            continue;  // the last reading of each step: the others are on their way there
        }
        duty.push_back(command[i] / 65535);
        volt.push_back(battery[i]);
        set.values.push_back(newton_per_gram * weight[i]);
    }
    const std::array<double, 3> c = parabola(duty, set.values);
    set.table = "jet_flow [m^3/s], lift_force [N]\n";
    for (int k = 0; k <= 50; ++k) {
        const double d = 0.02 * k;
        set.table += text(d) + ", " + text(c[0] + c[1] * d + c[2] * d * d) + "\n";
    }
    set.scale = "scale.jet_voltage = { reference = \"3.7 V\", exponent = 0 }\n";
    set.channels = {{"jet_flow", duty}, {"jet_voltage", volt}};
    MeasuredStudy study;
    study.name = "thrust stand";
    study.data = "cf2.1-stock-prop.csv, IMRCLab crazyflie-system-id, MIT";
    study.declared = "thrust as a parabola of the command, whatever the battery's voltage";
    study.known = "thrust follows the battery's voltage (14.8 to 11.3 mN), and lags";
    return close_the_loop(std::move(study), set, source, progress);
}

MeasuredStudy ceiling_study(const std::filesystem::path& folder, core::Progress& progress) {
    struct Flight {
        const char* file;
        double asked;
    };
    // heights asked for: mocap_data_description.md of the data's owner
    static constexpr Flight flights[] = {{"20240822_21_32_29.csv", 0.057}, {"20240822_21_35_34.csv", 0.057},
                                         {"20240822_21_43_50.csv", 0.057}, {"20240822_22_02_30.csv", 0.042},
                                         {"20240822_22_14_56.csv", 0.042}, {"20240822_22_17_21.csv", 0.042}};
    StaticSet set;
    set.title = "hover under a plate (gap: height asked for; lift_force: height held, 1 N for 1 mm)";
    set.quantity = "lift_force";
    set.unit = "N";
    std::vector<double> gap;
    for (const Flight& flight : flights) {
        const ForeignTable log = read_foreign(folder / "air_garage_ceiling" / flight.file);
        const std::vector<double> time = log.numbers("t"), height = log.numbers("z");
        // the logs begin on the ground; the climb and its overshoot end nineteen seconds later; then means of a second
        // each
        double sum = 0, count = 0, end = time.front() + 20;
        for (std::size_t i = 0; i < time.size(); ++i) {
            if (time[i] < time.front() + 19) {
                continue;
            }
            if (time[i] > end) {
                gap.push_back(flight.asked);
                set.values.push_back(1000 * sum / count);
                sum = count = 0;
                end += 1;
            }
            sum += height[i];
            count += 1;
        }
    }
    set.table = "gap [m], lift_force [N]\n0.01, 10\n0.05, 50\n0.1, 100\n0.2, 200\n";
    set.channels = {{"gap", gap}};
    MeasuredStudy study;
    study.name = "hover under a plate";
    study.data = "six flights of 2024-08-22, XinLong-Li air_garage_cflib, MIT";
    study.declared = "the height held is the height asked for";
    study.known = "suction of the plate, or optics that read 2 mm off under it (the owner's log): a tie";
    return close_the_loop(std::move(study), set, folder / "air_garage_ceiling", progress);
}

}  // namespace underbody::cases
