#include "postproc/importers/csv/csv_columns.h"

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "core/text.h"
#include "postproc/field/import_error.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/variable_reading.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using core::Place;
using Severity = core::Problem::Severity;

CsvColumn header_cell(std::string_view text) {
    CsvColumn cell;
    cell.at = text.data();
    std::string_view trimmed = core::trimmed(text);
    if (trimmed.size() > 1 && trimmed.front() == '"' && trimmed.back() == '"') {
        trimmed = core::trimmed(trimmed.substr(1, trimmed.size() - 2));
    }
    const auto open = trimmed.rfind('[');
    if (open != std::string_view::npos && trimmed.back() == ']') {
        cell.name = core::trimmed(trimmed.substr(0, open));
        cell.unit = core::trimmed(trimmed.substr(open + 1, trimmed.size() - open - 2));
        cell.has_unit = !cell.unit.empty();
    } else {
        cell.name = trimmed;
    }
    return cell;
}

/// CFX writes C, F, R for temperatures, where UDUNITS reads coulomb, farad and a gas constant; pounds per square
/// foot it knows only spelt out. Beside other units, or to a power, they are differences: W/m^2 per C is per kelvin.
std::string readable_unit(const std::string& unit) {
    if (unit == "C" || unit == "F" || unit == "R") {
        return "deg" + unit;
    }
    std::string readable;
    for (std::size_t i = 0; i < unit.size();) {
        std::size_t end = i;
        while (end < unit.size() && (std::isalpha(static_cast<unsigned char>(unit[end])) != 0 || unit[end] == '_')) {
            ++end;
        }
        const std::string word = unit.substr(i, end - i);
        readable += word == "C" ? "K" : word == "F" || word == "R" ? "degR" : word == "psf" ? "(lbf ft^-2)" : word;
        if (end < unit.size()) {
            readable += unit[end++];
        }
        i = end;
    }
    return readable;
}

int coordinate_index(const std::string& name) {
    std::string key = core::lower_case(name);
    if (key.starts_with("initial ")) {
        key = std::string(core::trimmed(std::string_view(key).substr(8)));
    }
    return key.size() == 1 && key[0] >= 'x' && key[0] <= 'z' ? key[0] - 'x' : -1;
}

/// Plans the columns of one header.
class Planner {
public:
    Planner(const CsvText& text, const ReadOptions& options, core::Problems& problems)
        : text_(text), options_(options), problems_(problems) {}

    std::vector<CsvColumn> columns(std::string_view header, char separator, const std::string& zone) {
        std::vector<CsvColumn> plans = named_columns(header, separator, zone);
        const bool plain = std::any_of(plans.begin(), plans.end(), [](const CsvColumn& p) {
            return p.name.size() == 1 && coordinate_index(p.name) >= 0;
        });
        std::unordered_set<std::string> names;
        std::array<bool, 3> has{};
        for (auto& plan : plans) {
            if (!names.insert(core::lower_case(plan.name)).second) {
                const std::string meaning =
                    canonical_name(plan.name).name;  // the values may differ, and of these loads are made
                const bool counts = meaning.starts_with("pressure") || meaning.starts_with("wall_shear");
                note(counts ? Severity::warning : Severity::note,
                     "column '" + plan.name + "' is repeated: the first one counts", text_.place_of(plan.at));
                continue;
            }
            const int coordinate = coordinate_index(plan.name);
            if (coordinate >= 0 && (!plain || plan.name.size() == 1) && !has[static_cast<std::size_t>(coordinate)]) {
                has[static_cast<std::size_t>(coordinate)] = true;
                plan_coordinate(plan, coordinate);
            } else if (core::lower_case(plan.name) != "node number") {
                plan_array(plan);
            }
        }
        for (auto& plan : plans) {
            if (plan.coordinate >= 0 && !(has[0] && has[1])) {
                plan.array = plan.name;  // of a profile that has no place in space
            }
        }
        settle(plans, has[0] && has[1] && !has[2] ? 2 : 3);
        note_mixed_units(plans);
        return plans;
    }

private:
    void note(Severity severity, std::string message, Place place) {
        problems_.push_back({severity, std::move(message), std::move(place)});
    }

    std::vector<CsvColumn> named_columns(std::string_view header, char separator, const std::string& zone) const {
        std::vector<CsvColumn> plans;
        const auto cells = core::split(header, separator);
        if (cells.size() > most_csv_columns) {
            throw InputError(
                "parse", "the header of zone '" + zone + "' names " + std::to_string(cells.size()) + " columns",
                text_.place_of(header.data(), false), "the file is damaged: its line ends are lost, perhaps");
        }
        for (const auto text : cells) {
            plans.push_back(header_cell(text));
            if (plans.back().name.empty()) {
                throw InputError("parse", "a column of zone '" + zone + "' has no name", text_.place_of(text.data()));
            }
        }
        return plans;
    }

    void state_unit(CsvColumn& plan) {
        plan.unit = settled_unit(plan.name, plan.unit, options_, text_.place_of(plan.at), problems_);
        plan.has_unit = !plan.unit.empty();
    }

    void plan_coordinate(CsvColumn& plan, int coordinate) {
        const Place place = text_.place_of(plan.at);
        state_unit(plan);
        const std::string& stated = options_.length_unit;
        if (!plan.has_unit && stated.empty()) {
            throw UnitMissing("coordinate '" + plan.name + "' has no unit", place,
                              "say it: option 'length-unit mm' (or m, inch, ...)", "", "m");
        }
        if (plan.has_unit && !stated.empty() && core::same_dimension(plan.unit, stated) &&
            core::conversion(plan.unit, stated).scale != 1) {
            note(Severity::warning,
                 "coordinate '" + plan.name + "' is in " + plan.unit + ": a length unit (" + stated +
                     ") is for files that state none",
                 place);
        }
        plan.coordinate = coordinate;
        plan.conversion = core::conversion(plan.has_unit ? plan.unit : stated, "m", place);
        plan.si_unit = "m";
    }

    void plan_array(CsvColumn& plan) {
        const Place place = text_.place_of(plan.at);
        state_unit(plan);
        const CanonicalName meaning = named_as_scalar(canonical_name(plan.name));
        const bool counts =
            meaning.name == "pressure" || meaning.name.starts_with("wall_shear");  // for loads: nothing is guessed
        const bool pure = meaning.unit.empty() || meaning.unit == "1";
        if (!plan.has_unit && !pure && counts) {
            throw UnitMissing("column '" + plan.name + "' has no unit", place,
                              "say it: option 'unit " + plan.name + "=" + meaning.unit + "'", plan.name, meaning.unit);
        }
        if (!plan.has_unit) {
            if (!pure) {
                note(Severity::warning, "column '" + plan.name + "' has no unit: kept as a pure number", place);
            }
            plan.array = pure ? meaning.name : own_name(plan.name, "");
            plan.si_unit = "1";
            return;
        }
        const std::string unit = readable_unit(plan.unit);
        try {
            const VariableReading reading = quantity_in(plan.name, meaning, unit, place);
            const bool fits =
                meaning.unit.empty() || reading.unit == meaning.unit || reading.name == "kinematic_" + meaning.name;
            if (!fits && counts) {
                (void)core::conversion(unit, meaning.unit, place);  // throws: of another dimension
            }
            if (!fits) {
                note(Severity::warning,
                     "column '" + plan.name + "' is in " + plan.unit + ", which no " + meaning.name +
                         " is: it is kept under its own name",
                     place);
            }
            plan.array = reading.name;
            plan.si_unit = reading.unit;
            plan.conversion = reading.convert;
        } catch (const InputError&) {
            if (counts) {
                throw;
            }
            note(Severity::warning,
                 "unit '" + unit + "' of column '" + plan.name + "' is not known: values are kept as they are", place);
            plan.array = own_name(plan.name, unit);
            plan.si_unit = unit;
        }
    }

    /// Each name once, what is asked for, components as vectors.
    void settle(std::vector<CsvColumn>& plans, int dimension) {
        std::vector<ArrayPlan> arrays;
        for (const auto& plan : plans) {
            arrays.push_back({plan.name, plan.array});
        }
        const Place place = text_.place_of(plans.front().at, false);
        settle_names(arrays, place, problems_);
        for (std::size_t i = 0; i < plans.size(); ++i) {
            if (plans[i].coordinate < 0 && !is_wanted(options_, arrays[i].own, arrays[i].name)) {
                arrays[i].name.clear();
            }
        }
        join_components(arrays, dimension, options_, place, problems_);
        for (std::size_t i = 0; i < plans.size(); ++i) {
            plans[i].array = arrays[i].name;
            plans[i].component = arrays[i].component;
        }
    }

    void note_mixed_units(const std::vector<CsvColumn>& plans) {
        const CsvColumn* first = nullptr;
        for (const auto& plan : plans) {
            if (plan.coordinate < 0) {
                continue;
            }
            if (first != nullptr && first->unit != plan.unit) {
                note(Severity::warning,
                     "coordinates have different units: '" + first->name + "' in " + first->unit + ", '" + plan.name +
                         "' in " + plan.unit + "; each was converted by its own",
                     text_.place_of(plan.at));
            }
            first = first == nullptr ? &plan : first;
        }
    }

    const CsvText& text_;
    const ReadOptions& options_;
    core::Problems& problems_;
};

}  // namespace

std::array<bool, 3> coordinates_in(const std::vector<CsvColumn>& columns) {
    std::array<bool, 3> has{};
    for (const auto& column : columns) {
        if (column.coordinate >= 0) {
            has[static_cast<std::size_t>(column.coordinate)] = true;
        }
    }
    return has;
}

std::vector<CsvColumn> plan_columns(std::string_view header, char separator, const std::string& zone,
                                    const CsvText& text, const ReadOptions& options, core::Problems& problems) {
    return Planner(text, options, problems).columns(header, separator, zone);
}

}  // namespace underbody::postproc
