#include "studio/cli/table_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/caller.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/linear/model_equilibria.h"
#include "surrogates/dynamics/model/force_points.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/exact_points.h"
#include "surrogates/tables/points/select.h"

namespace underbody::studio {

void TableOptions::add_to(CLI::App& command) {
    command
        .add_option(
            "table", file,
            "points as CSV: gap [mm], pitch [deg], ..., lift_force [N], lift_force_sigma [N], ...; or a JSON that "
            "'export' wrote; or a model.toml: its forces as it simulates them, with the effects that change them")
        ->required();
    command.add_option("--quantity", quantity,
                       "column to use (default: lift_force, or the first force of the table; of fit and at all "
                       "forces); export, fit, at: several, lift_force,pitch_moment, or all");
    command.add_option("--where", where,
                       "rows to use, such as \"variant=ellipse, mesh=medium, speed=0.5\"; a|b takes either; of a "
                       "model: what is held, such as speed=0.5m/s");
    command.add_option("--axes", axes,
                       "columns that are axes, such as gap,pitch (default: all known ones that vary); of a model also "
                       "what scales its forces: gap,pitch,speed=0:0.8,jet_voltage=0:12V");
    command.add_option("--kind", kind, "automatic | interpolation | gaussian_process | spline (auto, gp for short)")
        ->capture_default_str();
    command.add_option("--range", range,
                       "outside the points: clamp | refuse | extrapolate, for all axes or one by one: "
                       "gap=refuse,pitch=clamp (default clamp, or what an exported table says)");
}

tables::FitOptions TableOptions::fit_options() const {
    tables::FitOptions options;
    const auto known = tables::fit_kind(kind);
    if (!known) {
        throw core::UsageError("kind", "there is no kind of table '" + kind + "'", {},
                               core::did_you_mean(kind, tables::fit_kinds()));
    }
    options.kind = *known;
    options.range = tables::parse_range_policies(range);
    for (const auto name : core::split(axes, ',')) {
        if (!core::trimmed(name).empty()) {
            options.axes.emplace_back(core::trimmed(name));
        }
    }
    return options;
}

namespace {

std::vector<std::string> names_of(const std::string& list) {
    std::vector<std::string> names;
    for (const auto name : core::split(list, ',')) {
        if (core::trimmed(name).empty()) {
            continue;
        }
        if (std::find(names.begin(), names.end(), core::trimmed(name)) != names.end()) {
            throw core::UsageError("parse", "'" + std::string(core::trimmed(name)) + "' is named twice: " + list);
        }
        names.emplace_back(core::trimmed(name));
    }
    return names;
}

std::vector<std::string> quantities_of(const core::Table& table, const std::string& asked) {
    std::vector<std::string> names = names_of(asked);
    if (names.empty() || names.front() == "all") {
        names = tables::force_columns(table);
    }
    if (names.empty()) {
        throw core::InputError("missing", "the table has no force and no other column to fit",
                               {table.source, {}, {}, {}},
                               "a force column is named lift_force [N], drag_force [N], pitch_moment [N m], ...");
    }
    return names;
}

dynamics::Conditions held_of(const std::string& where) {
    dynamics::Conditions held;
    for (const auto& [name, value] : read_assignments(where)) {
        held.set(name, value);
    }
    return held;
}

/// Values that go with a request: of an axis of the model's tables they are asked later, others are held.
/// Returns those.
tables::Held take_asked(const dynamics::Model& model, tables::Held& asked, dynamics::ForceTablesOptions& options) {
    tables::Held held;
    std::erase_if(asked, [&](const std::pair<std::string, double>& value) {
        dynamics::Channel channel{};
        if (!dynamics::find_channel(value.first, channel)) {
            return false;  // refused by name where it is used
        }
        const auto has_axis = [&](const tables::ForceTable& table) {
            return std::any_of(table.axes().begin(), table.axes().end(),
                               [&](const tables::TableAxis& axis) { return axis.name == value.first; });
        };
        const bool of_a_force = std::any_of(model.forces.begin(), model.forces.end(),
                                            [&](const dynamics::ForceSource& one) { return has_axis(one.table); });
        const bool of_a_correction =
            std::any_of(model.effects.begin(), model.effects.end(),
                        [&](const dynamics::EffectUse& use) { return use.table && has_axis(*use.table); });
        if (of_a_force || of_a_correction ||
            std::any_of(options.axes.begin(), options.axes.end(),
                        [&](const auto& axis) { return axis.name == value.first; })) {
            options.asked.push_back(channel);
            return false;
        }
        options.held[channel] = value.second;
        held.push_back(value);
        return true;
    });
    return held;
}

/// "gap,pitch,speed=0:0.8,jet_voltage=0:12V"
std::vector<dynamics::ForceAxis> axes_of(const std::string& text) {
    std::vector<dynamics::ForceAxis> axes;
    for (const std::string& part : names_of(text)) {
        const std::size_t equals = part.find('=');
        dynamics::ForceAxis axis{std::string(core::trimmed(part.substr(0, equals))), {}, {}};
        if (equals != std::string::npos) {
            const std::size_t colon = part.find(':', equals);
            dynamics::Channel channel{};
            if (colon == std::string::npos) {
                throw core::UsageError("parse", "'" + part + "' is not of the form NAME=LOWER:UPPER", {},
                                       "such as --axes gap,speed=0:0.8");
            }
            if (dynamics::find_channel(axis.name, channel)) {
                axis.lower = option_value("--axes", part.substr(equals + 1, colon - equals - 1),
                                          dynamics::channel_unit(channel));
                axis.upper = option_value("--axes", part.substr(colon + 1), dynamics::channel_unit(channel));
            }
        }
        axes.push_back(std::move(axis));
    }
    return axes;
}

/// Keeps what is no note for the document.
void keep(const core::Problems& remarks, core::Problems& warnings) {
    for (const core::Problem& remark : remarks) {
        const bool known = std::any_of(warnings.begin(), warnings.end(),
                                       [&](const core::Problem& one) { return one.message == remark.message; });
        if (!known && remark.severity != core::Problem::Severity::note) {
            warnings.push_back(remark);
        }
    }
}

/// Says them and keeps them.
void tell(Shell& shell, const core::Problems& remarks, core::Problems& warnings) {
    shell.show(remarks);
    keep(remarks, warnings);
}

}  // namespace

core::Table TableOptions::points(Shell& shell) const {
    if (!is_model()) {
        return tables::selected_rows(tables::read_points(file), where);
    }
    auto found = dynamics::force_points(dynamics::read_model(file), conditions());
    shell.show(found.remarks);
    return std::move(found.points);
}

const std::vector<tables::ForceTable>* TableOptions::fitted(const Shell& shell) const {
    if (shell.caller() == nullptr) {
        return nullptr;
    }
    const auto known = shell.caller()->fitted.find(file);
    const bool same =
        known != shell.caller()->fitted.end() && (quantity.empty() || quantity == known->second.front().quantity());
    return same ? &known->second : nullptr;
}

dynamics::Conditions TableOptions::conditions() const { return held_of(where); }

bool TableOptions::is_model() const { return std::filesystem::path(file).extension() == ".toml"; }

std::vector<tables::ForceTable> TableOptions::of_model(Shell& shell, bool one, bool remarks,
                                                       tables::Held* asked) const {
    if (kind != "automatic" && kind != "auto") {
        throw core::UsageError(
            "kind", "the forces of a model are taken as it simulates them: --kind " + kind + " is for points", {},
            "leave it out, or say 'fit' at the force in the model");
    }
    const dynamics::Model model =
        at_rest ? dynamics::with_effects_on_forces(dynamics::read_model(file)) : dynamics::read_model(file);
    dynamics::ForceTablesOptions options;
    options.held = conditions();
    options.axes = axes_of(axes);
    const tables::Held given = asked != nullptr ? take_asked(model, *asked, options) : tables::Held{};
    if (dynamics::Channel free{}; dynamics::find_channel(free_axis, free)) {
        options.asked.push_back(free);
    }
    options.quantities = names_of(quantity);
    options.range = tables::parse_range_policies(range);
    if (options.quantities.empty() || options.quantities.front() == "all") {
        options.quantities = model.quantities();
    }
    if (one && options.quantities.size() > 1) {
        options.quantities.resize(1);
    }
    auto found = dynamics::force_tables(model, options, shell.progress());
    shell.show(found.remarks);
    held_ = found.held;
    for (const auto& [name, value] : given) {
        if (std::none_of(held_.begin(), held_.end(), [&, wanted = name](const dynamics::HeldChannel& one_held) {
                return channel_name(one_held.channel) == wanted;
            })) {
            throw core::UsageError("axis", "no force of the model depends on " + name, {file, {}, {}, {}},
                                   "leave it out");
        }
    }
    dynamics::Conditions held;
    std::string text;
    for (const dynamics::HeldChannel& one_held : held_) {
        held[one_held.channel] = one_held.value;
        text += (text.empty() ? "the model's forces at " : ", ") +
                core::told_condition(channel_name(one_held.channel), one_held.value) + " (" + one_held.from + ")";
    }
    warnings_ = dynamics::held_outside(model, held);
    keep(dynamics::held_in_vain(model, conditions()), warnings_);
    keep(dynamics::gaps_of_another_size(model), warnings_);
    if (text != said_) {
        said_ = text;
        if (!text.empty()) {
            print_held ? shell.print(text) : shell.info(text);
        }
    }
    shell.show(warnings_);
    for (const auto& table : found.tables) {
        if (remarks) {
            tell(shell, table.remarks(), warnings_);
        }
    }
    return std::move(found.tables);
}

void TableOptions::describe(nlohmann::json& document) const {
    if (is_model()) {
        document["held"] = nlohmann::json::object();
    }
    for (const dynamics::HeldChannel& held : held_) {
        document["held"][channel_name(held.channel)] = {
            {"value", held.value}, {"unit", channel_unit(held.channel)}, {"from", held.from}};
    }
    if (!is_model()) {
        document["points_exact"] = exact_;
        document["points_scatter"] = scatter_ > 0 ? nlohmann::json(scatter_) : nlohmann::json(nullptr);
    }
    document["warnings"] = nlohmann::json::array();
    for (const core::Problem& problem : warnings_) {
        document["warnings"].push_back(problem.message);
    }
}

void TableOptions::say_unstated(Shell& shell, const tables::ForceTable& table) const {
    scatter_ = std::max(scatter_, table.point_scatter());
    if (const std::string text = tables::unstated_errors(table); !text.empty()) {
        exact_ = exact_ || tables::says_exact(text);
        print_held ? shell.print(text) : shell.info(text);
    }
}

tables::ForceTable TableOptions::fit(Shell& shell, tables::Held* asked) const {
    if (const auto* known = fitted(shell)) {  // its remarks were said when it was fitted
        keep(known->front().remarks(), warnings_);
        say_unstated(shell, known->front());
        return known->front();
    }
    if (is_model()) {
        return of_model(shell, true, true, asked).front();
    }
    const auto table = points(shell);
    auto fitted = tables::ForceTable::fit(table, quantities_of(table, quantity).front(), fit_options());
    tell(shell, fitted.remarks(), warnings_);
    say_unstated(shell, fitted);
    return fitted;
}

std::vector<tables::ForceTable> TableOptions::fit_all(Shell& shell, bool remarks, tables::Held* asked) const {
    if (const auto* known = fitted(shell)) {
        for (const auto& table : *known) {
            if (remarks) {
                keep(table.remarks(), warnings_);
                say_unstated(shell, table);
            }
        }
        return *known;
    }
    if (is_model()) {
        return of_model(shell, false, remarks, asked);
    }
    const auto table = points(shell);
    std::vector<tables::ForceTable> all;
    for (const auto& name : quantities_of(table, quantity)) {
        all.push_back(tables::ForceTable::fit(table, name, fit_options()));
        if (remarks) {
            tell(shell, all.back().remarks(), warnings_);
            say_unstated(shell, all.back());
        }
    }
    return all;
}

std::string shown(const tables::ForceTable& table, const std::string& quantity, const std::string& si, double value,
                  int digits) {
    const std::string unit = tables::shown_unit(table, quantity);
    return unit == si ? core::told(value, si, digits)
                      : core::format_number(core::convert(value, si, unit), digits) + " " + unit;
}

std::vector<std::pair<std::string, double>> read_assignments(const std::string& text) {
    std::vector<std::pair<std::string, double>> values;
    if (core::trimmed(text).empty()) {
        return values;
    }
    for (const auto& v : core::parse_assignments(text)) {
        values.emplace_back(v.name, v.value);
    }
    return values;
}

}  // namespace underbody::studio
