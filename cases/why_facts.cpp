// What results say of themselves: their numbers, by name.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/sweep_parts.h"
#include "cases/why.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

using nlohmann::json;

namespace {

std::string in_words(const json& value) {
    return value.is_string()   ? value.get<std::string>()
           : value.is_number() ? core::format_number(value.get<double>(), 6)
                               : value.dump();
}

class Facts {
public:
    std::vector<Fact> all;

    void text(const std::string& name, const std::string& value) { all.push_back({name, value, {}, {}}); }
    /// Lengths and angles are told in mm and degrees, as reports do.
    void number(const std::string& name, double value, const std::string& unit) {
        const std::string shown = unit == "m" ? "mm" : unit == "rad" ? "deg" : unit;
        const bool pure = unit.empty() || unit == "1";
        all.push_back(
            {name, core::format_number(pure ? value : core::convert(value, unit, shown), 6) + (pure ? "" : " " + shown),
             value, pure ? "1" : unit});
    }
    /// A member of an object, when it is a number.
    void member(const json& object, const char* key, const std::string& name, const std::string& unit) {
        if (const auto found = object.find(key); found != object.end() && found->is_number()) {
            number(name, found->get<double>(), unit);
        }
    }
    /// Every text and number below `value`, under the names on the way there.
    void everything(const json& value, const std::string& name) {
        static const std::string no_unit;
        if (all.size() > 400) {
            return;
        }
        if (value.is_object()) {
            for (const auto& [key, inner] : value.items()) {
                everything(inner, name.empty() ? key : name + "." + key);
            }
        } else if (value.is_array()) {
            for (std::size_t i = 0; i < value.size(); ++i) {
                everything(value[i], name + "[" + std::to_string(i + 1) + "]");
            }
        } else if (value.is_number()) {
            number(name, value.get<double>(), unit_of(name));
        } else if (value.is_string()) {
            text(name, value.get<std::string>());
        }
    }

private:
    /// Of a quantity by its own name, at the end of the way there.
    static std::string unit_of(const std::string& name) {
        const auto* quantity = core::find_quantity(name.substr(name.find_last_of('.') + 1));
        return quantity != nullptr ? quantity->unit : "";
    }
};

void of_loads(const json& document, const std::filesystem::path& folder, Facts& facts) {
    for (const auto& column : document.value("columns", json::array())) {
        facts.number(column.at("name"), column.at("value").is_number() ? column.at("value").get<double>() : NAN,
                     column.at("unit"));
    }
    for (const auto& zone : document.value("zones", json::array())) {
        facts.text("zone '" + zone.at("name").get<std::string>() + "'",
                   in_words(zone.at("faces")) + " faces, " + in_words(zone.at("area")) + " m^2");
    }
    if (const auto settled = document.find("settled"); settled != document.end()) {
        facts.text("solution", settled->value("verdict", "unknown") + ": " + settled->value("why", ""));
    }
    for (const char* key : {"values_from", "orientation", "reference_from", "format", "writer"}) {
        if (document.contains(key) && !document.at(key).empty() && document.at(key) != "") {
            facts.text(key, in_words(document.at(key)));
        }
    }
    const json said = document.value("metadata", json::array());
    for (const auto& entry : said) {  // of the solver and its settings
        facts.text("the file says " + in_words(entry.at(0)), in_words(entry.at(1)));
    }
    const std::filesystem::path file = folder / document.value("file", "");
    std::error_code ignored;
    if (const auto record = read_record(std::filesystem::is_directory(file, ignored) ? file : file.parent_path())) {
        for (const auto& [name, value] : record->made_of) {
            facts.text("the sweep's case has " + name, value);
        }
    }
    for (const auto& problem : document.value("problems", json::array())) {
        facts.text(problem.at("severity"), problem.at("message"));
    }
}

void of_equilibrium(const json& point, Facts& facts) {
    const std::string name = point.value("stable", false) ? "stable gap" : "unstable gap";
    const std::string unit = "m";
    facts.member(point, "gap", name, unit);
    facts.member(point, "sigma", "standard deviation of the " + name, unit);
    facts.member(point, "stiffness", "stiffness at the " + name, "N/m");
    if (point.value("stable", false)) {
        facts.member(point, "frequency", "frequency at the " + name, "Hz");
        facts.member(point, "kick_velocity", "kick velocity at the " + name, "m/s");
    }
}

void of_table(const json& document, Facts& facts) {
    facts.text("fit", in_words(document.at("kind")));
    for (const auto& point : document.value("equilibria", json::array())) {
        of_equilibrium(point, facts);
    }
    for (const auto& remark : document.value("remarks", json::array())) {
        facts.text("remark", in_words(remark));
    }
    std::size_t count = 0;
    const std::string points = document.value("points", "");  // the lines are views of it
    for (const auto line : core::split(points, '\n')) {
        const std::string text(core::trimmed(line));
        if (!text.empty() && text.front() != '#') {
            facts.text(count == 0 ? "points" : "point " + std::to_string(count), text);
            ++count;
        }
    }
}

void of_region(const json& document, Facts& facts) {
    for (const auto& entry : document.value("classes", json::array())) {
        const double share = entry.at("fraction").get<double>();
        facts.all.push_back(
            {"share of " + in_words(entry.at("name")), core::format_number(100 * share, 4) + " %", share, "1"});
        facts.member(entry, "gap", "gap of " + in_words(entry.at("name")), "m");
    }
    for (const auto& point : document.value("equilibria", json::array())) {
        of_equilibrium(point, facts);
    }
    for (const auto& remark : document.value("remarks", json::array())) {
        facts.text("remark", in_words(remark));
    }
}

void of_mesh(const json& document, Facts& facts) {
    const json quantities = document.value("quantities", json::object());
    for (const auto& [quantity, found] : quantities.items()) {
        const auto* known = core::find_quantity(quantity);
        const std::string unit = known != nullptr ? known->unit : "1";
        facts.text(quantity + " from coarse to fine", in_words(found.value("values", json::array())));
        facts.text("convergence of " + quantity, found.value("verdict", ""));
        facts.member(found, "standard_uncertainty", "standard uncertainty of " + quantity, unit);
    }
}

void of_verification(const json& document, Facts& facts) {
    facts.member(document, "worst", "worst", "1");
    facts.text("worst case", document.value("worst_case", ""));
    facts.member(document, "tolerance", "tolerance", "1");
    for (const auto& row : document.value("rows", json::array())) {
        facts.text(row.value("quantity", "") + " of " + row.value("case", ""),
                   in_words(row.value("ours", json())) + ", by the solver " + in_words(row.value("solver", json())));
    }
}

void of_comparison(const json& document, Facts& facts) {
    for (const auto& row : document.value("rows", json::array())) {
        facts.text(row.value("measure", ""), in_words(row.value("table", json())) + ": " + row.value("text", ""));
        for (const auto& value : row.value("values", json::array())) {
            facts.member(value, "value", row.value("measure", "") + " of " + value.value("table", ""),
                         row.value("unit", "1"));
        }
    }
    for (const auto& remark : document.value("remarks", json::array())) {
        facts.text("remark", in_words(remark));
    }
}

void of_discovery(const json& document, Facts& facts) {
    const json files = document.value("files", json::object());
    const json found = json::parse(files.value("discovery.json", "{}"), nullptr, false);
    for (const char* key : {"verdict", "sentence", "effects", "error"}) {
        if (found.is_object() && found.contains(key)) {
            facts.everything(found.at(key), key);
        }
    }
}

}  // namespace

std::vector<Fact> facts_of(const std::string& kind, const std::string& value, const std::filesystem::path& folder) {
    Facts facts;
    if (kind == "export" || kind == "model") {  // files: they say themselves what they hold
        return {};
    }
    const bool head_alone = kind == "figure" || kind.ends_with("picture");  // a picture stands behind it
    const json document = json::parse(value.substr(0, head_alone ? value.find('\n') : value.size()), nullptr, false);
    if (!document.is_object()) {
        return {};
    }
    if (kind == "loads") {
        of_loads(document, folder, facts);
    } else if (kind == "table") {
        of_table(document, facts);
    } else if (kind == "region") {
        of_region(document, facts);
    } else if (kind == "mesh") {
        of_mesh(document, facts);
    } else if (kind == "verify") {
        of_verification(document, facts);
    } else if (kind == "compare") {
        of_comparison(document, facts);
    } else if (kind == "discovery") {
        of_discovery(document, facts);
    } else {
        facts.everything(document, "");
    }
    return facts.all;
}

}  // namespace underbody::cases
