#include "core/units.h"

#include <locale.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "core/text.h"

namespace underbody::core {

namespace {

/// UDUNITS-2 reads numbers, those of its own database too, by the thread's locale: a comma country would get feet of
/// no length. Everything it does happens in the C locale.
class InPlainLocale {
public:
    InPlainLocale() : plain_(::newlocale(LC_ALL_MASK, "C", nullptr)), before_(::uselocale(plain_)) {}
    ~InPlainLocale() {
        ::uselocale(before_);
        ::freelocale(plain_);
    }
    InPlainLocale(const InPlainLocale&) = delete;
    InPlainLocale& operator=(const InPlainLocale&) = delete;

private:
    locale_t plain_;
    locale_t before_;
};

/// UDUNITS-2 keeps global state and is not thread-safe: one mutex, and every answer is remembered.
class UnitSystem {
public:
    static UnitSystem& instance() {
        static UnitSystem system;
        return system;
    }

    const ut_unit* find(std::string_view text) {
        const std::string key = spelled(text);
        const auto known = units_.find(key);
        if (known != units_.end()) {
            return known->second.get();
        }
        const InPlainLocale plain;
        ut_unit* unit = has_factor(key) ? nullptr : ut_parse(system_, key.c_str(), UT_UTF8);
        return units_.emplace(key, Owned(unit)).first->second.get();
    }

    /// True if both units measure the same thing. (UDUNITS also converts s to Hz; nobody means that in a file.)
    static bool same_dimension(const ut_unit* a, const ut_unit* b) {
        const Owned quotient(ut_divide(const_cast<ut_unit*>(a), const_cast<ut_unit*>(b)));
        return quotient && ut_is_dimensionless(quotient.get()) != 0 &&
               ut_are_convertible(const_cast<ut_unit*>(a), const_cast<ut_unit*>(b)) != 0;
    }

    /// Conversions found before, by their units: of ten thousand numbers most are in the same two.
    std::map<std::pair<std::string, std::string>, Conversion>& conversions() { return conversions_; }

    std::mutex& mutex() { return mutex_; }
    [[nodiscard]] ut_system* raw() const { return system_; }

    /// Names of units near to a mistyped one, for the hint of an error.
    static const std::vector<std::string>& common() {
        static const std::vector<std::string> names = {
            "m",   "mm",   "cm",   "km",     "inch",  "ft",   "kg",  "g",     "s",     "ms",   "min", "h", "N",    "mN",
            "kN",  "gf",   "Pa",   "kPa",    "MPa",   "bar",  "atm", "psi",   "deg",   "rad",  "Hz",  "K", "degC", "V",
            "m/s", "mm/s", "km/h", "kg/m^3", "m^2/s", "Pa s", "N m", "N s/m", "m^3/s", "mL/s", "1",   "%", "J",    "W"};
        return names;
    }

private:
    struct Free {
        void operator()(ut_unit* unit) const { ut_free(unit); }
    };
    using Owned = std::unique_ptr<ut_unit, Free>;

    UnitSystem() {
        const InPlainLocale plain;
        ut_set_error_message_handler(ut_ignore);
        system_ = ut_read_xml(nullptr);
        if (system_ == nullptr) {
            throw SystemError("unit", "the unit database of UDUNITS-2 cannot be read", {},
                              "install the Debian package libudunits2-data");
        }
    }

    /// UDUNITS reads "m 3" as three metres; in a file that is a slip of the pen. Exponents and "1/s" stay allowed.
    static bool has_factor(const std::string& key) {
        const auto digit = [&key](std::size_t i) {
            return i < key.size() && std::isdigit(static_cast<unsigned char>(key[i])) != 0;
        };
        if (digit(0) && !(key[0] == '1' && !digit(1) && (key.size() == 1 || key[1] != '.'))) {
            return true;
        }
        for (std::size_t i = 1; i < key.size(); ++i) {
            const bool after_break = key[i - 1] == ' ' || key[i - 1] == '*' || key[i - 1] == '/' || key[i - 1] == '(';
            if (digit(i) && after_break) {
                return true;
            }
        }
        return false;
    }

    /// What people write and UDUNITS does not read.
    static std::string spelled(std::string_view text) {
        const std::string key(trimmed(text));
        if (key.empty() || key == "-") {
            return "1";
        }
        // "deg" within products too: deg/s, N m/deg.
        std::string result;
        for (std::size_t i = 0; i < key.size();) {
            std::size_t end = i;
            while (end < key.size() && std::isalpha(static_cast<unsigned char>(key[end])) != 0) {
                ++end;
            }
            const std::string word = key.substr(i, end - i);
            result += word == "deg" ? "degree" : word;
            if (end < key.size()) {
                result += key[end];
            }
            i = end + 1;
        }
        return result;
    }

    ut_system* system_ = nullptr;
    std::map<std::string, Owned> units_;
    std::map<std::pair<std::string, std::string>, Conversion> conversions_;
    std::mutex mutex_;
};

[[noreturn]] void unknown_unit(std::string_view unit, const Place& place) {
    throw InputError("unit", "unknown unit '" + std::string(unit) + "'", place,
                     did_you_mean(std::string(unit), UnitSystem::common()));
}

struct ConverterFree {
    void operator()(cv_converter* converter) const { cv_free(converter); }
};

}  // namespace

bool is_unit(std::string_view unit) {
    auto& system = UnitSystem::instance();
    const std::lock_guard lock(system.mutex());
    return system.find(unit) != nullptr;
}

bool same_dimension(std::string_view unit_a, std::string_view unit_b) {
    auto& system = UnitSystem::instance();
    const std::lock_guard lock(system.mutex());
    const ut_unit* a = system.find(unit_a);
    const ut_unit* b = system.find(unit_b);
    return a != nullptr && b != nullptr && UnitSystem::same_dimension(a, b);
}

Conversion conversion(std::string_view from, std::string_view to, const Place& place) {
    auto& system = UnitSystem::instance();
    const std::lock_guard lock(system.mutex());
    std::pair<std::string, std::string> units(from, to);
    if (const auto known = system.conversions().find(units); known != system.conversions().end()) {
        return known->second;
    }
    const ut_unit* a = system.find(from);
    const ut_unit* b = system.find(to);
    if (a == nullptr) {
        unknown_unit(from, place);
    }
    if (b == nullptr) {
        unknown_unit(to, place);
    }
    std::unique_ptr<cv_converter, ConverterFree> converter;
    if (UnitSystem::same_dimension(a, b)) {
        converter.reset(ut_get_converter(const_cast<ut_unit*>(a), const_cast<ut_unit*>(b)));
    }
    if (!converter) {
        const auto none = [](std::string_view unit) { return unit.empty() || unit == "1"; };
        if (none(to) || none(from)) {
            throw InputError("unit",
                             none(to) ? "'" + std::string(from) + "' is a unit, but a plain number is wanted here"
                                      : "a plain number, but a unit like '" + std::string(to) + "' is wanted here",
                             place,
                             none(to) ? "write the number without a unit" : "give the value in " + std::string(to));
        }
        // A word that happens to be another unit ("degr") is often meant for one of the right dimension.
        std::vector<std::string> fitting;
        for (const std::string& unit : UnitSystem::common()) {
            const ut_unit* candidate = system.find(unit);
            if (candidate != nullptr && UnitSystem::same_dimension(candidate, b)) {
                fitting.push_back(unit);
            }
        }
        const std::string near = nearest_name(std::string(from), fitting);
        throw InputError("unit",
                         "unit '" + std::string(from) + "' has another dimension than '" + std::string(to) + "'", place,
                         near.empty() ? "give the value in " + std::string(to) + " or a unit of the same dimension"
                                      : "did you mean '" + near + "'?");
    }
    const double at_zero = cv_convert_double(converter.get(), 0.0);
    const double at_one = cv_convert_double(converter.get(), 1.0);
    const double at_two = cv_convert_double(converter.get(), 2.0);
    if (std::abs((at_two - at_one) - (at_one - at_zero)) > 1e-9 * (std::abs(at_two) + std::abs(at_one))) {
        throw InputError("unit", "'" + std::string(from) + "' is not proportional to '" + std::string(to) + "'", place);
    }
    const Conversion found = at_zero == 0 ? Conversion{at_one, 0} : Conversion{at_one - at_zero, at_zero};
    return system.conversions().emplace(std::move(units), found).first->second;
}

double convert(double value, std::string_view from, std::string_view to, const Place& place) {
    return conversion(from, to, place)(value);
}

std::string si_unit(std::string_view unit, const Place& place) {
    static const std::vector<std::string> named = {
        "1",     "m",         "m^2",    "m^3",   "kg",    "s",       "K",       "V",    "A",      "m/s",   "m/s^2",
        "Hz",    "N",         "Pa",     "N m",   "W",     "kg/m^3",  "m^2/s",   "Pa s", "m^3/s",  "kg/s",  "N/m",
        "N s/m", "N s^2/m^2", "kg m^2", "N m s", "W/m^2", "m^2/s^2", "m^2/s^3", "J/kg", "J/kg/K", "W/m/K", "1/m"};
    if (!is_unit(unit)) {
        unknown_unit(unit, place);
    }
    // The radian is a pure number to UDUNITS; people who write degrees want to see it.
    if (unit.find("rad") != std::string_view::npos || unit.find("deg") != std::string_view::npos) {
        for (const char* candidate : {"rad", "rad/s", "rad/s^2", "N m/rad"}) {
            if (same_dimension(unit, candidate)) {
                return candidate;
            }
        }
    }
    for (const auto& candidate : named) {
        if (same_dimension(unit, candidate)) {
            // m^2/s^2 and J/kg, N m and J are one dimension to UDUNITS: the first listed names it.
            return candidate;
        }
    }
    auto& system = UnitSystem::instance();
    const std::lock_guard lock(system.mutex());
    std::array<char, 256> buffer{};
    const InPlainLocale plain;
    const ut_unit* found = system.find(unit);
    std::unique_ptr<ut_unit, void (*)(ut_unit*)> pure(ut_clone(found), ut_free);
    if (ut_format(pure.get(), buffer.data(), buffer.size(), UT_ASCII | UT_DEFINITION) < 0) {
        return std::string(unit);
    }
    // Drop the scale that UT_DEFINITION puts before the base units ("1000 kg.m-3").
    std::string text(buffer.data());
    const std::size_t blank = text.find(' ');
    if (blank != std::string::npos && parse_number(text.substr(0, blank))) {
        text = text.substr(blank + 1);
    }
    return text;
}

Quantity parse_quantity(std::string_view text, const Place& place) {
    const std::string_view whole = trimmed(text);
    std::size_t end = 0;
    while (end < whole.size()) {
        const char c = whole[end];
        const bool exponent_sign =
            (c == '+' || c == '-') && end > 0 && (whole[end - 1] == 'e' || whole[end - 1] == 'E');
        const bool leading_sign = (c == '+' || c == '-') && end == 0;
        const bool exponent =
            (c == 'e' || c == 'E') && end > 0 && end + 1 < whole.size() &&
            (whole[end + 1] == '+' || whole[end + 1] == '-' || (whole[end + 1] >= '0' && whole[end + 1] <= '9'));
        if ((c >= '0' && c <= '9') || c == '.' || exponent_sign || leading_sign || exponent) {
            ++end;
        } else {
            break;
        }
    }
    const auto number = parse_number(whole.substr(0, end));
    if (!number) {
        throw InputError("parse", "'" + std::string(text) + "' is not a number with a unit", place,
                         "write a number, a blank and a unit, such as '5 mm'");
    }
    if (end + 1 < whole.size() && whole[end] == ',' && whole[end + 1] >= '0' && whole[end + 1] <= '9') {
        std::string decimal(whole), thousands(whole);
        decimal[end] = '.';
        thousands.erase(end, 1);
        const auto digits = std::min(whole.find_first_not_of("0123456789", end + 1), whole.size()) - end - 1;
        constexpr std::size_t of_thousands = 3;
        throw InputError(
            "parse", "'" + std::string(whole) + "' is a number with a decimal comma", place,
            "write it with '.' as decimal point: " + decimal +
                (digits == of_thousands ? ", or, if the comma parts thousands, without: " + thousands : ""));
    }
    const std::string unit(trimmed(whole.substr(end)));
    if (!unit.empty() && !is_unit(unit)) {
        unknown_unit(unit, place);
    }
    return {*number, unit};
}

namespace {

/// People weigh in kilograms: what such a mass weighs, where a force is wanted. Else what was said.
std::string hint_of_weight(const Quantity& given, std::string_view wanted, const std::string& otherwise) {
    if (!same_dimension(given.unit, "kg") || !same_dimension(wanted, "N")) {
        return otherwise;
    }
    const std::string weighs = format_number(convert(convert(given.value, given.unit, "kg"), "kgf", "N"), 4);
    return "a weight is a force: " + format_number(given.value) + " " + given.unit + " weigh " + weighs +
           " N in air, and less by what the water carries";
}

}  // namespace

double parse_in(std::string_view text, std::string_view unit_si, const Place& place) {
    const Quantity quantity = parse_quantity(text, place);
    double value = quantity.value;
    try {
        value = quantity.unit.empty() ? value : convert(value, quantity.unit, unit_si, place);
    } catch (const InputError& error) {
        // An option has no line to point at: its text says which one it was.
        const std::string which = place.file.empty() ? "'" + std::string(text) + "': " : "";
        throw InputError(error.kind(), which + error.message(), error.place(),
                         hint_of_weight(quantity, unit_si, error.hint()));
    }
    if (!std::isfinite(value)) {
        throw InputError("range", "'" + std::string(text) + "' is not finite", place);
    }
    return value;
}

const std::vector<QuantityName>& quantity_names() {
    static const std::vector<QuantityName> names = {
        {"time", "s", "time", "t"},
        {"gap", "m", "height of the base centre over the ground, positive up", "h"},
        {"pitch", "rad", "pitch angle, positive nose up", "pitch"},
        {"speed", "m/s", "forward speed through the water", "U"},
        {"heave_velocity", "m/s", "dh/dt, positive up", "dh/dt"},
        {"heave_acceleration", "m/s^2", "d2h/dt2, positive up", "d2h/dt2"},
        {"pitch_rate", "rad/s", "rate of pitch, positive nose up", "q"},
        {"position_x", "m", "place along the ground, in the direction of heading 0", "X"},
        {"position_y", "m", "place along the ground, to starboard of heading 0", "Y"},
        {"heading", "rad", "heading, positive bow to starboard", "psi"},
        {"roll", "rad", "roll, positive starboard down", "phi"},
        {"sway_velocity", "m/s", "speed through the water to starboard", "v"},
        {"yaw_rate", "rad/s", "rate of heading, positive bow to starboard", "r"},
        {"lift_force", "N", "vertical force, positive up (repulsion)", "lift"},
        {"drag_force", "N", "force against the motion, positive when it slows", "drag"},
        {"side_force", "N", "lateral force, positive to starboard", "side force"},
        {"pitch_moment", "N m", "pitch moment, positive nose up", "pitch moment"},
        {"pitch_moment_at_buoyancy", "N m", "pitch moment about the body's centre of buoyancy, positive nose up",
         "pitch moment about the centre of buoyancy"},
        {"roll_moment", "N m", "roll moment, positive starboard down", "roll moment"},
        {"yaw_moment", "N m", "yaw moment, positive bow to starboard", "yaw moment"},
        {"jet_voltage", "V", "voltage of the jet pump", "V"},
        {"jet_flow", "m^3/s", "volume flow of the jet", "q"},
        {"input_force", "N", "control force, positive up", "u"},
        {"input_moment", "N m", "control moment, positive nose up", "control moment"},
        {"temperature", "K", "temperature of the water", "T"},
        {"depth", "m", "depth below the free surface, positive down", "depth"},
        {"approach_direction", "1", "+1 when the set point was approached upward, -1 downward", "direction"},
    };
    return names;
}

const QuantityName* find_quantity(std::string_view name) {
    for (const auto& quantity : quantity_names()) {
        if (quantity.name == name) {
            return &quantity;
        }
    }
    return nullptr;
}

namespace {
const QuantityName& known_name(const std::string& name, const std::vector<QuantityName>& extra) {
    for (const auto& quantity : extra) {
        if (quantity.name == name) {
            return quantity;
        }
    }
    if (const QuantityName* found = find_quantity(name)) {
        return *found;
    }
    std::vector<std::string> known;
    for (const auto& quantity : extra) {
        known.push_back(quantity.name);
    }
    for (const auto& quantity : quantity_names()) {
        known.push_back(quantity.name);
    }
    throw UsageError("name", "unknown quantity '" + name + "'", {}, did_you_mean(name, known));
}

std::vector<std::pair<std::string, std::string>> pairs_of(std::string_view text, const std::string& example) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const auto part : split(text, ',')) {
        const std::size_t equal = part.find('=');
        if (equal == std::string_view::npos) {
            throw UsageError("parse", "'" + std::string(part) + "' is not of the form name=value", {},
                             "write a list such as " + example);
        }
        const std::string name(trimmed(part.substr(0, equal)));
        if (std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair.first == name; })) {
            throw UsageError("parse", "'" + name + "' is given twice: " + std::string(text));
        }
        pairs.emplace_back(name, trimmed(part.substr(equal + 1)));
    }
    return pairs;
}

/// Values of an option: a mistake in them is a mistake of the command line.
double option_value(const std::string& text, const QuantityName& quantity) {
    try {
        return parse_in(text, quantity.unit);
    } catch (const InputError& error) {
        throw UsageError(error.kind(), quantity.name + ": " + error.message(), {}, error.hint());
    }
}
}  // namespace

std::vector<NamedValue> parse_assignments(std::string_view text, const std::vector<QuantityName>& extra) {
    std::vector<NamedValue> values;
    for (const auto& [name, value] : pairs_of(text, "gap=5mm,speed=0.5")) {
        values.push_back({name, option_value(value, known_name(name, extra))});
    }
    return values;
}

std::vector<NamedRange> parse_ranges(std::string_view text, const std::vector<QuantityName>& extra) {
    std::vector<NamedRange> ranges;
    for (const auto& [name, value] : pairs_of(text, "gap=0:1,heave_velocity=-0.1:0.1")) {
        const QuantityName& quantity = known_name(name, extra);
        const std::size_t colon = value.find(':');
        if (colon == std::string::npos) {
            throw UsageError("parse", "'" + value + "' is not a range", {}, "write LOWER:UPPER, such as gap=0:1");
        }
        const NamedRange range{name, option_value(value.substr(0, colon), quantity),
                               option_value(value.substr(colon + 1), quantity)};
        if (!(range.lower < range.upper)) {
            throw UsageError("range", "the range of '" + name + "' has its ends swapped or equal: " + value, {},
                             "write the lower end first");
        }
        ranges.push_back(range);
    }
    return ranges;
}

}  // namespace underbody::core
