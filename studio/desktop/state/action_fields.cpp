// Actions on CFD fields: how their files are read and how they are looked at.
#include <algorithm>
#include <filesystem>

#include "core/text.h"
#include "core/units.h"
#include "postproc/field/lists.h"
#include "postproc/loads/mirror_plane.h"
#include "studio/desktop/state/action_parts.h"

namespace underbody::studio::action {

using core::UsageError;

namespace {

/// "surface", or a picture that postproc::views knows.
std::string checked_view(const std::string& text) {
    std::vector<std::string> known = {"surface", "profile-gap"};
    for (const auto& kind : postproc::view_kinds()) {
        known.push_back(kind.name);
    }
    if (std::find(known.begin(), known.end(), text) == known.end()) {
        throw UsageError("unknown", "there is no view '" + text + "'", {}, core::did_you_mean(text, known));
    }
    return text;
}

std::string checked_unit(const std::string& text, const char* of) {
    if (!text.empty() && !(core::is_unit(text) && (of == nullptr || core::same_dimension(text, of)))) {
        throw UsageError("unit", "'" + text + "' is no unit" + (of != nullptr ? " of a length" : ""), {},
                         of != nullptr ? "mm, m, inch ..." : "Pa, m/s ...");
    }
    return text;
}

/// True when the word is a setting and not a file.
bool set_reading(FileReading& reading, const std::string& word) {
    const auto at = word.find('=');
    const std::string key = word.substr(0, at);
    const std::string text = at == std::string::npos ? std::string() : word.substr(at + 1);
    if (at == std::string::npos || key.find('/') != std::string::npos) {
        return false;
    }
    if (key == "length_unit") {
        reading.length_unit = checked_unit(text, "m");
    } else if (key == "symmetry") {
        static_cast<void>(postproc::mirror_plane_from(text));  // says what is wrong with it
        reading.symmetry = text;                               // "none": whole, whatever the study says
    } else if (key == "density") {
        reading.density = number_or_none(text, "kg/m^3");
        if (reading.density && !(*reading.density > 0)) {
            throw UsageError("range", "the density " + text + " is not above nought");
        }
    } else if (key == "zones") {
        reading.zones.clear();
        for (const auto part : core::split(text, ',')) {
            if (!core::trimmed(part).empty()) {
                reading.zones.emplace_back(core::trimmed(part));
            }
        }
    } else if (key.starts_with("unit.")) {
        if (text.empty()) {
            reading.units.erase(key.substr(5));
        } else {
            reading.units[key.substr(5)] = checked_unit(text, nullptr);
        }
    } else if (key.find('.') == std::string::npos) {
        unknown_key(key, {"length_unit", "unit.VARIABLE", "symmetry", "density", "zones"});
    } else {
        return false;
    }
    return true;
}

}  // namespace

State read_as(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "read FILE ... length_unit=mm unit.Pressure=Pa symmetry=y density=998kg/m^3 zones=hull,base");
    FileReading tried;
    std::vector<std::string> files;
    for (const auto& word : words) {
        if (!set_reading(tried, word)) {
            files.push_back(std::filesystem::absolute(word).lexically_normal().string());
        }
    }
    if (files.empty()) {
        throw UsageError("words", "no file is named", {}, "read FILE ... length_unit=mm");
    }
    for (const auto& file : files) {
        if (std::find(state.files.begin(), state.files.end(), "field:" + file) == state.files.end()) {
            throw UsageError("missing", "'" + file + "' is no field from outside the study", {},
                             "add it first: add field FILE");
        }
        FileReading& reading = state.readings[file];
        for (const auto& word : words) {
            set_reading(reading, word);
        }
        if (reading == FileReading{}) {
            state.readings.erase(file);
        }
    }
    return state;
}

namespace {

/// "10mm,0,2mm"; empty: none.
std::optional<std::array<double, 3>> point_from(const std::string& text) {
    if (text.empty()) {
        return {};
    }
    const auto parts = core::split(text, ',');
    if (parts.size() != 3) {
        throw UsageError("parse", "'" + text + "' is no place", {},
                         "X,Y,Z in the axes of the file, such as 10mm,0,2mm");
    }
    return std::array<double, 3>{core::parse_in(parts[0], "m"), core::parse_in(parts[1], "m"),
                                 core::parse_in(parts[2], "m")};
}

}  // namespace

State look_at_fields(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "fields KEY=VALUE ...");
    FieldView& view = state.fields;
    for (const auto& word : words) {
        const auto [key, text] = assignment(word);
        if (key == "array") {
            view.array = text;  // as it is shown, or with the underscores of its name
            std::replace(view.array.begin(), view.array.end(), '_', ' ');
        } else if (key == "whole_range") {
            view.whole_range = yes_or_no(text);
        } else if (key == "edges") {
            view.edges = yes_or_no(text);
        } else if (key == "mirror") {
            view.mirror = yes_or_no(text);
        } else if (key == "view") {
            view.view = checked_view(text);
        } else if (key == "time") {
            view.time = number_or_none(text, "s");
        } else if (key == "probe") {
            view.probe = point_from(text);
        } else if (key == "difference") {
            view.difference = yes_or_no(text);
        } else if (key == "range") {
            view.range = text.empty() ? std::optional<std::array<double, 2>>() : range_of(text, "1");
        } else if (key == "camera") {
            const std::vector<std::string> known = {"iso", "bottom", "top", "side", "front"};
            if (std::find(known.begin(), known.end(), text) == known.end()) {
                unknown_key(text, known);
            }
            view.camera = text;
            view.turned.reset();
        } else if (key.starts_with("zone.")) {
            view.zones[key.substr(5)] = yes_or_no(text);
        } else {
            unknown_key(key, {"array", "whole_range", "edges", "mirror", "difference", "range", "camera", "view",
                              "time", "probe", "zone.NAME"});
        }
    }
    return state;
}

}  // namespace underbody::studio::action
