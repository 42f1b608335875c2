#include "postproc/importers/csv_columns.h"

#include <algorithm>
#include <array>

#include "core/text.h"

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
/// foot it knows only spelt out.
std::string readable_unit(const std::string& unit) {
    if (unit == "C") {
        return "degC";
    }
    if (unit == "F") {
        return "degF";
    }
    if (unit == "R") {
        return "degR";
    }
    if (unit == "psf") {
        return "lbf ft^-2";
    }
    return unit;
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
    Planner(const CsvText& text, const ReadOptions& options, core::Problems& problems) : text_(text), options_(options), problems_(problems) {}

    std::vector<CsvColumn> columns(std::string_view header, char separator, const std::string& zone) {
        std::vector<CsvColumn> plans;
        for (const auto text : core::split(header, separator)) {
            CsvColumn plan = header_cell(text);
            if (plan.name.empty()) {
                throw InputError("parse", "a column of zone '" + zone + "' has no name", text_.place_of(text.data()));
            }
            for (const auto& [name, unit] : options_.units) {
                if (!plan.has_unit && core::lower_case(name) == core::lower_case(plan.name)) {
                    plan.unit = unit;
                    plan.has_unit = true;
                }
            }
            plans.push_back(std::move(plan));
        }
        const bool plain = std::any_of(plans.begin(), plans.end(), [](const CsvColumn& p) { return p.name.size() == 1 && coordinate_index(p.name) >= 0; });
        for (std::size_t i = 0; i < plans.size(); ++i) {
            const bool repeated = std::any_of(plans.begin(), plans.begin() + static_cast<std::ptrdiff_t>(i), [&](const CsvColumn& p) {
                return core::lower_case(p.name) == core::lower_case(plans[i].name);
            });
            if (repeated) {
                note(Severity::note, "column '" + plans[i].name + "' is repeated: the first one counts", text_.place_of(plans[i].at));
                continue;
            }
            const int coordinate = coordinate_index(plans[i].name);
            if (coordinate >= 0 && (!plain || plans[i].name.size() == 1)) {
                plan_coordinate(plans[i], coordinate);
            } else if (core::lower_case(plans[i].name) != "node number") {
                plan_array(plans[i]);
            }
        }
        join_components(plans);
        note_mixed_units(plans);
        return plans;
    }

private:
    void note(Severity severity, std::string message, Place place) {
        problems_.push_back({severity, std::move(message), std::move(place)});
    }

    void plan_coordinate(CsvColumn& plan, int coordinate) {
        std::string unit = plan.unit;
        if (!plan.has_unit) {
            unit = options_.length_unit;
            if (unit.empty()) {
                throw InputError("unit", "coordinate '" + plan.name + "' has no unit", text_.place_of(plan.at),
                                 "say it with --length-unit mm (or m, inch, ...)");
            }
        }
        plan.coordinate = coordinate;
        plan.conversion = core::conversion(unit, "m", text_.place_of(plan.at));
        plan.si_unit = "m";
    }

    void plan_array(CsvColumn& plan) {
        const Place place = text_.place_of(plan.at);
        CanonicalName canonical = canonical_name(plan.name);
        if (vector_component(canonical.name + "_x")) {
            canonical.name += "_magnitude";  // CFX calls the size of a vector by the vector's name
        }
        const std::string& dimension = canonical.unit;
        const std::string unit = readable_unit(plan.unit);
        if (!dimension.empty() && !plan.has_unit && dimension != "1") {
            if (canonical.name == "pressure" || canonical.name.starts_with("wall_shear")) {
                throw InputError("unit", "column '" + plan.name + "' has no unit", place,
                                 "say it with --unit \"" + plan.name + "=" + dimension + "\"");
            }
            note(Severity::warning, "column '" + plan.name + "' has no unit: kept as a pure number", place);
            plan.array = plan.name;
            plan.si_unit = "1";
            return;
        }
        plan.array = canonical.name;
        if (!dimension.empty()) {
            plan.conversion = core::conversion(plan.has_unit ? unit : "1", dimension, place);
            plan.si_unit = dimension;
        } else if (!plan.has_unit) {
            plan.si_unit = "1";
        } else if (core::is_unit(unit)) {
            plan.si_unit = core::si_unit(unit, place);
            plan.conversion = core::conversion(unit, plan.si_unit, place);
        } else {
            note(Severity::warning, "unit '" + unit + "' of column '" + plan.name + "' is not known: values are kept as they are", place);
            plan.si_unit = unit;
        }
    }

    /// Three columns x, y, z of a vector become one array; two columns of one meaning keep their own names.
    static void join_components(std::vector<CsvColumn>& plans) {
        for (std::size_t i = 0; i < plans.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (!plans[i].array.empty() && plans[j].array == plans[i].array) {
                    plans[i].array = plans[i].name;
                }
            }
        }
        for (auto& plan : plans) {
            const auto component = vector_component(plan.array);
            if (!component) {
                continue;
            }
            std::array<CsvColumn*, 3> found{};
            for (auto& other : plans) {
                const auto of = vector_component(other.array);
                if (of && of->vector == component->vector) {
                    found[static_cast<std::size_t>(of->index)] = &other;
                }
            }
            if (found[0] != nullptr && found[1] != nullptr && found[2] != nullptr) {
                for (std::size_t k = 0; k < 3; ++k) {
                    found[k]->array = component->vector;
                    found[k]->component = static_cast<int>(k);
                }
            }
        }
    }

    void note_mixed_units(const std::vector<CsvColumn>& plans) {
        const CsvColumn* first = nullptr;
        for (const auto& plan : plans) {
            if (plan.coordinate < 0) {
                continue;
            }
            if (first != nullptr && first->unit != plan.unit) {
                note(Severity::warning, "coordinates have different units: '" + first->name + "' in " + first->unit + ", '" +
                     plan.name + "' in " + plan.unit + "; each was converted by its own", text_.place_of(plan.at));
            }
            first = first == nullptr ? &plan : first;
        }
    }

    const CsvText& text_;
    const ReadOptions& options_;
    core::Problems& problems_;
};

}  // namespace

std::vector<CsvColumn> plan_columns(std::string_view header, char separator, const std::string& zone, const CsvText& text,
                                    const ReadOptions& options, core::Problems& problems) {
    return Planner(text, options, problems).columns(header, separator, zone);
}

}  // namespace underbody::postproc
