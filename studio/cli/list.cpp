// underbody list WHAT: the names that files, options and JSON share, from the registries themselves.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cases/file_templates.h"
#include "core/file_format.h"
#include "core/units.h"
#include "postproc/field/lists.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/model/effect.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

namespace lists {

/// What every list has: a name, a unit (may be empty), what it means; `more` goes into the JSON only.
struct Row {
    std::string name, unit, meaning;
    nlohmann::json more = nlohmann::json::object();
};
using Rows = std::vector<Row>;

Rows quantities() {
    Rows rows;
    for (const auto& quantity : core::quantity_names()) {
        rows.push_back({quantity.name, quantity.unit, quantity.meaning});
    }
    return rows;
}

std::string seen_in(dynamics::SeenIn where) {
    return where == dynamics::SeenIn::both ? "both" : where == dynamics::SeenIn::static_set ? "static" : "time_series";
}

/// An effect, and below it its parameters.
Rows effects() {
    Rows rows;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        nlohmann::json parameters = nlohmann::json::array();
        Rows below;
        for (const auto& parameter : info.parameters) {
            const std::string unit = parameter.unit == "parameter" ? "" : parameter.unit;
            parameters.push_back({{"name", parameter.name},
                                  {"unit", unit},
                                  {"meaning", parameter.meaning},
                                  {"may_be_left_out", parameter.shape}});
            below.push_back({"  " + parameter.name, unit, parameter.meaning, nullptr});
        }
        rows.push_back({info.name,
                        "",
                        info.title + " (seen in " + seen_in(info.seen_in) + ")",
                        {{"formula", info.formula},
                         {"seen_in", seen_in(info.seen_in)},
                         {"depends_on", info.depends_on},
                         {"parameters", parameters},
                         {"source", info.source}}});
        rows.insert(rows.end(), below.begin(), below.end());
    }
    return rows;
}

Rows views() {
    Rows rows;
    for (const auto& kind : postproc::view_kinds()) {
        rows.push_back({kind.name, kind.unit, kind.meaning});
    }
    return rows;
}

Rows formats() {
    Rows rows;
    for (const auto& format : postproc::cfd_formats()) {
        rows.push_back({format.name, "", format.files});
    }
    return rows;
}

Rows exports() {
    Rows rows;
    for (const auto& format : tables::export_formats()) {
        rows.push_back({format.name, "", format.description, {{"ending", format.ending}}});
    }
    return rows;
}

/// The keys of a file that the user writes; the tables are rows of their own, in brackets.
Rows keys(const core::FileFormat& format) {
    Rows rows;
    for (const core::FileTable& table : format.tables) {
        if (!table.path.empty()) {
            rows.push_back({core::heading_of(table.path), "", table.meaning, nullptr});
        }
        for (const core::FileKey& key : table.keys) {
            const std::string standing = key.required()            ? "required"
                                         : !key.instead_of.empty() ? "in place of " + key.instead_of
                                         : key.fallback.empty()    ? ""
                                                                   : "default " + key.fallback;
            rows.push_back({key.name == "*" ? "(any)" : key.name,
                            key.kind,
                            key.meaning + (standing.empty() ? "" : "; " + standing),
                            {{"table", table.path},
                             {"required", key.required()},
                             {"default", key.fallback},
                             {"in_place_of", key.instead_of},
                             {"example", key.example}}});
        }
    }
    return rows;
}

void show(Shell& shell, const std::string& what, const Rows& rows) {
    nlohmann::json list = nlohmann::json::array();
    std::size_t name_width = 0, unit_width = 0;
    for (const Row& row : rows) {
        name_width = std::max(name_width, row.name.size());
        unit_width = std::max(unit_width, std::min<std::size_t>(row.unit.size(), 20));
        if (!row.more.is_null()) {  // a row for people only
            nlohmann::json entry = {{"name", row.name}, {"unit", row.unit}, {"meaning", row.meaning}};
            entry.update(row.more);
            list.push_back(std::move(entry));
        }
    }
    if (shell.json) {
        shell.print_json({{what, list}});
        return;
    }
    std::string text;
    for (const Row& row : rows) {
        text += row.name + std::string(name_width - row.name.size() + 2, ' ') + row.unit +
                (row.unit.size() < unit_width ? std::string(unit_width - row.unit.size(), ' ') : "") +
                (unit_width > 0 ? "  " : "") + row.meaning + "\n";
    }
    shell.print(text);
}

void add_list(CLI::App& command, Shell& shell, const std::string& what, const std::string& help, Rows (*rows)()) {
    auto* sub = command.add_subcommand(what, help);
    shell.on(sub, [&shell, what, rows] {
        show(shell, what, rows());
        return static_cast<int>(done);
    });
}

}  // namespace lists

void add_list_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand(
        "list", "names with their units and meaning: quantities, effects, views, formats, exports, keys of files");
    command->require_subcommand(1);
    command->footer(
        "Examples:\n"
        "  underbody list quantities            names of columns and conditions, with units and signs\n"
        "  underbody list effects --json        what a model may lack, with formula and parameters\n"
        "  underbody list keys study            every key of study.toml with unit and default\n"
        "  underbody new study                  the same as a file to begin with");
    lists::add_list(*command, shell, "quantities", "names of quantities in files, options and JSON", lists::quantities);
    lists::add_list(*command, shell, "effects", "effects that a model may have or lack, with their parameters",
                    lists::effects);
    lists::add_list(*command, shell, "views", "pictures of a field", lists::views);
    lists::add_list(*command, shell, "formats", "CFD files that are read", lists::formats);
    lists::add_list(*command, shell, "exports", "formats of force tables for controllers", lists::exports);
    auto* sub = command->add_subcommand("keys", "keys of a file that you write: shape, study, model, dataset");
    auto format = std::make_shared<std::string>();
    sub->add_option("format", *format, "shape, study, model or dataset")->required();
    shell.on(sub, [&shell, format] {
        lists::show(shell, "keys", lists::keys(cases::file_format(*format)));
        return static_cast<int>(done);
    });
}

}  // namespace underbody::studio
