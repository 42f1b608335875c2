// Conditions of cases: what they are called, their units, and which fits which.
#include "cases/conditions.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "core/told.h"
#include "core/units.h"

namespace underbody::cases {

std::optional<std::string> condition_unit(const std::string& name) {
    if (name == "density") {
        return "kg/m^3";
    }
    const auto* quantity = core::find_quantity(name);
    return quantity != nullptr ? std::optional(quantity->unit) : std::nullopt;
}

void Conditions::set(const std::string& name, double value, const std::string& written) {
    std::erase_if(numbers, [&](const auto& old) { return old.first == name; });
    std::erase_if(own_units, [&](const OwnUnit& old) { return old.name == name; });
    numbers.emplace_back(name, value);
    if (!condition_unit(name) && !written.empty() && written != "1") {
        own_units.push_back({name, core::si_unit(written), written});
    }
}

std::string Conditions::unit(const std::string& name) const {
    for (const auto& own : own_units) {
        if (own.name == name) {
            return own.si;
        }
    }
    return condition_unit(name).value_or("1");
}

std::string Conditions::shown_unit(const std::string& name) const {
    for (const auto& own : own_units) {
        if (own.name == name) {
            return own.written;
        }
    }
    return std::string(core::told_unit_of(name, unit(name)));
}

std::optional<double> Conditions::number(const std::string& name) const {
    for (const auto& [key, value] : numbers) {
        if (key == name) {
            return value;
        }
    }
    return std::nullopt;
}

std::optional<std::string> Conditions::text(const std::string& name) const {
    for (const auto& [key, value] : texts) {
        if (key == name) {
            return value;
        }
    }
    return std::nullopt;
}

bool Conditions::satisfies(const Conditions& wanted) const {
    const auto alike = [](double mine, double value) {
        return std::abs(mine - value) <= 1e-9 * std::max(std::abs(mine), std::abs(value)) + 1e-15;
    };
    for (const auto& [name, value] : wanted.numbers) {
        const auto mine = number(name);
        if (!mine || !alike(*mine, value)) {
            return false;
        }
    }
    return std::all_of(wanted.texts.begin(), wanted.texts.end(), [&](const auto& wish) {
        const auto mine = number(wish.first);
        if (!mine) {
            return text(wish.first) == wish.second;
        }
        try {
            return alike(*mine, core::parse_in(wish.second, unit(wish.first)));
        } catch (const core::Error&) {
            return false;
        }
    });
}

std::string Conditions::label() const {
    std::string result;
    for (const auto& [name, value] : texts) {
        result += (result.empty() ? "" : ", ") + value;
    }
    for (const auto& [name, value] : numbers) {
        const std::string shown = shown_unit(name);
        result += (result.empty() ? "" : ", ") + name + " " +
                  core::format_number(core::convert(value, unit(name), shown), 4) + (shown == "1" ? "" : " " + shown);
    }
    return result;
}

Conditions conditions_from(const std::string& text) {
    Conditions conditions;
    for (const auto part : core::split(text, ',')) {
        const std::size_t equals = part.find('=');
        const std::string name(core::trimmed(part.substr(0, equals)));
        const std::string value(equals == std::string_view::npos ? "" : core::trimmed(part.substr(equals + 1)));
        if (name.empty() || value.empty()) {
            throw core::UsageError("parse", "'" + std::string(core::trimmed(part)) + "' is not of the form name=value",
                                   {}, "such as \"variant=A, pitch=0\"");
        }
        if (conditions.number(name) || conditions.text(name)) {
            throw core::UsageError("duplicate", "'" + name + "' is given twice");
        }
        if (const auto unit = condition_unit(name)) {
            try {
                conditions.numbers.emplace_back(name, core::parse_in(value, *unit));
            } catch (const core::Error& error) {
                throw core::UsageError("parse", error.message(), {}, error.hint());
            }
        } else if (const auto number = core::parse_number(value)) {
            conditions.numbers.emplace_back(name, *number);
        } else {
            conditions.texts.emplace_back(name, value);
        }
    }
    return conditions;
}

std::string written(double value, const std::string& unit) {
    std::string text = core::told(value, unit);
    try {
        Conditions exact;
        exact.set("value", value);
        Conditions read;
        read.set("value", core::parse_in(text, unit));
        if (read.satisfies(exact)) {
            return text;
        }
    } catch (const core::Error&) {  // a unit of the user's own
    }
    return core::format_number(value, 17) + (unit == "1" ? "" : " " + unit);
}

std::string text_of(const Conditions& conditions) {
    std::string text;
    for (const auto& [name, value] : conditions.numbers) {
        text += (text.empty() ? "" : ",") + name + "=" + written(value, conditions.unit(name));
    }
    for (const auto& [name, value] : conditions.texts) {
        text += (text.empty() ? "" : ",") + name + "=" + value;
    }
    return text;
}

}  // namespace underbody::cases
