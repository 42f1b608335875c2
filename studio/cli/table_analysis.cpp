#include "studio/cli/table_analysis.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/cli/table_options.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/collapse.h"
#include "surrogates/tables/analysis/compare.h"
#include "surrogates/tables/analysis/continuation.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/analysis/pitch.h"
#include "surrogates/tables/fit/table_batch.h"
#include "surrogates/tables/points/select.h"

namespace underbody::studio {

namespace {

std::string five_digits(double value, int digits = 5) { return core::format_number(value, digits); }

std::string eigenvalue(const std::complex<double>& value) {
    return five_digits(value.real(), 4) +
           (value.imag() == 0 ? ""
                              : (value.imag() < 0 ? " - " : " + ") + five_digits(std::abs(value.imag()), 4) + " i");
}

struct ContinueCommand {
    TableOptions table;
    std::string along, weight = "0 N", held, picture, reference;
    double exponent = 2;
};

/// Each stretch of one stability from end to end, and the folds between them.
void show_curve(Shell& shell, const tables::ForceTable& table, const tables::EquilibriumCurve& curve) {
    const auto place = [&](double parameter, double gap) {
        return curve.parameter + " " + five_digits(parameter) + " " + curve.parameter_unit + ", " + curve.axis + " " +
               shown(table, curve.axis, curve.axis_unit, gap, 6);
    };
    for (const auto& branch : curve.branches) {
        for (std::size_t i = 0, j = 0; i < branch.size(); i = j) {
            while (j < branch.size() && branch[j].stability == branch[i].stability) {
                ++j;
            }
            shell.print(tables::to_string(branch[i].stability) + " from " + place(branch[i].parameter, branch[i].gap) +
                        " to " + place(branch[j - 1].parameter, branch[j - 1].gap));
        }
    }
    for (const auto& fold : curve.folds) {
        shell.print("fold at " + place(fold.parameter, fold.gap));
    }
    if (curve.branches.empty()) {
        shell.print("no equilibrium in this range of " + curve.parameter);
    }
}

int run_continue(Shell& shell, const ContinueCommand& command) {
    const std::size_t equals = command.along.find('=');
    const std::size_t colon = command.along.find(':');
    if (equals == std::string::npos || colon == std::string::npos || colon < equals) {
        throw core::UsageError("parse", "'" + command.along + "' is not of the form NAME=LOWER:UPPER", {},
                               "such as --along net_weight=0:0.5 or --along speed=0.2:1");
    }
    tables::ContinuationOptions options;
    options.parameter = std::string(core::trimmed(command.along.substr(0, equals)));
    const auto* known = core::find_quantity(options.parameter);
    const std::string unit = options.parameter == "net_weight" ? "N" : known != nullptr ? known->unit : "1";
    options.lower = option_value("--along", command.along.substr(equals + 1, colon - equals - 1), unit);
    options.upper = option_value("--along", command.along.substr(colon + 1), unit);
    options.base.net_weight = option_value("--weight", command.weight, "N");
    options.base.held = read_assignments(command.held);
    TableOptions of_table = command.table;
    of_table.free_axis = options.parameter;
    const auto table = of_table.fit(shell, of_table.is_model() ? &options.base.held : nullptr);
    options.exponent = command.exponent;
    const auto named = [&](const auto& entry) { return entry.first == options.parameter; };
    const auto& conditions = table.conditions();
    const auto condition = std::find_if(conditions.begin(), conditions.end(), named);
    const bool axis = std::any_of(table.axes().begin(), table.axes().end(),
                                  [&](const tables::TableAxis& a) { return a.name == options.parameter; });
    if (!command.reference.empty()) {
        options.reference = option_value("--reference", command.reference, unit);
    } else if (condition != conditions.end()) {
        options.reference = condition->second;
    } else if (known != nullptr && options.parameter != "net_weight" && !axis) {
        throw core::UsageError("missing", "the table does not say at which " + options.parameter + " it was made", {},
                               "say it: --reference \"0.5 " + unit + "\"");
    }
    shell.show(tables::outside_remarks(table, options.base.held));
    const auto curve = tables::continue_equilibria(table, options, shell.progress());
    show_curve(shell, table, curve);
    if (!command.picture.empty()) {
        write_picture(tables::continuation_figure(table, curve), command.picture);
    }
    if (shell.json) {
        shell.print_json(nlohmann::json(curve));
    }
    return done;
}

struct PitchCommand {
    TableOptions table;
    std::string held, weight, trim, mass, inertia, picture;
};

std::string angle_in_degrees(double radians) {
    return five_digits(core::convert(std::abs(radians) < 1e-12 ? 0 : radians, "rad", "deg"), 4);
}

void show_windows(Shell& shell, const std::vector<tables::PitchWindow>& windows) {
    for (const auto& w : windows) {
        const auto edge = [](double pitch, double sigma) {
            return angle_in_degrees(pitch) +
                   (sigma > 1e-9 ? " +- " + five_digits(core::convert(sigma, "rad", "deg"), 2) : "");
        };
        shell.print(w.side + ": restores from " + edge(w.lower, w.lower_sigma) + " to " + edge(w.upper, w.upper_sigma) +
                    " deg, stiffest at " + angle_in_degrees(w.best_pitch) + " deg (" +
                    core::told(w.stiffness, "N m/rad", 4) + "); trim torque there " + five_digits(w.trim_torque, 4) +
                    " N m nose up, " + five_digits(w.trim_lower, 4) + " to " + five_digits(w.trim_upper, 4) +
                    " N m over the window");
    }
    if (windows.empty()) {
        shell.print("the pitch moment restores nowhere in the table");
    }
}

void show_coupled(Shell& shell, const tables::ForceTable& lift, const std::vector<tables::CoupledEquilibrium>& found,
                  bool masses) {
    const auto with_error = [](double sigma, const std::string& text) {
        return sigma > 0 && std::isfinite(sigma) ? " +- " + text : std::string();
    };
    for (const auto& e : found) {
        std::string text =
            e.kind + " balance of heave and pitch at gap " + shown(lift, "gap", "m", e.gap) +
            with_error(e.gap_sigma, shown(lift, "gap", "m", e.gap_sigma, 2)) + ", pitch " + angle_in_degrees(e.pitch) +
            " deg" + with_error(e.pitch_sigma, five_digits(core::convert(e.pitch_sigma, "rad", "deg"), 2) + " deg");
        text += e.frequency[0] > 0
                    ? "; " + five_digits(e.frequency[0], 4) + " and " + five_digits(e.frequency[1], 4) + " Hz"
                    : "; eigenvalues of the stiffness " + std::string(masses ? "over the masses " : "") +
                          eigenvalue(e.eigenvalues[0]) + " and " + eigenvalue(e.eigenvalues[1]) +
                          (masses ? " 1/s^2" : "");
        shell.print(text);
    }
    if (!found.empty() && !masses) {
        shell.show_warning(
            "without --mass and --inertia 1 kg and 1 kg m^2 are taken: they decide between stable and flutter where "
            "the stiffness is not symmetric");
    }
}

tables::CoupledOptions coupled_options(const PitchCommand& command, const tables::Held& held) {
    tables::CoupledOptions options;
    options.net_weight = option_value("--weight", command.weight, "N");
    options.trim_torque = command.trim.empty() ? 0 : option_value("--trim", command.trim, "N m");
    options.virtual_mass = command.mass.empty() ? 0 : option_value("--mass", command.mass, "kg");
    options.virtual_inertia = command.inertia.empty() ? 0 : option_value("--inertia", command.inertia, "kg m^2");
    options.held = held;
    std::erase_if(options.held, [](const auto& h) { return h.first == "gap"; });  // of the windows; here it is free
    return options;
}

nlohmann::json print_no_balance(Shell& shell, const tables::ForceTable& lift, const tables::ForceTable& moment,
                                const tables::CoupledOptions& options) {
    const auto trim = tables::trim_range(lift, moment, options);
    shell.print(trim ? "heave and pitch balance nowhere together: where lift holds the weight, the trim torque "
                       "would be " +
                           five_digits(trim->first, 4) + " to " + five_digits(trim->second, 4) + " N m nose up"
                     : "heave and pitch balance nowhere together: lift holds the weight nowhere");
    return trim ? nlohmann::json{trim->first, trim->second} : nlohmann::json();
}

nlohmann::json find_windows(Shell& shell, const PitchCommand& command, const tables::ForceTable& moment,
                            const tables::Held& held) {
    const auto found = tables::pitch_windows(moment, held);
    show_windows(shell, found);
    if (!command.picture.empty()) {
        write_picture(tables::pitch_figure(moment, held), command.picture);
    }
    return found;
}

int run_pitch(Shell& shell, const PitchCommand& command) {
    TableOptions table = command.table;
    table.quantity = "pitch_moment";
    auto held = read_assignments(command.held);
    auto held_for_lift = held;
    const auto moment = table.fit(shell, table.is_model() ? &held : nullptr);
    shell.show(tables::outside_remarks(moment, held));
    const auto holds = [&](const char* name) {
        return std::any_of(held.begin(), held.end(), [&](const auto& h) { return h.first == name; });
    };
    nlohmann::json document;
    document["windows"] = nlohmann::json::array();
    const bool windows = command.weight.empty() || holds("gap");
    if (windows) {
        document["windows"] = find_windows(shell, command, moment, held);
    }
    if (!command.weight.empty()) {
        table.quantity = "lift_force";
        const auto lift = table.fit(shell, table.is_model() ? &held_for_lift : nullptr);
        const tables::CoupledOptions options = coupled_options(command, held);
        const auto found = tables::coupled_equilibria(lift, moment, options);
        if (found.empty()) {
            document["trim"] = print_no_balance(shell, lift, moment, options);
        }
        show_coupled(shell, lift, found, options.virtual_mass > 0);
        if (table.is_model()) {
            shell.show_warning(
                "these balances are of the model's tables alone, with moments about the point that the tables name: "
                "the vehicle's buoyancy and its centre of gravity are left out (linear MODEL balances the vehicle with "
                "them)");
        }
        document["equilibria"] = found;
        if (!windows && !command.picture.empty()) {
            write_picture(tables::coupled_figure(lift, moment, options), command.picture);
        }
    }
    if (!command.picture.empty()) {
        document["picture"] = command.picture;
    }
    if (shell.json) {
        shell.print_json(document);
    }
    return done;
}

struct CompareCommand {
    TableOptions table;
    std::string by = "variant", measure, held, picture;
};

void show_comparison(Shell& shell, const tables::ForceTable& table, const tables::Comparison& c) {
    const bool restoring = c.measure.find("restoring") != std::string::npos;
    for (std::size_t i = 0; i < c.names.size(); ++i) {
        shell.print(c.names[i] + ": " +
                    (restoring && !(c.values[i] > 0) ? "restores nowhere"
                                                     : c.measure + " of the " + tables::noun_of(c.quantity) + " " +
                                                           core::told(c.values[i], c.errors[i], c.unit, 5)));
    }
    const std::string unit = table.axes()[tables::axis_index(table, c.axis)].unit;
    const std::string range = "compared over the " + c.axis + " that all have, " +
                              shown(table, c.axis, unit, c.lower, 4) + " to " + shown(table, c.axis, unit, c.upper, 4);
    shell.print((c.winner.empty()
                     ? "none of them restores"
                     : c.winner + " wins by " + c.measure +
                           (c.beyond_error   ? ", beyond the errors"
                            : c.errors_known ? ", but within the errors"
                                             : "; their points state no errors, so +- is of the interpolation alone")) +
                "; " + range);
    for (const auto& d : c.differences) {
        std::string where;
        for (const auto& [from, to] : d.beyond_error) {
            where += (where.empty() ? "" : ", ") + shown(table, c.axis, unit, from, 4) +
                     (to > from ? " to " + shown(table, c.axis, unit, to, 4) : "");
        }
        shell.print(d.second + " less " + d.first + ": at most " + five_digits(d.largest, 3) + " +- " +
                    (std::isfinite(d.sigma) ? five_digits(d.sigma, 2) : std::string("(no error known)")) + " " +
                    table.unit() + ", at " + shown(table, c.axis, unit, d.at, 4) +
                    (!std::isfinite(d.sigma) ? ""
                     : where.empty()         ? "; nowhere beyond twice the joint error"
                                             : "; beyond twice the joint error at " + where));
    }
}

int run_compare(Shell& shell, const CompareCommand& command) {
    const auto points = command.table.points(shell);
    std::vector<std::string> names;
    for (const auto& name : points.text(command.by)) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            names.push_back(name);
        }
    }
    const std::string quantity =
        command.table.quantity.empty() ? tables::force_columns(points).front() : command.table.quantity;
    std::vector<std::pair<std::string, tables::ForceTable>> all;
    for (const auto& name : names) {
        try {
            all.emplace_back(name, tables::ForceTable::fit(tables::selected_rows(points, command.by + "=" + name),
                                                           quantity, command.table.fit_options()));
        } catch (const core::InputError& error) {
            shell.show_warning(name + " is left out: " + error.message());
        }
    }
    tables::ComparisonOptions options;
    options.held = read_assignments(command.held);
    if (!command.measure.empty()) {
        const auto& measures = tables::measure_names();
        const auto at = std::find(measures.begin(), measures.end(), command.measure);
        if (at == measures.end()) {
            throw core::UsageError("measure", "there is no measure '" + command.measure + "'", {},
                                   core::did_you_mean(command.measure, measures));
        }
        options.measure = static_cast<tables::Measure>(at - measures.begin());
    }
    if (all.size() < 2) {
        throw core::UsageError("few", "a comparison needs at least two tables");
    }
    for (const auto& [name, table] : all) {
        shell.show(tables::outside_remarks(table, options.held));
    }
    const auto result = tables::compare_tables(all, options);
    show_comparison(shell, all.front().second, result);
    if (!command.picture.empty()) {
        tables::FigureOptions figure;
        figure.held = options.held;
        write_picture(tables::comparison_figure(all, figure), command.picture);
    }
    if (shell.json) {
        shell.print_json(nlohmann::json(result));
    }
    return done;
}

struct CollapseCommand {
    TableOptions table;
    std::string by, length, width, density, picture;
};

int run_collapse(Shell& shell, const CollapseCommand& command) {
    const auto points = command.table.points(shell);
    const auto forces = tables::force_columns(points);
    if (forces.empty() && command.table.quantity.empty()) {
        throw core::InputError("missing", "the table has no force column", {points.source, {}, {}, {}},
                               "name one by --quantity");
    }
    tables::CollapseOptions options;
    options.by = command.by;
    options.length = command.length.empty() ? 0 : option_value("--length", command.length, "m");
    options.width = command.width.empty() ? 0 : option_value("--width", command.width, "m");
    options.density = command.density.empty() ? options.density : option_value("--density", command.density, "kg/m^3");
    const auto result =
        tables::collapse(points, command.table.quantity.empty() ? forces.front() : command.table.quantity, options);
    for (const auto& g : result.groups) {
        std::string where;
        for (const auto& [from, to] : g.beyond) {
            where += (where.empty() ? "; off at " : ", ") + result.abscissa + " " + five_digits(from, 4) +
                     (to > from ? " to " + five_digits(to, 4) : "");
        }
        shell.print(result.by + " " + five_digits(g.level) + " " + result.by_unit + ": " +
                    core::counted(g.points, "point") + ", " + five_digits(g.mean_ratio, 4) +
                    " of what the square law says from " + five_digits(result.reference) + " " + result.by_unit +
                    ", exponent " + five_digits(g.exponent, 4) + where);
    }
    shell.print(result.verdict);
    nlohmann::json document = result;
    if (!command.picture.empty()) {
        write_picture(tables::collapse_figure(result), command.picture);
        document["picture"] = command.picture;
    }
    if (shell.json) {
        shell.print_json(document);
    }
    return done;
}

void add_continue(CLI::App& table, Shell& shell) {
    auto along = std::make_shared<ContinueCommand>();
    CLI::App* sub =
        table.add_subcommand("continue", "equilibria along weight, speed, voltage or an axis, with their folds");
    along->table.add_to(*sub);
    sub->add_option("--along", along->along, "net_weight=0:0.5, speed=0.2:1, pitch=-2deg:2deg, ...")->required();
    sub->add_option("--weight", along->weight, "net weight, positive sinks (default 0 N)");
    sub->add_option("--held", along->held, "values of the other axes");
    sub->add_option("--reference", along->reference,
                    "speed or voltage the table was made at (default: the table's own)");
    sub->add_option("--exponent", along->exponent, "force grows with this power of speed or voltage")
        ->capture_default_str();
    sub->add_option("--picture", along->picture, "writes the curve (.png, .pdf)");
    sub->footer(
        "Examples:\n  underbody table continue lift.csv --along net_weight=0:0.6 --picture folds.png\n  underbody "
        "table continue lift.csv --weight 0.3 --along speed=0.3:0.8 --reference 0.5");
    shell.on(sub, [&shell, along] { return run_continue(shell, *along); });
}

void add_pitch(CLI::App& table, Shell& shell) {
    auto pitch = std::make_shared<PitchCommand>();
    CLI::App* sub = table.add_subcommand(
        "pitch", "stable windows of pitch and their trim; with --weight, balance of heave and pitch together");
    pitch->table.add_to(*sub);
    sub->remove_option(sub->get_option("--quantity"));  // it is the pitch moment, and the lift beside it
    sub->add_option("--held", pitch->held, "values of the other axes, such as gap=5mm");
    auto* weight = sub->add_option("--weight", pitch->weight,
                                   "net weight: also finds the points where lift and pitch moment both balance; "
                                   "windows then only where --held gives the gap");
    sub->add_option("--trim", pitch->trim, "constant torque nose up beside the table's (default 0 N m)")->needs(weight);
    auto* mass = sub->add_option("--mass", pitch->mass,
                                 "virtual mass in heave, mass + added mass; with --inertia gives frequencies")
                     ->needs(weight);
    auto* inertia = sub->add_option("--inertia", pitch->inertia, "virtual inertia in pitch, such as \"0.02 kg m^2\"")
                        ->needs(weight);
    mass->needs(inertia);
    inertia->needs(mass);
    sub->add_option("--picture", pitch->picture,
                    "writes moment against pitch, or the lines of balance where there are no windows (.png, .pdf)");
    sub->footer(
        "Examples:\n"
        "  underbody table pitch forces.csv --where \"variant=ellipse, mesh=medium, speed=0.5\" --held gap=5mm\n"
        "  underbody table pitch forces.csv --where \"variant=ellipse, mesh=medium\" --held speed=0.5 --weight 0.3 "
        "--trim \"2 mN m\" --mass 3.954 --inertia 0.02");
    shell.on(sub, [&shell, pitch] { return run_pitch(shell, *pitch); });
}

void add_compare(CLI::App& table, Shell& shell) {
    auto compare = std::make_shared<CompareCommand>();
    CLI::App* sub = table.add_subcommand("compare", "variants of a table side by side, and which wins");
    compare->table.add_to(*sub);
    sub->add_option("--by", compare->by, "text column that names the variants")->capture_default_str();
    sub->add_option("--measure", compare->measure,
                    "lowest | highest (of the mean) | smallest | largest | restoring_slope | restoring_width (default: "
                    "restoring_slope of a lift along the gap and a moment along its "
                    "angle, lowest of a drag, else highest)");
    sub->add_option("--held", compare->held, "values of the other axes");
    sub->add_option("--picture", compare->picture, "writes the curves (.png, .pdf)");
    sub->footer(
        "Examples:\n  underbody table compare forces.csv --where \"mesh=medium, pitch=0, speed=0.5\" --quantity "
        "drag_force --measure lowest");
    shell.on(sub, [&shell, compare] { return run_compare(shell, *compare); });
}

void add_collapse(CLI::App& table, Shell& shell) {
    auto collapse = std::make_shared<CollapseCommand>();
    CLI::App* sub = table.add_subcommand(
        "collapse", "do forces at several speeds, sizes, jet voltages or flows fall on one curve?");
    collapse->table.add_to(*sub);
    sub->add_option("--by", collapse->by,
                    "speed | length | jet_voltage | jet_flow (default: the first of them that varies)");
    sub->add_option("--length", collapse->length,
                    "length of the body, for gap over length and C_L (default: the column length)");
    sub->add_option("--width", collapse->width, "width of the body, for C_L (default: the column width)");
    sub->add_option("--density", collapse->density, "density of the fluid (default 998 kg/m^3)");
    sub->add_option("--picture", collapse->picture, "writes the collapsed points over the curve (.png, .pdf)");
    sub->footer("Examples:\n  underbody table collapse forces.csv --where \"variant=ellipse, mesh=medium, pitch=0\"");
    shell.on(sub, [&shell, collapse] { return run_collapse(shell, *collapse); });
}

}  // namespace

void add_table_analysis(CLI::App& table, Shell& shell) {
    add_continue(table, shell);
    add_pitch(table, shell);
    add_compare(table, shell);
    add_collapse(table, shell);
}

}  // namespace underbody::studio
