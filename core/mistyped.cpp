#include "core/mistyped.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

std::string mistyped_quantity(const std::string& name) {
    if (find_quantity(name) != nullptr) {
        return {};
    }
    std::vector<std::string> known;
    for (const auto& quantity : quantity_names()) {
        known.push_back(quantity.name);
    }
    return nearest_name(name, known);
}

namespace {

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

/// What loggers and post-processors call them.
const std::map<std::string, std::string>& other_names() {
    static const std::map<std::string, std::string> names = {
        {"t", "time"},
        {"seconds", "time"},
        {"timestamp", "time"},
        {"h", "gap"},
        {"clearance", "gap"},
        {"ride_height", "gap"},
        {"ground_clearance", "gap"},
        {"theta", "pitch"},
        {"trim", "pitch"},
        {"trim_angle", "pitch"},
        {"pitch_angle", "pitch"},
        {"alpha", "pitch"},
        {"aoa", "pitch"},
        {"velocity", "speed"},
        {"flow_speed", "speed"},
        {"u_inf", "speed"},
        {"v_inf", "speed"},
        {"vz", "heave_velocity"},
        {"w", "heave_velocity"},
        {"dhdt", "heave_velocity"},
        {"gap_rate", "heave_velocity"},
        {"heave_rate", "heave_velocity"},
        {"vertical_velocity", "heave_velocity"},
        {"velocity_z", "heave_velocity"},
        {"q", "pitch_rate"},
        {"theta_dot", "pitch_rate"},
        {"voltage", "jet_voltage"},
        {"volts", "jet_voltage"},
        {"u", "input_force"},
        {"control_force", "input_force"},
        {"force_command", "input_force"},
        {"actuator_force", "input_force"},
        {"lift", "lift_force"},
        {"fz", "lift_force"},
        {"drag", "drag_force"},
        {"fx", "drag_force"},
        {"my", "pitch_moment"},
        {"temp", "temperature"},
        {"water_temperature", "temperature"},
    };
    return names;
}

/// By the name alone.
std::string named_like(const std::string& name) {
    const auto words = words_of(name);
    const std::string plain = joined(words);
    if (find_quantity(plain) != nullptr) {
        return plain;
    }
    if (const auto other = other_names().find(plain); other != other_names().end()) {
        return other->second;
    }
    for (const auto& quantity : quantity_names()) {
        if (same_words(words, words_of(quantity.name))) {
            return quantity.name;
        }
    }
    return mistyped_quantity(plain);
}

}  // namespace

std::string meant_quantity(const Column& column) {
    if (find_quantity(column.name) != nullptr || column.name.ends_with("_sigma")) {
        return {};
    }
    const bool numbers =
        !column.is_text() || std::all_of(column.text.begin(), column.text.end(), [](const std::string& field) {
            return trimmed(field).empty() || parse_number(field).has_value();
        });
    const std::string meant = numbers ? named_like(column.name) : std::string();
    return meant.empty() || (!column.is_text() && !same_dimension(column.unit, find_quantity(meant)->unit))
               ? std::string()
               : meant;
}

std::string heading_for(const Column& column, const std::string& quantity) {
    std::string unit = column.is_text() ? find_quantity(quantity)->unit : column.written_unit;
    const std::size_t open = column.name.find('('), close = column.name.find(')');
    if (column.is_text() && open != std::string::npos && close != std::string::npos && close > open) {
        const std::string bracketed(trimmed(column.name.substr(open + 1, close - open - 1)));
        unit = is_unit(bracketed) ? bracketed : unit;
    }
    return "'" + quantity + " [" + unit + "]'";
}

}  // namespace underbody::core
