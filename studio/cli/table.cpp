// underbody table fit | at | equilibria (and what table_analysis.cpp adds)
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/cli/table_analysis.h"
#include "studio/cli/table_options.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/linear/model_equilibria.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/exact_points.h"
#include "surrogates/tables/fit/line.h"
#include "surrogates/tables/fit/table_batch.h"

namespace underbody::studio {

namespace {

using tables::ForceTable;

struct FitCommand {
    TableOptions table;
    std::string picture;
};

int run_fit(Shell& shell, const FitCommand& command) {
    const auto all = command.table.fit_all(shell, shell.json);  // as text they stand beside each table
    nlohmann::json document;
    document["tables"] = nlohmann::json::array();
    std::set<std::string> said;  // notes on the file, once for all its forces
    for (const auto& table : all) {
        nlohmann::json entry = table;
        std::string text =
            table.quantity() + ": " + table.kind() + " through " + core::counted(table.points().rows(), "point");
        for (const auto& axis : table.axes()) {
            text += "\n  " + axis.name + " " + shown(table, axis.name, axis.unit, axis.lower) + " to " +
                    shown(table, axis.name, axis.unit, axis.upper) + ", " +
                    core::counted(axis.points.size(), "set point");
        }
        if (!shell.json) {
            core::Problems warnings = table.remarks();
            std::erase_if(warnings,
                          [](const core::Problem& remark) { return remark.severity == core::Problem::Severity::note; });
            shell.show(warnings, true);
        }
        for (const auto& remark : table.remarks()) {
            if (!said.insert(remark.message).second) {
                continue;
            }
            text += (remark.severity == core::Problem::Severity::note ? "\n  " : "\n  warning: ") + remark.message;
        }
        if (const std::string unstated = tables::unstated_errors(table);
            !unstated.empty() && (!tables::says_exact(unstated) ||
                                  command.table.fit_options().kind != tables::FitOptions::Kind::automatic)) {
            text += "\n  " + unstated;  // that they are exact what chooses the fit says itself
        }
        shell.print(text);
        document["tables"].push_back(entry);
    }
    command.table.describe(document);
    if (!command.picture.empty()) {
        write_picture(tables::figure(all.front()), command.picture);
        document["picture"] = command.picture;
    }
    if (shell.json) {
        shell.print_json(document);
    }
    return done;
}

struct AtCommand {
    TableOptions table;
    std::vector<std::string> points;
};

/// What was chosen for an axis that nobody gave stands beside the numbers.
void say_choices(Shell& shell, const core::Problems& remarks) {
    for (const core::Problem& remark : remarks) {
        if (remark.severity == core::Problem::Severity::note) {
            shell.print(remark.message);
        }
    }
}

/// Prints a force at a point; the same as JSON.
nlohmann::json value_at(Shell& shell, const ForceTable& table, const tables::Held& asked, std::set<std::string>& said) {
    core::Problems remarks;
    const auto point = tables::held_point(table, {}, asked, &remarks);
    const auto e = table.at(point);
    tables::Held named;
    for (std::size_t k = 0; k < point.size(); ++k) {
        named.emplace_back(table.axes()[k].name, point[k]);
    }
    for (auto& remark : tables::outside_remarks(table, named)) {
        remarks.push_back(std::move(remark));
    }
    std::erase_if(remarks, [&](const core::Problem& remark) { return !said.insert(remark.message).second; });
    shell.show(remarks);
    say_choices(shell, remarks);
    std::string line = table.quantity() + " " + shown(table, table.quantity(), table.unit(), e.value, 7);
    if (e.sigma > 0) {
        line += " +- " + shown(table, table.quantity(), table.unit(), e.sigma, 3);
    }
    for (std::size_t k = 0; k < point.size(); ++k) {
        const auto& axis = table.axes()[k];
        const std::string unit = tables::unit_per(table.unit(), axis.unit);
        line += (k == 0 ? "   slope " : ", ") + core::told(e.slope[k], unit) + " along " + axis.name;
    }
    if (e.outside) {
        line += "   outside the table";
    } else if (e.no_data) {
        line += "   no points around";
    }
    if (const double beyond = tables::beyond_points(table, point.data()); beyond > 0 && e.no_data) {
        shell.show(
            {{core::Problem::Severity::warning,
              "no points of " + table.quantity() + " lie around this place (" + core::format_number(100 * beyond, 2) +
                  " % of the axes' ranges outside them): the value is an extrapolation, its error says how far to "
                  "trust "
                  "it",
              {}}});
    }
    shell.print(line);
    nlohmann::json json = tables::to_json(table, point, e);
    for (const auto& axis : table.axes()) {
        json["slope_unit"][axis.name] = tables::unit_per(table.unit(), axis.unit);
    }
    return json;
}

int run_at(Shell& shell, const AtCommand& command) {
    shell.all_or_nothing = true;  // no number before an error of a later point
    nlohmann::json document;
    document["values"] = nlohmann::json::array();
    std::set<std::string> said;  // of a point once, not for every force
    std::vector<ForceTable> of_all =
        command.table.is_model() ? std::vector<ForceTable>{} : command.table.fit_all(shell);
    const std::size_t passes = command.table.is_model() ? command.points.size() : 1;
    std::vector<std::vector<nlohmann::json>> values;  // by force, then by point
    for (std::size_t pass = 0; pass < passes; ++pass) {
        // The forces of a model are taken anew at what each point holds beside their axes.
        tables::Held asked = command.table.is_model() ? read_assignments(command.points[pass]) : tables::Held{};
        if (command.table.is_model()) {
            of_all = command.table.fit_all(shell, true, &asked);
        }
        values.resize(of_all.size());
        for (std::size_t t = 0; t < of_all.size(); ++t) {
            for (std::size_t i = 0; i < (command.table.is_model() ? 1 : command.points.size()); ++i) {
                const tables::Held point = command.table.is_model() ? asked : read_assignments(command.points[i]);
                values[t].push_back(value_at(shell, of_all[t], point, said));
            }
        }
    }
    for (const auto& of_one : values) {
        for (const auto& value : of_one) {
            document["values"].push_back(value);
        }
    }
    command.table.describe(document);
    // One value lies at the top too: the usual question has one answer.
    for (const auto& [key, value] : document["values"][0].items()) {
        document[key] = value;
    }
    if (shell.json) {
        shell.print_json(document);
    }
    return done;
}

struct EquilibriaCommand {
    TableOptions table;
    std::string weight, mass, damping, held, picture;
    double scale = 1;
    int draws = tables::usual_draws;
};

/// The kick from which a vehicle that comes back leaves the table on its way; 0 where none does.
double leaving_velocity(const tables::Equilibrium& e) {
    if (e.limited_by_range || e.up_to_end == e.down_to_end) {
        return 0;
    }
    const double to_end = e.up_to_end ? e.kick_velocity_up : e.kick_velocity_down;
    return to_end < e.kick_velocity ? to_end : 0;
}

std::string described(const ForceTable& table, const tables::Equilibria& found, const tables::Equilibrium& e) {
    std::string text = tables::to_string(e.stability) + " at " + shown(table, found.axis, found.axis_unit, e.gap, 6);
    if (e.sigma > 1e-9 * (found.upper - found.lower) && std::isfinite(e.sigma)) {
        text += " +- " + shown(table, found.axis, found.axis_unit, e.sigma, 2);
    }
    if (e.extent > 0) {
        text += ", balanced over " + shown(table, found.axis, found.axis_unit, e.extent, 4);
    }
    const auto with_error = [](double value, int digits, const std::optional<double>& sigma) {
        return core::format_number(value, digits) +
               (sigma.value_or(0) > 0 ? " +- " + core::format_number(*sigma, 2) : "");
    };
    text += "   stiffness " + with_error(e.stiffness, 5, e.stiffness_sigma) + " N/m";
    if (e.frequency > 0) {
        text += ", " + with_error(e.frequency, 4, e.frequency_sigma) + " Hz";
    }
    if (e.damping_ratio != 0) {
        text += ", damping ratio " + core::format_number(e.damping_ratio, 3);
    }
    if (e.stability == tables::Stability::stable) {
        text += ", survives a push of " + shown(table, found.axis, found.axis_unit, e.kick_gap, 4);
        const double to_end = (e.up_to_end ? found.upper : found.lower) - e.gap;
        const bool push_to_end = (e.up_to_end || e.down_to_end) && e.kick_gap >= (1 - 1e-9) * std::abs(to_end);
        text += push_to_end ? " (the end of the table)" : "";
        if (e.kick_velocity > 0) {
            text += " or a kick of " + core::format_number(e.kick_velocity, 4) + " m/s";
        }
        if (const double leaves = leaving_velocity(e); leaves > 0) {
            text += " (from " + core::format_number(leaves, 4) + " m/s " + (e.up_to_end ? "up" : "down") +
                    "ward it leaves the table)";
        }
        text += ", barrier " + core::format_number(e.barrier, 4) + " J";
        text += e.limited_by_range ? " (to the end of the table)" : "";
    }
    if (e.doubtful()) {
        text += ", exists with probability " + core::format_number(*e.probability, 2);
    }
    return text;
}

/// What is drawn as the curve whose zeros the equilibria are.
struct Balance {
    tables::Equilibria found;
    ForceTable table;
    tables::EquilibriumOptions options;
    std::vector<double> masses;  ///< kg, at each equilibrium, where they are not one
};

/// Of a model: the whole vehicle at rest. Says its weight and mass where the command does not.
Balance balance_of_model(Shell& shell, const dynamics::Model& model, const EquilibriaCommand& command,
                         const tables::EquilibriumOptions& asked) {
    dynamics::BalanceOptions options;
    options.held = command.table.conditions();
    for (const auto& [name, value] : asked.held) {
        options.held.set(name, value);
    }
    if (!command.weight.empty()) {
        options.net_weight = asked.net_weight;
    }
    if (!command.mass.empty()) {
        options.virtual_mass = asked.virtual_mass;
    }
    if (!command.damping.empty()) {
        options.damping = asked.damping;
    }
    options.scale = asked.scale;
    options.draws = asked.draws;
    auto of_model = dynamics::model_equilibria(model, options, shell.progress());
    std::string text = command.weight.empty() ? "net weight " + core::told(of_model.net_weight, "N") : "";
    if (command.mass.empty()) {
        text += std::string(text.empty() ? "" : ", ") + "virtual mass " +
                (of_model.one_mass() ? core::told(of_model.found.virtual_mass, "kg") : "by the gap");
    }
    if (!text.empty()) {
        shell.print("of the model: " + text);
    }
    Balance balance{std::move(of_model.found), std::move(of_model.at_rest), asked, {}};
    if (!of_model.one_mass()) {
        balance.masses = std::move(of_model.virtual_mass);
    }
    balance.options.net_weight = of_model.net_weight;
    balance.options.scale = 1;  // the force at rest is scaled already
    balance.options.held.clear();
    return balance;
}

/// What the tables of a model have beside the gap; throws where that is not said, or is no axis.
void hold_axes(tables::Equilibria& found, const ForceTable& table, const tables::Held& asked) {
    tables::require_lift(table);
    const std::size_t gap = tables::axis_index(table, found.axis);
    const auto point = tables::held_point(table, gap, asked, &found.remarks);
    for (std::size_t k = 0; k < point.size(); ++k) {
        if (k != gap) {
            found.held.emplace_back(table.axes()[k].name, point[k]);
        }
    }
    for (auto& remark : tables::outside_remarks(table, found.held)) {
        found.remarks.push_back(std::move(remark));
    }
}

/// What nobody says of a body at rest: no heave velocity, and what scales a force at its reference.
void complete_at_rest(const dynamics::Model& model, const ForceTable& table, tables::Held& asked,
                      core::Problems& remarks) {
    dynamics::Conditions known = model.conditions.over(dynamics::references_of(model));
    known[dynamics::Channel::heave_velocity] = known[dynamics::Channel::pitch_rate] = 0;
    for (const auto& axis : table.axes()) {
        dynamics::Channel channel{};
        const bool said =
            std::any_of(asked.begin(), asked.end(), [&](const auto& one) { return one.first == axis.name; });
        if (!said && axis.name != "gap" && dynamics::find_channel(axis.name, channel) && known.has(channel)) {
            asked.emplace_back(axis.name, known[channel]);
            remarks.push_back(
                {core::Problem::Severity::note,
                 axis.name + " is not given: " + core::told_condition(axis.name, known[channel]) +
                     (known[channel] == 0 ? " is taken, at rest" : " is taken, the reference of its scale"),
                 {model.name, {}, {}, {}}});
        }
    }
}

nlohmann::json equilibria_json(const Balance& balance, const nlohmann::json& of_model) {
    nlohmann::json document = balance.found;
    for (std::size_t i = 0; i < balance.masses.size(); ++i) {
        document["equilibria"][i]["virtual_mass"] = balance.masses[i];
    }
    if (!balance.masses.empty()) {
        document["virtual_mass"] = nullptr;  // not one
    }
    for (const auto& [key, value] : of_model.items()) {
        document[key == "held" ? "model_conditions" : key] = value;  // "held" has the other axes of the table
    }
    return document;
}

int run_equilibria(Shell& shell, const EquilibriaCommand& command) {
    tables::EquilibriumOptions options;
    options.held = read_assignments(command.held);
    options.net_weight = command.weight.empty() ? 0 : option_value("--weight", command.weight, "N");
    options.virtual_mass = command.mass.empty() ? 0 : option_value("--mass", command.mass, "kg");
    options.damping = command.damping.empty() ? 0 : option_value("--damping", command.damping, "N s/m");
    options.scale = command.scale;
    options.draws = command.draws;
    const bool is_model = command.table.is_model();
    TableOptions of_table = command.table;
    of_table.at_rest = is_model;
    tables::Held asked = options.held;
    const auto table = of_table.fit(shell, is_model ? &asked : nullptr);
    const std::optional<dynamics::Model> model =
        is_model ? std::optional(dynamics::read_model(command.table.file)) : std::nullopt;
    Balance balance = is_model ? balance_of_model(shell, *model, command, options)
                               : Balance{tables::equilibria(table, options), table, options, {}};
    tables::Equilibria& found = balance.found;
    if (is_model) {
        complete_at_rest(*model, table, asked, found.remarks);
        hold_axes(found, table, asked);
    }
    shell.show(found.remarks);
    say_choices(shell, found.remarks);
    for (std::size_t i = 0; i < found.all.size(); ++i) {
        shell.print(described(table, found, found.all[i]) +
                    (balance.masses.empty() ? "" : ", virtual mass " + core::told(balance.masses[i], "kg", 4)));
    }
    if (found.all.empty()) {
        shell.print("no equilibrium: the net force is " + core::format_number(found.force_at_lower, 4) + " N at " +
                    shown(table, found.axis, found.axis_unit, found.lower) + " and " +
                    core::format_number(found.force_at_upper, 4) + " N at " +
                    shown(table, found.axis, found.axis_unit, found.upper) +
                    (is_model || !command.weight.empty() ? "" : "; a net weight of 0 N was taken (--weight)"));
    }
    nlohmann::json of_model = nlohmann::json::object();
    of_table.describe(of_model);
    if (is_model) {
        of_model["net_weight_from"] = command.weight.empty() ? "model" : "given";
    }
    nlohmann::json document = equilibria_json(balance, of_model);
    if (!command.picture.empty()) {
        tables::FigureOptions figure;
        figure.axis = found.axis;
        figure.held = is_model ? tables::Held{} : found.held;
        figure.equilibria = balance.options;
        write_picture(tables::curve_figure(balance.table, figure), command.picture);
        document["picture"] = command.picture;
    }
    if (shell.json) {
        shell.print_json(document);
    }
    return done;
}

void add_equilibria(CLI::App* table, Shell& shell) {
    auto eq = std::make_shared<EquilibriaCommand>();
    CLI::App* eq_command = table->add_subcommand("equilibria", "where lift and net weight balance, and how firmly");
    eq->table.add_to(*eq_command);
    eq_command->add_option("--weight", eq->weight,
                           "net weight: weight less buoyancy, positive sinks (default 0 N, of a model its own)");
    eq_command->add_option(
        "--mass", eq->mass,
        "virtual mass in heave, mass + added mass; gives frequency and kick velocity (of a model its "
        "own)");
    eq_command->add_option("--damping", eq->damping,
                           "linear damping in heave, such as \"0.4 N s/m\" (of a model its own)");
    eq_command->add_option("--held", eq->held, "values of the other axes, such as pitch=1deg,speed=0.5");
    eq_command->add_option("--scale", eq->scale, "factor on the table's force, such as (speed/reference)^2");
    eq_command->add_option("--draws", eq->draws, "tables drawn from the error for the probabilities")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    eq_command->add_option("--picture", eq->picture, "writes the curve with its equilibria (.png, .pdf)");
    eq_command->footer(
        "Examples:\n"
        "  underbody table equilibria lift.csv --weight 0.3 --mass 3.954\n"
        "  underbody table equilibria loads.csv --weight \"30 gf\" --held pitch=1deg --picture eq.png");
    shell.on(eq_command, [&shell, eq] { return run_equilibria(shell, *eq); });
}

}  // namespace

void add_table_command(CLI::App& app, Shell& shell) {
    CLI::App* table = app.add_subcommand("table", "force tables: fit, values and slopes, equilibria");
    table->require_subcommand(1);
    table->footer(
        "Examples:\n"
        "  underbody table fit lift.csv --picture lift.png\n"
        "  underbody table at lift.csv gap=5mm,pitch=1deg\n"
        "  underbody table equilibria lift.csv --weight \"0.3 N\" --mass \"3.954 kg\"");

    auto fit = std::make_shared<FitCommand>();
    CLI::App* fit_command = table->add_subcommand("fit", "fits every force of the table and says how");
    fit->table.add_to(*fit_command);
    fit_command->add_option("--picture", fit->picture, "writes the table as a picture (.png, .pdf)");
    fit_command->footer(
        "Examples:\n"
        "  underbody table fit forces.csv --where \"variant=ellipse, mesh=medium, speed=0.5\" --axes gap,pitch\n"
        "  underbody table fit lift.csv --kind spline --picture lift.png");
    shell.on(fit_command, [&shell, fit] { return run_fit(shell, *fit); });

    auto at = std::make_shared<AtCommand>();
    CLI::App* at_command = table->add_subcommand("at", "values, slopes and errors at points");
    at->table.add_to(*at_command);
    at_command->add_option("points", at->points, "gap=5mm,pitch=1deg (a bare number is SI)")->required()->expected(-1);
    at_command->footer(
        "Examples:\n  underbody table at lift.csv gap=5mm\n  underbody table at loads.csv gap=5mm,pitch=2deg "
        "gap=8mm,pitch=2deg --json");
    shell.on(at_command, [&shell, at] { return run_at(shell, *at); });

    add_equilibria(table, shell);

    add_table_analysis(*table, shell);
}

}  // namespace underbody::studio
