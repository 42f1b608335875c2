// A table of points from a file: CSV, or the JSON of an exported table.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "surrogates/tables/points/select.h"
#include "surrogates/tables/points/table_files.h"

namespace underbody::tables {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
    throw core::InputError("parse", what, {path.string(), {}, {}, {}},
                           "a JSON table is one that an export with option 'format json' wrote");
}

/// What an export says of a table beside its values.
nlohmann::json facts_of(const nlohmann::json& file, const nlohmann::json& own) {
    const auto& axes = file.at("axes");
    const std::string quantity = own.at("quantity");
    nlohmann::json facts{{"underbody_table", 1},
                         {"quantity", quantity},
                         {"cell_error", own.at("cell_error")},
                         {"growth", own.at("growth")}};
    for (const char* kept : {"conditions", "hull", "support"}) {
        if (file.contains(kept)) {
            facts[kept] = file[kept];
        }
    }
    for (const char* kept : {"warnings", "told"}) {
        if (own.contains(kept)) {
            facts[kept] = own[kept];
        }
    }
    for (const auto& axis : axes) {
        facts["axes"].push_back(axis.at("name"));
        facts["range"].push_back(
            axis.value("outside", file.value("outside", "clamp")));  // of older files: one word for all axes
        if (axis.contains("lower") && axis.contains("upper")) {
            facts["known"].push_back({axis["lower"], axis["upper"]});
        }
    }
    return facts;
}

/// Column m of the derivatives: bit k says whether it is one along axis k.
void add_derivative(core::Table& table, const std::string& quantity, const std::string& unit,
                    const nlohmann::json& axes, std::size_t m, const std::vector<double>& values) {
    std::string name = quantity + "_per";
    std::string per = unit;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        if ((m >> k & 1) != 0) {
            name += "_" + axes[k].at("name").get<std::string>();
            per += " (" + axes[k].at("unit").get<std::string>() + ")^-1";
        }
    }
    table.add_numbers(name, core::si_unit(per), values);
}

/// Columns and the line of facts of one quantity.
void add_quantity(core::Table& table, const nlohmann::json& file, const nlohmann::json& own, std::size_t count,
                  const std::filesystem::path& path) {
    const std::string quantity = own.at("quantity");
    const std::string unit = own.at("unit");
    const auto& axes = file.at("axes");
    const std::size_t n = axes.size();
    const auto hermite = own.at("hermite").get<std::vector<std::vector<double>>>();
    auto sigma = own.at("sigma").get<std::vector<double>>();
    sigma.resize(sigma.empty() ? count : sigma.size(), 0.0);
    const std::size_t width = std::size_t{1} << n;
    if (hermite.size() != count || sigma.size() != count || own.at("cell_error").size() != n ||
        own.at("growth").size() != n) {
        refuse(path, "the axes have " + std::to_string(count) + " grid points together, hermite " +
                         std::to_string(hermite.size()) + " and sigma " + std::to_string(sigma.size()));
    }
    std::vector<std::vector<double>> derivatives(width);
    for (std::size_t node = 0; node < count; ++node) {
        if (hermite[node].size() != width) {
            refuse(path, "entry " + std::to_string(node) + " of hermite has " + std::to_string(hermite[node].size()) +
                             " numbers instead of " + std::to_string(width));
        }
        for (std::size_t m = 0; m < width; ++m) {
            derivatives[m].push_back(hermite[node][m]);
        }
        sigma[node] = sigma[node] > 0 ? sigma[node] : std::nan("");
    }
    table.comments.push_back(facts_of(file, own).dump());
    table.add_numbers(quantity, core::si_unit(unit), derivatives[0]);
    table.add_numbers(quantity + "_sigma", core::si_unit(unit), sigma);
    for (std::size_t m = 1; m < width; ++m) {
        add_derivative(table, quantity, unit, axes, m, derivatives[m]);
    }
}

core::Table table_of(const nlohmann::json& json, const std::filesystem::path& path) {
    static_cast<void>(json.at("quantity").get<std::string>());
    const auto& axes = json.at("axes");
    const std::size_t n = axes.size();
    if (n < 1 || n > 4) {
        refuse(path, "the table has " + std::to_string(n) + " axes; one to four are possible");
    }
    std::vector<std::vector<double>> grid;
    std::size_t count = 1;
    for (const auto& axis : axes) {
        grid.push_back(axis.at("points").get<std::vector<double>>());
        count *= grid.back().size();
    }
    if (count > json.at("hermite").size()) {
        refuse(path, "the axes have " + std::to_string(count) + " grid points together, hermite " +
                         std::to_string(json["hermite"].size()) + " and sigma " +
                         std::to_string(json.at("sigma").size()));
    }
    std::vector<std::vector<double>> places(n);
    for (std::size_t node = 0; node < count; ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            places[k].push_back(grid[k][rest % grid[k].size()]);
            rest /= grid[k].size();
        }
    }
    core::Table table;
    table.source = path.string();
    for (std::size_t k = 0; k < n; ++k) {
        table.add_numbers(axes[k].at("name"), core::si_unit(axes[k].at("unit").get<std::string>()), places[k]);
    }
    add_quantity(table, json, json, count, path);
    if (json.contains("more")) {
        for (const auto& more : json["more"]) {
            add_quantity(table, json, more, count, path);
        }
    }
    return table;
}

}  // namespace

core::Table read_points(const std::filesystem::path& path) {
    for (const TableFile& file : table_files()) {
        if (path.extension() == file.ending && !file.read_back) {
            throw core::InputError("parse", "this is a table exported as " + file.format + ", which is not read back",
                                   {path.string(), {}, {}, {}},
                                   "export it as csv or json too, or read the points it was made of");
        }
    }
    if (path.extension() != ".json") {
        return core::read_csv(path);
    }
    const core::MappedFile file(path);
    try {
        const auto json = nlohmann::json::parse(file.bytes());
        if (!json.is_object() || json.value("format", "") != "Underbody force table") {
            refuse(path, "this is not a force table");
        }
        return table_of(json, path);
    } catch (const nlohmann::json::parse_error& error) {
        throw core::InputError("parse", "this is not JSON", {path.string(), {}, {}, error.byte});
    } catch (const nlohmann::json::exception& error) {
        refuse(path, std::string("the table is not complete: ") + error.what());
    }
}

}  // namespace underbody::tables
