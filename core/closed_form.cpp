#include "core/closed_form.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/text.h"

namespace underbody::core {

namespace {

const ClosedForm::Input* find_input(const ClosedForm& form, const std::string& name) {
    const auto found =
        std::find_if(form.inputs.begin(), form.inputs.end(), [&](const auto& input) { return input.name == name; });
    return found == form.inputs.end() ? nullptr : &*found;
}

std::string with_unit(double value, const std::string& unit, int digits) {
    return format_number(value, digits) + (unit == "1" ? "" : " " + unit);
}

/// The name and value of one "name=value".
std::pair<std::string, double> read_input(const ClosedForm& form, std::string_view text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) {
        throw UsageError("parse", "'" + std::string(text) + "' is not of the form name=value", {},
                         "such as " + form.inputs.front().name + "=1");
    }
    const std::string name(trimmed(text.substr(0, equals)));
    const ClosedForm::Input* input = find_input(form, name);
    if (input == nullptr) {
        std::vector<std::string> known;
        for (const auto& other : form.inputs) {
            known.push_back(other.name);
        }
        throw UsageError("name", form.name + " has no input '" + name + "'", {}, did_you_mean(name, known));
    }
    try {
        return {name, parse_in(trimmed(text.substr(equals + 1)), input->unit)};
    } catch (const InputError& error) {
        throw UsageError(error.kind(), name + ": " + error.message(), {}, error.hint());
    }
}

}  // namespace

bool ClosedForm::Result::valid() const {
    return std::all_of(limits.begin(), limits.end(), [](const Limit& limit) { return limit.holds; });
}

double ClosedForm::Result::operator[](const std::string& name) const {
    for (const auto& output : outputs) {
        if (output.name == name) {
            return output.value;
        }
    }
    throw std::out_of_range("ClosedForm: no output '" + name + "'");
}

double ClosedForm::Values::operator()(const std::string& name) const {
    for (const auto& value : values_) {
        if (value.name == name) {
            return value.value;
        }
    }
    throw std::out_of_range("ClosedForm: no input '" + name + "'");
}

namespace {

/// A length, density, viscosity or mass has no other side of nought; nought itself only where it stands for "none".
void check_size(const ClosedForm::Input& input, double value) {
    static const std::vector<std::string> sizes = {"m", "kg", "kg/m^3", "Pa s", "m^2/s"};
    if (std::find(sizes.begin(), sizes.end(), input.unit) == sizes.end()) {
        return;
    }
    const bool may_be_nought = input.unit == "kg" || input.usual == 0.0;
    if (value < 0 || (value == 0 && !may_be_nought)) {
        throw UsageError("range", input.name + " = " + format_number(value, 6) + " " + input.unit + " is " +
                                      (value == 0 ? "nought" : "negative") +
                                      (input.meaning.empty() ? "" : ": it is " + input.meaning));
    }
}

}  // namespace

ClosedForm::Values closed_form_values(const ClosedForm& form, const std::vector<std::string>& given) {
    std::vector<std::pair<std::string, double>> read;
    for (const auto& list : given) {
        for (const auto part : split(list, ',')) {
            if (trimmed(part).empty()) {
                continue;
            }
            auto value = read_input(form, trimmed(part));
            if (std::any_of(read.begin(), read.end(), [&](const auto& other) { return other.first == value.first; })) {
                throw UsageError("duplicate", "'" + value.first + "' is given twice");
            }
            read.push_back(std::move(value));
        }
    }
    ClosedForm::Values values;
    for (const auto& input : form.inputs) {
        const auto found =
            std::find_if(read.begin(), read.end(), [&](const auto& value) { return value.first == input.name; });
        if (found == read.end() && !input.usual) {
            throw UsageError(
                "missing", form.name + " needs " + input.name + ": " + input.meaning, {},
                "add " + input.name + "=..." + (input.unit == "1" ? "" : " in " + input.unit + " or a unit like it"));
        }
        if (found != read.end()) {
            check_size(input, found->second);
        }
        values.set(input.name, found == read.end() ? *input.usual : found->second);
    }
    return values;
}

const ClosedForm& find_closed_form(const std::vector<ClosedForm>& all, const std::string& name) {
    std::vector<std::string> known;
    for (const auto& form : all) {
        if (form.name == name) {
            return form;
        }
        known.push_back(form.name);
    }
    throw UsageError("name", "there is no theory '" + name + "'", {}, did_you_mean(name, known));
}

std::string closed_form_text(const ClosedForm& form, const ClosedForm::Values& values,
                             const ClosedForm::Result& result) {
    std::size_t width = 0;
    for (const auto& output : result.outputs) {
        width = std::max(width, output.name.size());
    }
    std::string text = form.summary + "\n" + form.formula + "   (" + form.source + ")\nwith";
    for (std::size_t i = 0; i < form.inputs.size(); ++i) {
        text += std::string(i == 0 ? " " : ", ") + form.inputs[i].name + " " +
                with_unit(values(form.inputs[i].name), form.inputs[i].unit, 6);
    }
    for (const auto& output : result.outputs) {
        text += "\n  " + output.name + std::string(width - output.name.size() + 2, ' ') +
                with_unit(output.value, output.unit, 7) + "   " + output.meaning;
    }
    for (const auto& limit : result.limits) {
        text += std::string("\n") + (limit.holds ? "holds: " : "OUTSIDE ITS RANGE: ") + limit.text;
    }
    return text;
}

nlohmann::json closed_form_json(const ClosedForm& form, const ClosedForm::Values& values,
                                const ClosedForm::Result& result) {
    nlohmann::json json = {{"theory", form.name},
                           {"summary", form.summary},
                           {"formula", form.formula},
                           {"source", form.source},
                           {"valid", result.valid()}};
    json["inputs"] = nlohmann::json::object();
    for (const auto& value : values.all()) {
        json["inputs"][value.name] = value.value;
    }
    json["values"] = nlohmann::json::object();
    json["results"] = nlohmann::json::array();
    for (const auto& output : result.outputs) {
        json["values"][output.name] = output.value;
        json["results"].push_back(
            {{"name", output.name}, {"value", output.value}, {"unit", output.unit}, {"meaning", output.meaning}});
    }
    json["limits"] = nlohmann::json::array();
    for (const auto& limit : result.limits) {
        json["limits"].push_back({{"text", limit.text}, {"holds", limit.holds}});
    }
    return json;
}

}  // namespace underbody::core
