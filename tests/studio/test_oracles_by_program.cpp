// Every oracle of docs/physics.md (docs/physics-oracles.csv) asked of the program itself, as a user would: a formula
// that no command reaches is of no use to anybody. An oracle of the file that is not asked fails.
#include <gmock/gmock.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cases/thesis/published.h"
#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "surrogates/estimator/observe/observer.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using Numbers = std::vector<double>;

/// Semicolon-separated fields of one line of quoted CSV.
std::vector<std::string> quoted_fields(const std::string& line) {
    std::vector<std::string> fields;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t open = line.find('"', at), close = line.find('"', open + 1);
        if (open == std::string::npos || close == std::string::npos) {
            break;
        }
        fields.push_back(line.substr(open + 1, close - open - 1));
        at = close + 1;
    }
    return fields;
}

struct Oracle {
    std::string inputs;
    Numbers expected;
    double tolerance = 1e-9;
    bool absolute = false;
};

std::map<std::string, Oracle> oracles() {
    std::map<std::string, Oracle> all;
    const std::string text = core::read_file(source_folder() / "docs" / "physics-oracles.csv");
    for (const auto line : core::split(text, '\n')) {
        const auto fields = quoted_fields(std::string(line));
        if (fields.size() < 5 || !fields[0].starts_with("O")) {
            continue;
        }
        Oracle oracle;
        oracle.inputs = fields[2];
        for (const auto part : core::split(fields[3], ';')) {
            oracle.expected.push_back(core::parse_number(part).value_or(std::nan("")));
        }
        oracle.absolute = fields[4].starts_with("abs");
        oracle.tolerance = core::parse_number(oracle.absolute ? fields[4].substr(4) : fields[4]).value_or(1e-9);
        all[fields[0]] = oracle;
    }
    return all;
}

class ByProgram : public testing::Test {
protected:
    core::TemporaryFolder folder_;

    json ask(std::vector<std::string> words) {
        words.emplace_back("--json");
        const auto run = run_underbody(words, folder_.path());
        EXPECT_EQ(run.exit_code, 0) << words[0] << " " << words[1] << ": " << run.errors;
        return run.exit_code == 0 ? json::parse(run.output) : json();
    }

    /// The values of a theory, by name.
    Numbers theory(const std::string& name, const std::string& inputs, const std::vector<std::string>& wanted) {
        const json found = ask({"theory", name, inputs});
        Numbers values;
        for (const auto& output : wanted) {
            values.push_back(found.empty() ? std::nan("") : found.at("values").at(output).get<double>());
        }
        return values;
    }

    /// One value at a time out of several runs.
    Numbers each(const std::string& name, const std::vector<std::string>& inputs, const std::string& wanted) {
        Numbers values;
        for (const auto& one : inputs) {
            values.push_back(theory(name, one, {wanted}).front());
        }
        return values;
    }

    void write_reference_curve() {
        core::write_file(folder_.path() / "ref-a.csv",
                         "gap [m], lift_force "
                         "[mN]\n-0.05,40\n-0.04,28.4\n-0.03,18.8\n-0.02,11\n-0.01,4.9\n0,0\n0.01,-4.1\n0.02,-7.4\n0.03,"
                         "-10\n0.04,-12\n0.05,-13.4\n"
                         "0.06,-14.2\n0.07,-14.45\n0.08,-14.2\n0.09,-13.4\n0.10,-12.2\n0.12,-8.7\n0.14,-4.4\n0.16,0\n0."
                         "18,3.9\n0.20,7.3\n0.25,13.4\n0.30,17\n0.35,18.9\n"
                         "0.40,19.75\n0.45,20\n0.50,19.8\n0.60,18.4\n0.70,16\n0.80,13.1\n0.90,10.2\n1.0,7.6\n1.1,5."
                         "5\n1.2,3.9\n1.3,2.7\n1.4,1.9\n1.6,.9\n1.8,.4\n");
        std::string sine = "gap [m], lift_force [N]\n";
        for (int i = -8; i <= 488; ++i) {  // beyond 0 to 1.2 m: at its own ends a held curve is flat
            const double h = i / 400.0;
            sine += core::format_number(h, 17) + "," + core::format_number(0.02 * std::sin(6.283185307179586 * h), 17) +
                    "\n";
        }
        core::write_file(folder_.path() / "sine.csv", sine);
        const auto model = [&](const std::string& name, const std::string& table, const std::string& drag) {
            core::write_file(
                folder_.path() / (name + ".toml"),
                "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = " + core::format_number(1 / 0.2529 - 2.2, 17) +
                    "\nnet_weight = 0\n[contact]\ngap = \"-40 mm\"\n[drag.heave]\n" + drag +
                    "[[force]]\nquantity = \"lift_force\"\ntable = \"" + table + "\"\nfit = \"spline\"\n");
        };
        model("ref-a", "ref-a.csv", "quadratic = 50.2\n");
        model("sine", "sine.csv", "quadratic = 50.2\n");
        model("fitted-drag", "ref-a.csv", "quadratic = 50.209\n");
        model("linear-drag", "ref-a.csv", "linear = 1.25\nquadratic = 0\n");
    }

    json learned(const std::string& model, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"learn",         model + ".toml", "--mesh",
                                          "5x41x61",       "--region",      "gap=0:1.2,heave_velocity=-0.03:0.03",
                                          "--input-sigma", "0.01"};
        words.insert(words.end(), more.begin(), more.end());
        return ask(words);
    }
    static Numbers row(const json& model, std::size_t i) { return model.at("A").at(i).get<Numbers>(); }
    static Numbers joined(Numbers a, const Numbers& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    }
    static double apart(const json& a, const json& b) {
        double most = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                most = std::max(most, std::abs(a.at("A")[i][j].get<double>() - b.at("A")[i][j].get<double>()));
            }
        }
        return most;
    }

    using Questions = std::map<std::string, std::function<Numbers()>>;
    Questions questions_of_films();
    Questions questions_of_the_vehicle();
    Questions questions_of_the_table();
    Questions questions_of_learning();
    Questions questions_of_two_forces();
    Questions questions_of_what_is_printed();
};

ByProgram::Questions ByProgram::questions_of_films() {
    const std::string slider = "inlet=2mm,outlet=1mm,length=50mm,speed=0.5,viscosity=1e-3,density=1000";
    const std::string wedge = "front=50mm,land=100mm,end_gap=4mm,gap=2mm,speed=0.5,viscosity=1e-3,density=1000";
    const std::string film = "half_length=71.7mm,half_width=53.6mm,nozzle_radius=2.5mm,density=1000,viscosity=1e-3";
    const std::string plate = "flow=20mL/s,gap=1mm,nozzle_radius=2.5mm,plate_radius=80mm,viscosity=1e-3,density=1000";
    return {
        {"O21", [=, this] { return theory("slider", slider, {"load_per_width"}); }},
        {"O22", [=, this] { return theory("slider", slider, {"peak_pressure"}); }},
        {"O23",
         [=, this] {
             return theory("slider", slider, {"best_ratio", "best_load_coefficient"});
         }},
        // The printed formula would leave this at the outlet: what is wanted is that it does not.
        {"O24", [=, this] { return Numbers{25 + theory("slider", slider, {"outlet_pressure"}).front()}; }},
        {"O25", [=, this] { return theory("slider", slider, {"centre_of_pressure_share"}); }},
        {"O26",
         [=, this] {
             return theory("wedge", wedge + ",rear=50mm", {"load_per_width", "highest_pressure", "lowest_pressure"});
         }},
        {"O27", [=, this] { return theory("wedge", wedge + ",rear=50mm,pitch=0.1deg", {"load_per_width"}); }},
        {"O28",
         [=, this] {
             return theory("wedge", wedge, {"load_per_width", "land_pressure"});
         }},
        {"O36",
         [=, this] {
             return theory("jet", "thrust=0.036,diameter=5mm,density=1000", {"velocity", "flow", "reynolds"});
         }},
        {"O37",
         [=, this] {
             return theory("radial", plate, {"pressure", "viscous_load"});
         }},
        {"O38",
         [=, this] {
             return theory("radial", plate, {"inertial_load_inviscid", "inertial_load_laminar"});
         }},
        {"O39", [=, this] { return theory("radial", plate, {"gradient_factor"}); }},
        {"O40", [=, this] { return theory("jet_film", film + ",flow=20mL/s,gap=1mm", {"viscous_load"}); }},
        {"O41",
         [=, this] {
             Numbers n =
                 theory("jet_film", film + ",flow=26.587mL/s", {"zero_gap", "lowest_gap", "lowest_force", "stiffness"});
             n[0] *= 1e3;
             n[1] *= 1e3;
             return n;
         }},
        {"O42",
         [=, this] {
             return theory("squeeze", "half_length=71.7mm,half_width=53.6mm,gap=1mm,viscosity=1e-3,density=1000",
                           {"damping", "added_mass"});
         }},
        {"O43",
         [=, this] {
             return theory("squeeze", "half_length=60mm,half_width=60mm,gap=1mm,viscosity=1e-3", {"damping"});
         }},
        {"O44",
         [=, this] {
             return theory("jet", "thrust=0.036,diameter=5mm,density=1000,half_length=101.6mm,half_width=76mm",
                           {"perimeter", "rim_reynolds"});
         }},
    };
}

ByProgram::Questions ByProgram::questions_of_the_vehicle() {
    const std::string jets =
        "J1=0.1,J2=0.08,J3=0.02,J4=0.03,J5=0.01,J6=0.04,J7=0.015,J8=0.025,bottom=0.036,alpha=20deg,beta=20deg,gamma="
        "35deg,turn_x=0.08,turn_y=0.05,turn_z=0.03,pitch_x=0.06,"
        "pitch_upper=0.05,pitch_lower=0.04";
    const std::string evie = "a=101.6mm,b=76mm,c=72.5mm,density=1000,mass=2.2";
    const std::string body = "length=203.2mm,width=152mm,height=145mm,speed=0.5,density=1000,kinematic_viscosity=1e-6";
    const std::string drag = "linear=0.05,quadratic=15,length=152mm,kinematic_viscosity=1e-6";
    const auto ellipsoid = [=, this](const std::vector<std::string>& wanted) {
        return theory("ellipsoid", evie, wanted);
    };
    const auto run = [=, this](const std::string& friction) {
        const Numbers n = ellipsoid({"added_mass_x", "added_mass_y", "added_inertia_yaw"});
        const double inertia = 2.2 / 5 * (.1016 * .1016 + .076 * .076);
        return theory("surface",
                      "mass=2.2,added_mass_x=" + core::format_number(n[0], 17) + ",added_mass_y=" +
                          core::format_number(n[1], 17) + ",added_inertia_yaw=" + core::format_number(n[2], 17) +
                          ",yaw_inertia=" + core::format_number(inertia, 17) + ",speed=0.35,friction_force=" + friction,
                      {"upper_pole", "lower_pole"});
    };
    return {
        {"O01",
         [=, this] {
             return theory("jets", jets, {"force_x", "force_y", "force_z"});
         }},
        {"O02",
         [=, this] {
             return theory("jets", jets, {"moment_x", "moment_y", "moment_z"});
         }},
        {"O03",
         [=, this] { return theory("jets", "turn_x=80mm,turn_z=30mm,gamma=35deg", {"pitch_free_beta_degrees"}); }},
        {"O04",
         [=, this] {
             const double beta = theory("jets", "turn_x=80mm,turn_z=30mm,gamma=35deg", {"pitch_free_beta"}).front();
             return theory("jets",
                           "J1=1,J2=1,turn_x=80mm,turn_z=30mm,gamma=35deg,beta=" + core::format_number(beta, 17),
                           {"moment_y"});
         }},
        {"O05",
         [=, this] {
             return theory("jets", "J1=1,J5=1,beta=20deg,gamma=35deg", {"force_x", "force_y", "moment_z"});
         }},
        {"O06", [=, this] { return theory("ellipsoid", "a=1,b=1,c=1", {"k_x"}); }},
        {"O07",
         [=, this] {
             return theory("ellipsoid", "a=2,b=1,c=1", {"k_x", "k_y", "k_pitch"});
         }},
        {"O08",
         [=, this] {
             return theory("ellipsoid", "a=1.5,b=1,c=1", {"k_x", "k_y"});
         }},
        {"O09",
         [=, this] {
             return theory("ellipsoid", "a=1000,b=2,c=1", {"k_y", "k_z"});
         }},
        {"O10",
         [=] {
             return ellipsoid({"integral_x", "integral_y", "integral_z"});
         }},
        {"O11",
         [=] {
             return ellipsoid({"volume", "displaced_mass"});
         }},
        {"O12",
         [=] {
             return ellipsoid({"added_mass_x", "added_mass_y", "added_mass_z"});
         }},
        {"O13",
         [=] {
             return ellipsoid({"added_inertia_roll", "added_inertia_pitch", "added_inertia_yaw"});
         }},
        {"O14",
         [=] {
             return ellipsoid({"munk_yaw", "munk_pitch"});
         }},
        {"O15",
         [=, this] {
             const Numbers n = ellipsoid({"added_mass_x", "added_mass_y"});
             return theory("munk",
                           "added_mass_x=" + core::format_number(n[0], 17) +
                               ",added_mass_y=" + core::format_number(n[1], 17) + ",speed=0.35,sideslip=6deg",
                           {"yaw_moment"});
         }},
        {"O16",
         [=] {
             return ellipsoid({"virtual_mass_x", "virtual_mass_y", "virtual_mass_z", "virtual_inertia_yaw"});
         }},
        {"O17", [=] { return Numbers{run("0").front()}; }},
        {"O18", [=] { return run("0.1"); }},
        {"O19",
         [=, this] {
             return theory("kinematics", "u=0.3,v=0.1,w=-0.05,theta=0.2,psi=0.7", {"north", "east", "down"});
         }},
        {"O20",
         [=, this] {
             core::write_file(folder_.path() / "free.toml",
                              "[vehicle]\nmass = 2.2\nadded_mass_heave = " + core::format_number(1 / .2529 - 2.2, 17) +
                                  "\nnet_weight = 0\n");
             const json gains =
                 ask({"linear", "free.toml", "--at", "gap=100mm", "--weights", "1,100,1"}).at("heave").at(0).at("lqr");
             return Numbers{gains.at("velocity_gain"), gains.at("gap_gain")};
         }},
        {"O29",
         [=, this] {
             return theory("coefficients", body, {"plan_area", "cross_section", "printed_cross_section"});
         }},
        {"O30", [=, this] { return theory("coefficients", body + ",lift_force=0.65", {"lift_coefficient"}); }},
        {"O31",
         [=, this] {
             return theory("spring", "stiffness=220,virtual_mass=2.2,angular_frequency=8.8",
                           {"angular_frequency", "mass_of_frequency", "stiffness_of_frequency"});
         }},
        {"O32",
         [=, this] {
             return each("spring",
                         {"stiffness=220,virtual_mass=2.2,gap=2mm,angular_frequency=8.8",
                          "stiffness=220,virtual_mass=2.2,gap=2mm"},
                         "survivable_kick");
         }},
        {"O33",
         [=, this] {
             return theory("scaling", "size=2",
                           {"force", "mass", "force_per_mass", "stiffness", "frequency", "gap", "kick"});
         }},
        {"O34",
         [=, this] {
             return theory("scaling", "speed=2", {"force", "stiffness", "frequency"});
         }},
        {"O35",
         [=, this] {
             return theory("coefficients", body, {"reynolds", "length_of_reynolds_40000"});
         }},
        {"O45",
         [=, this] {
             return theory("voltage", "low_thrust=0.7mN,high_thrust=36mN,low_voltage=3,high_voltage=12", {"exponent"});
         }},
        {"O46",
         [=, this] {
             return each("voltage", {"neutral_voltage=10,voltage=8", "neutral_voltage=10,voltage=4"}, "upwash");
         }},
        {"O47",
         [=, this] {
             Numbers n;
             for (const char* force : {"50 gf", "3 gf"}) {
                 n.push_back(
                     ask({"theory", "coefficients", body + ",lift_force=" + force}).at("inputs").at("lift_force"));
             }
             return n;
         }},
        {"O48",
         [=, this] {
             return theory("drag", drag, {"w1", "w2", "c0", "c1", "c2", "c3", "c4", "c5"});
         }},
        {"O49",
         [=, this] {
             Numbers n =
                 each("drag", {drag + ",velocity=2e-3", drag + ",velocity=5e-3", drag + ",velocity=0.02"}, "force");
             n.push_back(theory("drag", drag + ",velocity=2e-3", {"slope"}).front());
             return n;
         }},
        {"O50",
         [=, this] {
             return theory("drag", drag, {"gaussian_factor", "harmonic_factor_of_amplitude", "harmonic_factor"});
         }},
        {"O51",
         [=, this] {
             return theory("drag", drag,
                           {"uniform_correlation", "uniform_cubic_on_linear", "uniform_cubic_on_quadratic"});
         }},
    };
}

ByProgram::Questions ByProgram::questions_of_the_table() {
    const auto at = [this](const std::vector<std::string>& gaps, const char* what) {
        std::vector<std::string> words = {"table", "at", "ref-a.csv", "--kind", "spline"};
        for (const auto& gap : gaps) {
            words.push_back("gap=" + gap);
        }
        Numbers n;
        const json answer = ask(words);  // lives as long as the loop
        for (const auto& value : answer.at("values")) {
            n.push_back(std::string(what) == "slope" ? value.at("slope").at("gap").get<double>()
                                                     : value.at("value").get<double>());
        }
        return n;
    };
    const auto balance = [this](const std::string& weight) {
        return ask({"table", "equilibria", "ref-a.csv", "--kind", "spline", "--weight", weight, "--mass",
                    core::format_number(1 / .2529, 17)});
    };
    const auto equilibria = [balance](const std::string& weight) { return balance(weight).at("equilibria"); };
    const auto near = [](const json& list, double gap) {
        for (const auto& e : list) {
            if (std::abs(e.at("gap").get<double>() - gap) < 0.01) {
                return e;
            }
        }
        return json();
    };
    return {
        {"O52",
         [=] {
             return at({"0.005", "0.065", "0.155", "0.275", "0.75"}, "value");
         }},
        {"O53",
         [=] {
             return at({"0", "0.1", "0.25"}, "slope");
         }},
        {"O54",
         [=] {
             const json all = balance("0");
             Numbers n{near(all.at("equilibria"), 0).at("gap"), near(all.at("equilibria"), .16).at("gap")};
             for (const char* kind : {"lowest", "highest"}) {
                 double best = 0;
                 Numbers found;
                 for (const auto& extreme : all.at("extremes")) {
                     const double force = extreme.at("force");
                     if (extreme.at("kind") == kind && std::abs(force) > best) {
                         best = std::abs(force);
                         found = {extreme.at("gap").get<double>(), force};
                     }
                 }
                 n = joined(n, found);
             }
             return n;
         }},
        {"O56",
         [=] {
             const json stable = near(equilibria("0"), 0);
             return Numbers{stable.at("barrier_up"), stable.at("kick_velocity_up")};
         }},
        {"O55",
         [=] {
             const Numbers slopes = at({"0", "0.16"}, "slope");
             const json list = equilibria("0");
             const double unstable = near(list, .16).at("stiffness");
             return Numbers{slopes[0], slopes[1], 6.283185307179586 * near(list, 0).at("frequency").get<double>(),
                            std::sqrt(-unstable * .2529)};
         }},
        {"O57",
         [=] {
             const json list = equilibria("-0.010 N");
             return Numbers{near(list, .03).at("gap"), near(list, .1133).at("gap")};
         }},
        {"O88",
         [=, this] {
             const json run = ask({"simulate", "ref-a.toml", "--from", "gap=25mm", "--for", "120", "--feedback",
                                   "velocity_gain=" + core::format_number(2 / .2529, 17) +
                                       ",gap_gain=" + core::format_number(1 / .2529, 17) + ",reference=20mm"});
             return Numbers{run.at("gap").back()};
         }},
    };
}

namespace {
std::string entries(const std::string& name, const estimator::Matrix& m) {
    std::string text;
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t k = 0; k < 2; ++k) {
            text += (text.empty() ? "" : ",") + name + std::to_string(i + 1) + std::to_string(k + 1) + "=" +
                    core::format_number(m(i, k), 17);
        }
    }
    return text;
}
}  // namespace

ByProgram::Questions ByProgram::questions_of_two_forces() {
    // The matrices are those that were printed; what the program says of them is asked as a user asks it of his own.
    const estimator::AugmentedModel first = thesis::published_8_47(), second = thesis::published_grid();
    const std::string mass = ",virtual_mass=" + core::format_number(1 / .2529, 17);
    const auto forces = [=](const estimator::AugmentedModel& m) {
        return entries("j", m.j_zeta()) + "," + entries("jx", m.j_x()) + mass;
    };
    const auto spectrum = [=, this](const estimator::AugmentedModel& m) {
        return theory("two_forces", forces(m), {"eigenvalue_1", "eigenvalue_2", "observability"});
    };
    const auto margins = [=, this](const estimator::AugmentedModel& m) {
        return theory("margins", entries("a", m.j_zeta()), {"norm", "each_entry", "each_changing_entry"});
    };
    const std::string closed = "a11=-3,a12=-2,a21=1,a22=0";
    const auto frozen = estimator::frozen_model(thesis::reference_plant(), 0.1, 0.0075);
    return {
        {"O75", [=] { return spectrum(first); }},
        {"O76", [=] { return margins(first); }},
        {"O77", [=] { return spectrum(second); }},
        {"O78", [=] { return margins(second); }},
        {"O79",
         [=, this] {
             return joined(
                 theory("margins", closed, {"p11", "p12", "p22", "norm", "each_entry", "each_changing_entry"}),
                 theory("margins", closed + ",change12=0,change21=0,change22=0", {"each_changing_entry"}));
         }},
        {"O80",
         [=, this] {
             const auto known = estimator::heave_rows(first.layout, thesis::thesis_virtual_mass(), 0);
             const auto p3 = estimator::corrected(first, estimator::Correction::p3, known);
             return theory("two_forces", forces(p3) + ",pole_1=-1,pole_2=-2", {"gain_1", "gain_2"});
         }},
        {"O81",
         [=, this] {
             return joined(theory("two_forces", forces(first), {"drag_slope"}),
                           theory("two_forces", forces(second), {"drag_slope"}));
         }},
        {"O82",
         [=, this] {
             return theory("two_forces", forces(first) + ",gap=1.5", {"steady_ground_force", "steady_drag_force"});
         }},
        {"O83",
         [=, this] {
             return theory("two_forces", forces(frozen), {"rank", "full_rank"});
         }},
        {"O84",
         [=, this] {
             return theory("two_forces",
                           "j11=0,j12=0,j21=0.377,j22=-0.377,gain_1=8,gain_2=2,ground_error=0.01,drag_error=0.01,"
                           "time=10" +
                               mass,
                           {"ground_error_left", "drag_error_left"});
         }},
    };
}

ByProgram::Questions ByProgram::questions_of_learning() {
    Questions all;
    int id = 58;
    for (const std::string model : {"sine", "ref-a"}) {
        const auto name = [&] { return "O" + std::to_string(id++); };
        all[name()] = [=, this] { return learned(model, {"--order", "6"}).at("eigenvalues").get<Numbers>(); };
        for (const char* order : {"6", "7"}) {
            const auto six = [=, this] { return learned(model, {"--order", order}); };
            all[name()] = [=] {
                const json m = six();
                return joined(row(m, 0), row(m, 1));
            };
            all[name()] = [=] {
                const json m = six();
                Numbers n = joined(row(m, 2), row(m, 3));
                for (const auto& b : m.at("B")) {
                    n.push_back(b.at(0));
                }
                return n;
            };
            all[name()] = [=, this] {
                return Numbers{apart(learned(model, {"--order", order, "--fit", "method1"}),
                                     learned(model, {"--order", order, "--fit", "method2"}))};
            };
        }
        all[name()] = [=, this] {
            const json m = learned(model, {"--fit", "least_squares"});
            Numbers n = joined(row(m, 2), row(m, 3));
            n.push_back(m.at("B").at(2).at(0));
            n.push_back(m.at("B").at(3).at(0));
            return n;
        };
    }
    all["O89"] = [this] {
        const json m = learned("linear-drag", {"--order", "5"});
        return joined(joined({m.at("rank").get<double>()}, row(m, 0)), joined(row(m, 1), row(m, 3)));
    };
    // A mesh whose ends are midpoints stands for the uniform population; two inputs at +-sigma have the moments of the
    // Gaussian.
    all["O74"] = [this] {
        const json m =
            ask({"learn", "fitted-drag.toml", "--mesh", "2x160x600", "--region",
                 "gap=0.001:1.199,heave_velocity=-0.0298125:0.0298125", "--input-sigma", "0.00278", "--order", "6"});
        return Numbers{m.at("A").at(3).at(0), m.at("A").at(3).at(2), m.at("A").at(3).at(3), m.at("B").at(3).at(0)};
    };
    return all;
}

/// The numbers of a sentence, in their order.
Numbers numbers_in(const std::string& text) {
    Numbers found;
    const char* at = text.c_str();
    while (*at != '\0') {
        char* end = nullptr;
        const bool begins = std::isdigit(static_cast<unsigned char>(*at)) != 0 ||
                            (*at == '-' && std::isdigit(static_cast<unsigned char>(at[1])) != 0);
        const double value = begins ? std::strtod(at, &end) : 0;
        begins ? found.push_back(value) : void();
        at = begins ? end : at + 1;
    }
    return found;
}

/// What is printed in the thesis is judged claim by claim in a study of its own; these are asked of its claims.
ByProgram::Questions ByProgram::questions_of_what_is_printed() {
    const auto claims_of = [this](const std::string& study) {
        const json run = ask({"study", "run", (source_folder() / "cases" / study).string(), "--store",
                              (folder_.path() / (study + ".sqlite")).string(), "--report",
                              (folder_.path() / study / "index.html").string()});
        std::map<std::string, Numbers> claims;
        for (const auto& [name, part] : run.at("results").items()) {
            for (const auto& claim : part.value("claims", json::array())) {
                claims[claim.at("id")] = numbers_in(claim.at("computed"));
            }
        }
        return claims;
    };
    const auto printed = std::make_shared<std::optional<std::map<std::string, Numbers>>>();
    const auto of_thesis = [=](const std::string& id) {
        if (!*printed) {
            *printed = claims_of("thesis");
        }
        return (*printed)->at(id);
    };
    return {{"O85",
             [=] {
                 Numbers n = of_thesis("7-C");  // asymmetry, its column, eigenvalues
                 n.erase(n.begin() + 1);
                 return n;
             }},
            {"O86", [=] { return of_thesis("7-T"); }},
            {"O87", [=] { return Numbers{claims_of("thesis-dynamics").at("3.6").front()}; }}};
}

TEST_F(ByProgram, EveryOracleOfThePhysicsNotesIsReached) {
    write_reference_curve();
    Questions questions;
    for (auto& part : {questions_of_films(), questions_of_the_vehicle(), questions_of_the_table(),
                       questions_of_learning(), questions_of_two_forces(), questions_of_what_is_printed()}) {
        questions.insert(part.begin(), part.end());
    }
    const auto all = oracles();
    ASSERT_EQ(all.size(), 89U);
    for (const auto& [id, oracle] : all) {
        const auto question = questions.find(id);
        if (question == questions.end()) {
            ADD_FAILURE() << id << " (" << oracle.inputs << ") is reached by no command";
            continue;
        }
        SCOPED_TRACE(id + ": " + oracle.inputs);
        const Numbers got = question->second();
        // Some rows of the file name two further values in words.
        ASSERT_GE(got.size(), 1U);
        const std::size_t count = std::min(got.size(), oracle.expected.size());
        EXPECT_EQ(got.size(), oracle.expected.size());
        double largest = 0;
        for (const double value : oracle.expected) {
            largest = std::max(largest, std::abs(value));
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double want = oracle.expected[i];
            // A printed number is known to its last digit, whatever tolerance the row asks.
            const double digits = 0.6 * std::pow(10, std::floor(std::log10(std::max(std::abs(want), 1e-300))) - 7);
            // What is nothing but rounding beside the other numbers of its row may be another nothing.
            const double relative =
                oracle.tolerance * std::max({std::abs(want), 1e-3 * largest, want == 0 ? 1.0 : 0.0});
            EXPECT_NEAR(got[i], want, std::max({oracle.absolute ? oracle.tolerance : relative, digits, 1e-12}))
                << "value " << i;
        }
    }
    for (const auto& [id, question] : questions) {
        EXPECT_TRUE(all.contains(id)) << id;
    }
}

TEST_F(ByProgram, SimulateKeepsTheEnergyOfAnIdealFluid) {  // O87, its corrected equations
    const double mass = 2.2, surge = 0.79865194, sway = 1.335082, yaw = 0.00708337, added_yaw = 0.00037700395;
    core::write_file(
        folder_.path() / "ideal.toml",
        "[vehicle]\nmass = 2.2\nadded_mass_surge = 0.79865194\nadded_mass_sway = 1.335082\n"
        "added_mass_heave = 1.4565619\nroll_inertia = 0.00485441\npitch_inertia = 0.00685484\n"
        "yaw_inertia = 0.00708337\nadded_inertia_roll = 8.7418652e-06\nadded_inertia_pitch = 0.0005086667\n"
        "added_inertia_yaw = 0.00037700395\nbase_depth = 0.0514\nbase_half_length = 0.0717\n"
        "buoyancy_height = 0.005\nnet_weight = 0\n[contact]\nfriction = 0\n");
    for (const std::string motion : {"body", "surface"}) {
        for (const auto& [tolerance, kept] : {std::pair<const char*, double>{"1e-9", 2e-7}, {"1e-14", 1e-10}}) {
            const auto run =
                run_underbody({"simulate", "ideal.toml", "--motion", motion, "--from",
                               motion == "body" ? "gap=10m,speed=0.35,sway_velocity=0.02,yaw_rate=0.1"
                                                : "speed=0.35,sway_velocity=0.02,yaw_rate=0.1",
                               "--for", "10", "--step", "0.1", "--tolerance", tolerance, "--out", "run.csv"},
                              folder_.path());
            ASSERT_EQ(run.exit_code, 0) << run.errors;
            const core::Table path = core::read_csv(folder_.path() / "run.csv");
            const auto energy = [&](std::size_t i) {
                const double u = path.numbers("u")[i], v = path.numbers("v")[i], r = path.numbers("r")[i];
                return (mass + surge) * u * u + (mass + sway) * v * v + (yaw + added_yaw) * r * r;
            };
            ASSERT_GE(path.rows(), 100U);
            for (std::size_t i = 0; i < path.rows(); ++i) {
                ASSERT_NEAR(energy(i) / energy(0), 1, kept) << motion << ", " << tolerance << ", row " << i;
            }
        }
    }
}

TEST_F(ByProgram, TheoryRefusesWhatItDoesNotTakeAndSaysWhereItEnds) {
    const auto typo = run_underbody({"theory", "squeze", "gap=1mm"});
    EXPECT_EQ(typo.exit_code, 2);
    EXPECT_THAT(typo.errors, testing::HasSubstr("did you mean 'squeeze'?"));
    const auto input = run_underbody({"theory", "squeeze", "half_lenght=71mm"});
    EXPECT_EQ(input.exit_code, 2);
    EXPECT_THAT(input.errors, testing::HasSubstr("did you mean 'half_length'?"));
    const auto missing = run_underbody({"theory", "squeeze", "gap=1mm"});
    EXPECT_EQ(missing.exit_code, 2);
    EXPECT_THAT(missing.errors, testing::HasSubstr("squeeze needs half_length: half axis of the base along x"));
    const auto unit = run_underbody({"theory", "squeeze", "gap=1kg"});
    EXPECT_EQ(unit.exit_code, 2);
    const json thick = ask({"theory", "squeeze", "half_length=71.7mm,half_width=53.6mm,gap=20mm"});
    EXPECT_FALSE(thick.at("valid").get<bool>());
    const auto text = run_underbody({"theory", "slider", "inlet=2mm,outlet=1mm,length=50mm,speed=0.5"});
    EXPECT_THAT(
        text.output,
        testing::HasSubstr("OUTSIDE ITS RANGE: the water's inertia is left out: U h^2/(nu L) = 39.9, to be below 1"));
    // The jet of EVIE at 12 V: thin and laminar, and yet CFD has suction where the formula lifts (cases/evie/jet).
    const std::string plate = "half_length=67.2mm,half_width=50.3mm,nozzle_radius=2.5mm,gap=1mm,flow=";
    EXPECT_TRUE(ask({"theory", "jet_film", plate + "3.714mL/s"}).at("valid").get<bool>());
    EXPECT_THAT(
        run_underbody({"theory", "jet_film", plate + "26.587mL/s"}).output,
        testing::HasSubstr("OUTSIDE ITS RANGE: the film's inertia is small: Q h/(pi nu a b) = 2.5, to be below"));
    EXPECT_FALSE(ask({"theory", "radial", "flow=20mL/s,gap=1mm,nozzle_radius=2.5mm,plate_radius=58mm"}).at("valid"));
    const json list = ask({"theory", "list"});
    EXPECT_GE(list.at("theories").size(), 16U);
}

}  // namespace
}  // namespace underbody::test
