#include "core/mistyped.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

namespace {

std::vector<std::string> all_quantities() {
    std::vector<std::string> known;
    for (const auto& quantity : quantity_names()) {
        known.push_back(quantity.name);
    }
    return known;
}

}  // namespace

std::string mistyped_quantity(const std::string& name) {
    return find_quantity(name) != nullptr ? std::string() : nearest_name(name, all_quantities());
}

std::string no_quantity(const std::string& name) { return "there is no quantity '" + name + "'"; }

std::string quantity_hint(const std::string& name) { return did_you_mean(name, all_quantities()); }

namespace {

constexpr std::string_view sigma_ending = "_sigma";

/// The name without the ending of a standard deviation.
std::string without_sigma(const std::string& name) {
    return name.ends_with(sigma_ending) ? name.substr(0, name.size() - sigma_ending.size()) : name;
}

/// "sgima", "std": what stands behind a quantity's name where "sigma" should.
bool means_sigma(const std::string& ending) {
    static const std::vector<std::string> words = {"sd",  "std", "stdev", "stddev",
                                                   "dev", "err", "error", "uncertainty"};
    return std::find(words.begin(), words.end(), ending) != words.end() ||
           (ending.size() >= 4 && !nearest_name(ending, {"sigma"}).empty());
}

/// "Gap (mm)" -> {"gap"}, "force_in" -> {"force", "in"}; what stands in round brackets is no part of the name.
std::vector<std::string> words_of(const std::string& name) {
    std::vector<std::string> words(1);
    for (const char c : lower_case(name.substr(0, name.find('(')))) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
            words.back() += c;
        } else if (!words.back().empty()) {
            words.emplace_back();
        }
    }
    if (words.back().empty()) {
        words.pop_back();
    }
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) {
        text += (text.empty() ? "" : "_") + word;
    }
    return text;
}

/// The same words, some cut short, in any order: {"force", "in"} and {"input", "force"}.
bool same_words(const std::vector<std::string>& given, std::vector<std::string> wanted) {
    if (given.size() != wanted.size()) {
        return false;
    }
    for (const auto& word : given) {
        const auto at = std::find_if(wanted.begin(), wanted.end(), [&](const std::string& other) {
            return other.starts_with(word) && word.size() >= 2;
        });
        if (at == wanted.end()) {
            return false;
        }
        wanted.erase(at);
    }
    return true;
}

/// What people call them who draw, log and post-process; the surest first.
struct OtherName {
    const char* word;
    const char* quantity;
    Likeness likeness;
};
constexpr OtherName other_names[] = {
    {"ride_height", "gap", Likeness::certain},
    {"clearance", "gap", Likeness::certain},
    {"ground_clearance", "gap", Likeness::certain},
    {"gap_height", "gap", Likeness::certain},
    {"pitch_angle", "pitch", Likeness::certain},
    {"angle_of_attack", "pitch", Likeness::certain},
    {"aoa", "pitch", Likeness::certain},
    {"velocity", "speed", Likeness::certain},
    {"inlet_velocity", "speed", Likeness::certain},
    {"inlet_speed", "speed", Likeness::certain},
    {"free_stream_velocity", "speed", Likeness::certain},
    {"freestream_velocity", "speed", Likeness::certain},
    {"vehicle_speed", "speed", Likeness::certain},
    {"voltage", "jet_voltage", Likeness::certain},
    {"water_temperature", "temperature", Likeness::certain},
    {"t", "time", Likeness::usual},
    {"seconds", "time", Likeness::usual},
    {"timestamp", "time", Likeness::usual},
    {"h", "gap", Likeness::usual},
    {"theta", "pitch", Likeness::usual},
    {"trim", "pitch", Likeness::usual},
    {"trim_angle", "pitch", Likeness::usual},
    {"alpha", "pitch", Likeness::usual},
    {"flow_speed", "speed", Likeness::usual},
    {"u_inf", "speed", Likeness::usual},
    {"v_inf", "speed", Likeness::usual},
    {"vz", "heave_velocity", Likeness::usual},
    {"w", "heave_velocity", Likeness::usual},
    {"dhdt", "heave_velocity", Likeness::usual},
    {"gap_rate", "heave_velocity", Likeness::usual},
    {"heave_rate", "heave_velocity", Likeness::usual},
    {"vertical_velocity", "heave_velocity", Likeness::usual},
    {"velocity_z", "heave_velocity", Likeness::usual},
    {"q", "pitch_rate", Likeness::usual},
    {"theta_dot", "pitch_rate", Likeness::usual},
    {"volts", "jet_voltage", Likeness::usual},
    {"u", "input_force", Likeness::usual},
    {"control_force", "input_force", Likeness::usual},
    {"force_command", "input_force", Likeness::usual},
    {"actuator_force", "input_force", Likeness::usual},
    {"lift", "lift_force", Likeness::usual},
    {"fz", "lift_force", Likeness::usual},
    {"drag", "drag_force", Likeness::usual},
    {"fx", "drag_force", Likeness::usual},
    {"my", "pitch_moment", Likeness::usual},
    {"temp", "temperature", Likeness::usual},
    {"height", "gap", Likeness::possible},
    {"distance", "gap", Likeness::possible},
    {"angle", "pitch", Likeness::possible},
    {"u", "speed", Likeness::possible},
    {"v", "speed", Likeness::possible},
    {"flow", "jet_flow", Likeness::possible},
    {"flow_rate", "jet_flow", Likeness::possible},
    {"sink_rate", "heave_velocity", Likeness::possible},
};

/// By the name alone.
std::string named_like(const std::string& name, Likeness likeness, const std::string& unit) {
    const auto words = words_of(name);
    const std::string plain = joined(words);
    if (find_quantity(plain) != nullptr) {
        return plain;
    }
    if (std::string other = other_name_of(plain, likeness, unit); !other.empty()) {
        return other;
    }
    for (const auto& quantity : quantity_names()) {
        if (same_words(words, words_of(quantity.name))) {
            return quantity.name;
        }
    }
    return mistyped_quantity(plain);
}

}  // namespace

std::string plain_name(const std::string& name) { return joined(words_of(name)); }

std::string other_name_of(const std::string& word, Likeness likeness, const std::string& unit) {
    for (const auto& other : other_names) {
        if (word == other.word && other.likeness <= likeness &&
            (unit.empty() || same_dimension(unit, find_quantity(other.quantity)->unit))) {
            return other.quantity;
        }
    }
    return {};
}

std::string meant_quantity(const Column& column, Likeness likeness) {
    if (find_quantity(column.name) != nullptr || column.name.ends_with("_sigma")) {
        return {};
    }
    const bool numbers =
        !column.is_text() || std::all_of(column.text.begin(), column.text.end(), [](const std::string& field) {
            return trimmed(field).empty() || parse_number(field).has_value();
        });
    const std::string meant =
        numbers ? named_like(column.name, likeness, column.is_text() ? "" : column.unit) : std::string();
    return meant.empty() || (!column.is_text() && !same_dimension(column.unit, find_quantity(meant)->unit))
               ? std::string()
               : meant;
}

std::string meant_name(const Column& column, Likeness likeness) {
    if (const std::string base = without_sigma(column.name); base != column.name) {
        Column of_base = column;
        of_base.name = base;
        const std::string meant = meant_quantity(of_base, likeness);
        return meant.empty() ? meant : meant + std::string(sigma_ending);
    }
    const std::string plain = plain_name(column.name);
    for (const auto& quantity : quantity_names()) {
        const std::string before = std::string(quantity.name) + "_";
        if (plain.starts_with(before) && means_sigma(plain.substr(before.size())) &&
            (column.is_text() || same_dimension(column.unit, quantity.unit))) {
            return before + std::string(sigma_ending.substr(1));
        }
    }
    return meant_quantity(column, likeness);
}

std::string heading_for(const Column& column, const std::string& name) {
    std::string unit = column.is_text() ? find_quantity(without_sigma(name))->unit : column.written_unit;
    const std::size_t open = column.name.find('('), close = column.name.find(')');
    if (column.is_text() && open != std::string::npos && close != std::string::npos && close > open) {
        const std::string bracketed(trimmed(column.name.substr(open + 1, close - open - 1)));
        unit = is_unit(bracketed) ? bracketed : unit;
    }
    return "'" + name + " [" + unit + "]'";
}

}  // namespace underbody::core
