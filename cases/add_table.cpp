#include "cases/add_table.h"

#include <algorithm>
#include <map>
#include <set>

#include "cases/gap_groups.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/file.h"
#include "core/mistyped.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::cases {

namespace {

/// Name of a condition and its different values, as people read them.
using Values = std::map<std::string, std::set<std::string>>;

Values values_of(const std::vector<Case>& cases, bool words) {
    Values values;
    for (const auto& one : cases) {
        for (const auto& [name, value] : one.conditions.numbers) {
            const std::string unit = one.conditions.shown_unit(name);
            if (!words) {
                values[name].insert(core::format_number(core::convert(value, one.conditions.unit(name), unit), 9) +
                                    " " + unit);
            }
        }
        for (const auto& [name, value] : one.conditions.texts) {
            if (words) {
                values[name].insert(value);
            }
        }
    }
    return values;
}

std::vector<std::string> several(const Values& values) {
    std::vector<std::string> names;
    for (const auto& [name, found] : values) {
        if (found.size() > 1) {
            names.push_back(name);
        }
    }
    return names;
}

std::string joined(const std::set<std::string>& values) {
    std::string text;
    std::size_t count = 0;
    for (const auto& value : values) {
        text += (text.empty() ? "" : ", ") + (count < 4 ? value : std::string());
        if (++count > 4) {
            return text + "...";
        }
    }
    return text;
}

std::vector<Case> cases_for(const Study& study, const NewTable& table) {
    std::vector<Case> cases = study.cases;
    if (cases.empty()) {
        throw core::InputError("missing", "the study has no cases that a table could be made of", {},
                               "cases come of CFD files");
    }
    const Values words = values_of(cases, true), numbers = values_of(cases, false);
    std::erase_if(cases, [&](const Case& one) { return !one.conditions.satisfies(table.where); });
    if (cases.empty()) {
        std::string there;
        for (const auto* values : {&words, &numbers}) {
            for (const auto& [name, found] : *values) {
                there += (there.empty() ? "" : "; ") + name + ": " + joined(found);
            }
        }
        throw core::UsageError("missing", "no case of the study has " + text_of(table.where), {}, "there are " + there);
    }
    return cases;
}

std::vector<std::string> axes_of(const std::vector<Case>& cases, const NewTable& table) {
    const Values numbers = values_of(cases, false), words = values_of(cases, true);
    std::vector<std::string> axes = table.axes;
    if (axes.empty()) {
        axes = several(numbers);
        std::stable_partition(axes.begin(), axes.end(), [](const std::string& name) { return name == "gap"; });
    }
    for (const auto& axis : axes) {
        const auto found = numbers.find(axis);
        if (found == numbers.end()) {
            std::vector<std::string> names;
            for (const auto& [name, values] : numbers) {
                names.push_back(name);
            }
            throw core::UsageError("name", "no case of the table has a number '" + axis + "'", {},
                                   core::did_you_mean(axis, names));
        }
        if (found->second.size() == 1) {
            throw core::UsageError("choice",
                                   "all " + core::counted(cases.size(), "case") + " of the table have " + axis + " " +
                                       *found->second.begin() + ", so it is no axis",
                                   {}, "leave it out, or take other cases");
        }
    }
    for (const auto* values : {&words, &numbers}) {
        for (const auto& name : several(*values)) {
            if (std::find(axes.begin(), axes.end(), name) == axes.end()) {
                throw core::UsageError(
                    "choice", "the cases of the table differ in " + name + " (" + joined(values->at(name)) + ")", {},
                    "hold one: " + name + "=" + *values->at(name).begin() +
                        (values == &numbers ? ", or make it an axis" : ""));
            }
        }
    }
    if (axes.empty()) {
        throw core::UsageError("missing",
                               "nothing varies among the " + core::counted(cases.size(), "case") + " of the table", {},
                               "a table needs cases of several gaps, pitches or speeds");
    }
    return axes;
}

std::string key_of(const std::string& name) {
    const bool bare = std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return (c < 128 && std::isalnum(c) != 0) || c == '_' || c == '-';
    });
    return bare ? name : core::toml_string(name);
}

std::string where_text(const Conditions& where) {
    std::string text;
    const auto add = [&](const std::string& name, const std::string& value) {
        text += (text.empty() ? "" : ", ") + key_of(name) + " = " + core::toml_string(value);
    };
    for (const auto& [name, value] : where.numbers) {
        add(name, written(value, where.unit(name)));
    }
    for (const auto& [name, value] : where.texts) {
        add(name, value);
    }
    return text.empty() ? "" : "where = { " + text + " }\n";
}

std::string list_text(const std::vector<std::string>& values) {
    std::string text;
    for (const auto& value : values) {
        text += (text.empty() ? "" : ", ") + core::toml_string(value);
    }
    return "[" + text + "]\n";
}

/// What is read only when the study is, or the table written.
void check_words(const NewTable& table) {
    for (const auto& [text, unit] : {std::pair(table.net_weight, "N"), std::pair(table.virtual_mass, "kg")}) {
        if (!text.empty()) {
            static_cast<void>(core::parse_in(text, unit));
        }
    }
    if (!table.net_weight.empty() && table.quantity != "lift_force" && core::find_quantity(table.quantity) != nullptr) {
        throw core::UsageError("quantity",
                               "a net weight is balanced by the lift, and this is a table of " + table.quantity, {},
                               "a table of lift_force, or no net weight");
    }
    std::vector<std::string> known;
    for (const auto& format : tables::export_formats()) {
        known.push_back(format.name);
    }
    for (const auto& format : table.exports) {
        if (std::find(known.begin(), known.end(), format) == known.end()) {
            throw core::UsageError("name", "there is no export format '" + format + "'", {},
                                   core::did_you_mean(format, known));
        }
    }
}

/// "pitch moment" of pitch_moment, "lift" of lift_force, "lift over gap and speed" where there is a "lift".
std::string name_of(const NewTable& table, const std::vector<std::string>& axes, const Study& study) {
    const auto taken = [&study](const std::string& name) { return study.find_table(name) != nullptr; };
    if (!table.name.empty()) {
        if (taken(table.name)) {
            throw core::UsageError("exists", "the study has a table '" + table.name + "' already", {},
                                   "give it another name");
        }
        return table.name;
    }
    std::string name =
        table.quantity.ends_with("_force") ? table.quantity.substr(0, table.quantity.size() - 6) : table.quantity;
    std::replace(name.begin(), name.end(), '_', ' ');
    std::string over = name;
    for (const auto& axis : axes) {
        over += (over.size() == name.size() ? " over " : " and ") + axis;
    }
    std::string free = taken(name) ? over : name;
    for (int i = 2; taken(free); ++i) {
        free = over + " " + std::to_string(i);
    }
    return free;
}

}  // namespace

PlannedTable plan_table(const Study& study, const NewTable& table) {
    check_words(table);
    const auto cases = cases_for(study, table);
    PlannedTable planned;
    planned.cases = cases.size();
    planned.axes = axes_of(cases, table);
    planned.name = name_of(table, planned.axes, study);
    return planned;
}

std::string lines_of(const NewTable& table, const PlannedTable& planned) {
    std::string text = "[[table]]\nname = " + core::toml_string(planned.name) +
                       "\nquantity = " + core::toml_string(table.quantity) + "\naxes = " + list_text(planned.axes);
    text += where_text(table.where);
    text += table.net_weight.empty() ? "" : "net_weight = " + core::toml_string(table.net_weight) + "\n";
    text += table.virtual_mass.empty() ? "" : "virtual_mass = " + core::toml_string(table.virtual_mass) + "\n";
    return text + (table.exports.empty() ? "" : "exports = " + list_text(table.exports));
}

NewTable proposed_table(const Study& study) {
    std::vector<const Conditions*> conditions;
    for (const auto& one : study.cases) {
        conditions.push_back(&one.conditions);
    }
    NewTable table;
    table.axes = {"gap"};
    table.where = held_by_fullest(gap_groups(conditions));
    return table;
}

AddedTable with_new_table(const std::filesystem::path& folder, const NewTable& table) {
    AddedTable added;
    added.file = folder / "study.toml";
    const std::string before = core::read_file(added.file);
    added.planned = plan_table(Study::from_text(before, added.file), table);
    added.text = before + (before.ends_with('\n') ? "\n" : "\n\n") + lines_of(table, added.planned);
    try {
        added.study = Study::from_text(added.text, added.file);
    } catch (const core::InputError& error) {  // in lines that nobody has seen yet
        throw core::UsageError(error.kind(), error.message() + "; nothing was added to " + added.file.string(), {},
                               error.hint());
    }
    return added;
}

void write_added(const AddedTable& added) {
    const core::ReplacingAllowed of_the_user;  // who asked for it
    core::write_file(added.file, added.text);
}

}  // namespace underbody::cases
