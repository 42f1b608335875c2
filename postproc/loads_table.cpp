#include "postproc/loads_table.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/units.h"

namespace underbody::postproc {

namespace {

/// Names in the order in which they first occur.
template <typename Get>
std::vector<std::string> names_in(const std::vector<LoadsCase>& cases, Get get) {
    std::vector<std::string> names;
    for (const auto& one : cases) {
        for (const auto& entry : get(one)) {
            if (std::find(names.begin(), names.end(), entry.first) == names.end()) {
                names.push_back(entry.first);
            }
        }
    }
    return names;
}

template <typename T>
T value_of(const std::vector<std::pair<std::string, T>>& list, const std::string& name, T fallback) {
    for (const auto& [key, value] : list) {
        if (key == name) {
            return value;
        }
    }
    return fallback;
}

std::string si_unit_of(const std::string& name, const std::string& written) {
    if (const auto* known = core::find_quantity(name)) {
        return known->unit;
    }
    return written.empty() ? "1" : core::si_unit(written);
}

}  // namespace

core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units) {
    core::Table table;
    const std::vector<LoadsColumn> loads = cases.empty() ? std::vector<LoadsColumn>() : table_row(cases.front().loads);
    const auto free_name = [&](const std::string& name) {
        const bool taken = name == "file" || std::any_of(loads.begin(), loads.end(), [&](const LoadsColumn& c) { return c.name == name; });
        return taken ? name + "_stated" : name;
    };
    for (const auto& name : names_in(cases, [](const LoadsCase& c) -> const auto& { return c.texts; })) {
        std::vector<std::string> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.texts, name, std::string()));
        }
        table.add_text(free_name(name), std::move(values));
    }
    for (const auto& name : names_in(cases, [](const LoadsCase& c) -> const auto& { return c.numbers; })) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.numbers, name, std::numeric_limits<double>::quiet_NaN()));
        }
        const std::string written = value_of(written_units, name, std::string());
        table.add_numbers(free_name(name), si_unit_of(name, written), std::move(values), written);
    }
    for (std::size_t i = 0; i < loads.size(); ++i) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(table_row(one.loads)[i].value);
        }
        table.add_numbers(loads[i].name, loads[i].unit, std::move(values));
    }
    std::vector<std::string> files;
    for (const auto& one : cases) {
        files.push_back(one.file);
    }
    table.add_text("file", std::move(files));
    return table;
}

nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases) {
    nlohmann::json files = nlohmann::json::array();
    for (const auto& one : cases) {
        nlohmann::json entry = one.loads;
        entry["conditions"] = nlohmann::json::object();
        for (const auto& [name, value] : one.texts) {
            entry["conditions"][name] = value;
        }
        for (const auto& [name, value] : one.numbers) {
            entry["conditions"][name] = value;
        }
        files.push_back(std::move(entry));
    }
    return {{"files", std::move(files)}};
}

}  // namespace underbody::postproc
