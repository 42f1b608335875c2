// What results say of themselves: their numbers, by name.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cases/step_results.h"
#include "cases/sweep_parts.h"
#include "cases/why.h"
#include "core/table.h"
#include "core/text.h"
#include "core/told.h"
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
    /// Lengths and angles are told in mm and degrees, as reports do, unless `told_in` is another unit.
    void number(const std::string& name, double value, const std::string& unit, const std::string& told_in = "",
                const std::string& beside = "") {
        all.push_back({name, shown(value, unit, told_in) + beside, value, unit.empty() ? "1" : unit});
    }
    /// A member of an object, when it is a number.
    void member(const json& object, const char* key, const std::string& name, const std::string& unit,
                const std::string& told_in = "") {
        if (const auto found = object.find(key); found != object.end() && found->is_number()) {
            number(name, found->get<double>(), unit, told_in);
        }
    }
    /// "the stable gap", "stable gap 2": a second and a third thing of one name are numbered.
    [[nodiscard]] std::string numbered(const std::string& name) const {
        std::size_t count = 1;
        const auto known = [&](const std::string& wanted) {
            return std::any_of(all.begin(), all.end(), [&](const Fact& fact) { return fact.name == wanted; });
        };
        while (known(count == 1 ? name : name + " " + std::to_string(count))) {
            ++count;
        }
        return count == 1 ? name : name + " " + std::to_string(count);
    }
    static std::string shown(double value, const std::string& unit, const std::string& told_in = "") {
        const std::string as = !told_in.empty() ? told_in : std::string(core::told_unit(unit));
        const bool pure = as.empty() || as == "1";
        return core::format_number(pure ? value : core::convert(value, unit, as), 6) + (pure ? "" : " " + as);
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

void of_body(const json& document, Facts& facts) {
    facts.member(document, "volume", "volume", "m^3", "L");
    facts.member(document, "area", "surface", "m^2", "cm^2");
    facts.member(document, "buoyancy", "buoyancy", "N");
    const json box = document.value("bounding_box", json::object());
    const std::array<const char*, 3> sizes = {"length", "width", "height"};
    if (box.contains("lower") && box.contains("upper") && box["lower"].size() == 3 && box["upper"].size() == 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            facts.number(sizes[k], box["upper"][k].get<double>() - box["lower"][k].get<double>(), "m");
        }
    }
    for (const auto& patch : document.value("patches", json::array())) {
        facts.text("patch '" + patch.value("name", "") + "'", in_words(patch.value("faces", json())) + " faces, " +
                                                                  in_words(patch.value("area", json())) + " m^2");
    }
    if (document.contains("watertight")) {
        facts.text("watertight", document.at("watertight") == true ? "yes" : "no");
    }
}

void of_equilibrium(const json& point, Facts& facts) {
    const std::string name = facts.numbered(point.value("stable", false) ? "stable gap" : "unstable gap");
    facts.member(point, "gap", name, "m");
    facts.member(point, "sigma", "standard deviation of the " + name, "m");
    facts.member(point, "probability", "probability that there is the " + name, "1");
    facts.member(point, "stiffness", "stiffness at the " + name, "N/m");
    facts.member(point, "stiffness_sigma", "standard deviation of the stiffness at the " + name, "N/m");
    if (point.value("stable", false)) {
        if (point.contains("frequency") && point.at("frequency").is_number()) {
            facts.number("frequency at the " + name, frequency_in_hertz(point), "Hz");
            if (const double sigma = frequency_in_hertz(point, "frequency_sigma"); sigma > 0) {
                facts.number("standard deviation of the frequency at the " + name, sigma, "Hz");
            }
        }
        facts.member(point, "kick_velocity", "kick velocity at the " + name, "m/s", "mm/s");
    }
}

/// A row of a table's points: "lift_force at gap 5 mm", the value with its error, and which case it is of.
void of_points(const std::string& text, const std::string& quantity, Facts& facts) {
    const core::Table points = core::read_csv(std::string_view(text), "the table's points");
    const auto* values = points.find(quantity);
    if (values == nullptr || values->is_text()) {
        facts.text("points", text);
        return;
    }
    const auto* sigma = points.find(quantity + "_sigma");
    std::vector<std::size_t> rows(points.rows());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    std::vector<const core::Column*> axes, words;
    for (const auto& column : points.columns()) {
        if (column.is_text() && (column.name == "case" || column.name == "settled")) {
            words.push_back(&column);
        } else if (column.is_text()) {
            facts.text("all of " + column.name, column.text.front());
        } else if (column.name != quantity && !column.name.ends_with("_sigma")) {
            const auto& numbers = column.numbers;
            const bool varies = std::any_of(numbers.begin(), numbers.end(), [&](double v) { return v != numbers[0]; });
            if (varies || numbers.size() < 2) {
                axes.push_back(&column);
            } else {
                facts.text("all at " + column.name, Facts::shown(numbers[0], column.unit));
            }
        }
    }
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
        return std::lexicographical_compare(
            axes.begin(), axes.end(), axes.begin(), axes.end(),
            [&](const core::Column* x, const core::Column* y) { return x->numbers[a] < y->numbers[b]; });
    });
    facts.text("points", std::to_string(rows.size()));
    for (const std::size_t row : rows) {
        std::string place, beside;
        for (const auto* axis : axes) {
            place += (place.empty() ? "" : ", ") + axis->name + " " + Facts::shown(axis->numbers[row], axis->unit);
        }
        if (sigma != nullptr && !sigma->is_text() && std::isfinite(sigma->numbers[row])) {
            beside = " +- " + Facts::shown(sigma->numbers[row], sigma->unit);
        }
        for (const auto* word : words) {
            const std::string& said = word->text[row];
            beside += said.empty() ? "" : ", " + (word->name == "settled" ? std::string("settled: ") : "") + said;
        }
        facts.number(facts.numbered(quantity + " at " + place), values->numbers[row], values->unit, "", beside);
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
    of_points(document.value("points", ""), document.value("quantity", ""), facts);
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
        std::string values;
        for (const auto& value : found.value("values", json::array())) {
            values += (values.empty() ? "" : ", ") + in_words(value);
        }
        facts.text(quantity + " from coarse to fine", values + (unit == "1" ? "" : " " + unit));
        facts.text("convergence of " + quantity, found.value("verdict", ""));
        facts.member(found, "standard_uncertainty", "standard uncertainty of " + quantity, unit);
    }
}

void of_verification(const json& document, Facts& facts) {
    facts.member(document, "worst", "largest difference", "1", "%");
    facts.text("worst case", document.value("worst_case", ""));
    facts.member(document, "tolerance", "allowed difference", "1", "%");
    for (const auto& row : document.value("rows", json::array())) {
        const std::string quantity = row.value("quantity", "");
        const auto* known = core::find_quantity(quantity);
        const std::string unit = known != nullptr ? std::string(" ") + known->unit : "";
        facts.text(quantity + " of " + row.value("case", ""), in_words(row.value("ours", json())) + unit +
                                                                  ", by the solver " +
                                                                  in_words(row.value("solver", json())) + unit);
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
    if (!found.is_object()) {
        return;
    }
    for (const char* key : {"verdict", "sentence", "records_mended"}) {
        if (found.contains(key) && found.at(key).is_string()) {
            facts.text(key, found.at(key));
        }
    }
    for (const auto& effect : found.value("effects", json::array())) {
        const std::string name = effect.value("name", "");
        const json parameters = effect.value("parameters", json::object());
        for (const auto& [parameter, told] : parameters.items()) {
            const std::string unit = told.value("unit", "1");
            const double sigma =
                told.contains("sigma") && told.at("sigma").is_number() ? told.at("sigma").get<double>() : 0;
            if (told.contains("value") && told.at("value").is_number()) {
                facts.number(parameter + " of " + name, told.at("value"), unit, unit,
                             sigma > 0 ? " +- " + Facts::shown(sigma, unit, unit) : "");
            }
        }
        facts.member(effect, "probability", "probability of " + name, "1");
        facts.text("evidence for " + name, effect.value("evidence", ""));
    }
    const json error = found.value("error", json::object());
    const std::string unit = error.value("unit", "1");
    for (const char* when : {"before", "after"}) {
        facts.member(error.value(when, json::object()), "rmse",
                     "error of the predicted " + error.value("channel", "gap") + " " + when, unit);
    }
    if (error.contains("held_out")) {
        facts.text("held out", in_words(error.at("held_out")));
    }
}

void of_residual(const json& document, Facts& facts) {
    for (const auto& sentence : document.value("sentences", json::array())) {
        facts.text("sentence", in_words(sentence));
    }
    for (const auto& one : document.value("residuals", json::array())) {
        const std::string quantity = one.value("quantity", "");
        const auto* known = core::find_quantity(quantity);
        const std::string unit = known != nullptr ? known->unit : "1";
        facts.member(one, "mean", "missing " + quantity + ", mean", unit);
        facts.member(one, "rms", "missing " + quantity + ", root mean square", unit);
        facts.member(one, "sigma", "missing " + quantity + ", noise alone", unit);
    }
}

}  // namespace

std::vector<Fact> facts_of(const std::string& kind, const std::string& value, const std::filesystem::path& folder) {
    Facts facts;
    if (kind == "export" || kind == "model" || kind == "shape loads") {  // files: they say themselves what they hold
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
    } else if (kind == "residual") {
        of_residual(document, facts);
    } else if (kind == "body") {
        of_body(document, facts);
    } else {
        facts.everything(document, "");
    }
    return facts.all;
}

const Fact* Origin::fact(const std::string& fact_name) const {
    const auto found = std::find_if(facts.begin(), facts.end(), [&](const Fact& one) { return one.name == fact_name; });
    return found == facts.end() ? nullptr : &*found;
}

void to_json(json& all, const Fact& fact) {
    all = {{"name", fact.name}, {"value", fact.value}};
    if (fact.number && std::isfinite(*fact.number)) {
        all["number"] = *fact.number;
        all["unit"] = fact.unit;
    }
}

void to_json(json& all, const Origin& origin) {
    const auto object = [](const std::vector<std::pair<std::string, std::string>>& pairs) {
        json result = json::object();
        for (const auto& [key, value] : pairs) {
            result[key] = value;
        }
        return result;
    };
    all = {{"kind", origin.kind},
           {"name", origin.name},
           {"id", origin.id},
           {"state", to_string(origin.state)},
           {"made", origin.made}};
    all["facts"] = origin.facts;
    all["options"] = object(origin.options);
    all["code"] = object(origin.code);
    all["files"] = json::array();
    for (const auto& file : origin.files) {
        const char* kind = file.kind == core::Input::Kind::content ? "content"
                           : file.kind == core::Input::Kind::names ? "names"
                                                                   : "presence";
        all["files"].push_back({{"path", file.path}, {"kind", kind}, {"state", file.state}});
        if (!file.pattern.empty()) {
            all["files"].back()["pattern"] = file.pattern;
        }
    }
    all["from"] = json::array();
    for (const auto& [kind, name] : origin.from) {
        all["from"].push_back({{"kind", kind}, {"name", name}});
    }
}

}  // namespace underbody::cases
