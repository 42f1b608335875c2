#include "cases/add_measurement.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "core/counted.h"
#include "core/error.h"
#include "core/file.h"
#include "core/heading.h"
#include "core/mistyped.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"
#include "postproc/importers/importer.h"
#include "surrogates/dynamics/logs/log.h"
#include "surrogates/dynamics/logs/log_summary.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

using Heading = core::HeadingText;

/// Of the first line that is no comment; empty for what is no table.
std::vector<Heading> headings_of(const fs::path& file) {
    constexpr std::size_t most = 65536;
    std::string head(most, ' ');
    std::ifstream stream(file, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(most));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    if (constexpr const char* byte_order_mark = "\xef\xbb\xbf"; head.starts_with(byte_order_mark)) {
        head.erase(0, std::char_traits<char>::length(byte_order_mark));
    }
    if (head.find('\0') != std::string::npos) {
        return {};
    }
    for (const auto line : core::split(head, '\n')) {
        const auto text = core::trimmed(line);
        if (text.empty() || text.front() == '#') {
            continue;
        }
        std::vector<Heading> headings;
        for (const auto cell : core::split(text, ',')) {
            headings.push_back(core::heading_text(cell).value_or(Heading{std::string(core::trimmed(cell)), {}}));
        }
        return headings.size() > 1 ? headings : std::vector<Heading>();
    }
    return {};
}

/// "cm" of "rng_cm"; empty where no unit ends the name.
std::string unit_in_name(const std::string& name) {
    const auto bar = name.rfind('_');
    const std::string end = bar == std::string::npos ? "" : name.substr(bar + 1);
    return core::is_unit(end) ? end : "";
}

/// The quantity that a log's heading probably stands for, by the words that tables are read with and by those that
/// loggers begin with: "rng_cm", "Ride height (mm)", "t_us", "stamp". Empty: none that is known.
std::string meant_by(const std::string& field, const std::string& unit) {
    const std::string name = core::plain_name(field);
    const std::string own = unit.empty() ? unit_in_name(name) : "";
    const std::string word = own.empty() ? name : name.substr(0, name.size() - own.size() - 1);
    if (core::find_quantity(word) != nullptr) {
        return word;
    }
    const std::string any = unit.empty() ? own : unit;
    if (const std::string other = core::other_name_of(word, core::Likeness::possible, any); !other.empty()) {
        return word.size() > 1 || !own.empty() ? other : "";  // "T", "h" alone say too little
    }
    constexpr std::pair<const char*, const char*> beginnings[] = {{"time", "time"}, {"t_", "time"},   {"stamp", "time"},
                                                                  {"rng", "gap"},   {"range", "gap"}, {"dist", "gap"},
                                                                  {"gap", "gap"},   {"height", "gap"}};
    for (const auto& [begin, quantity] : beginnings) {
        if (name.starts_with(begin) &&
            (any.empty() || core::same_dimension(any, core::find_quantity(quantity)->unit))) {
            return quantity;
        }
    }
    return {};
}

bool is_log(const fs::path& path) { return !dynamics::log_format(path).empty(); }

/// A table one of whose headings is a quantity, a time or a range.
bool is_table(const fs::path& path) {
    if (!fs::is_regular_file(path) || core::lower_case(path.extension().string()) != ".csv") {
        return false;
    }
    const auto headings = headings_of(path);
    return std::any_of(headings.begin(), headings.end(), [](const Heading& one) {
        const std::string meant = meant_by(one.name, one.unit.value_or(""));
        return meant == "time" || meant == "gap" || core::find_quantity(one.name) != nullptr;
    });
}

/// The channels as they were given, and of tables with them, or with a clock of their own, every other column that is
/// called by a quantity in all files: what [log] does not list is not read.
std::vector<MeasuredChannel> all_channels(const NewMeasurement& measurement, const std::vector<fs::path>& files) {
    std::vector<MeasuredChannel> channels = measurement.channels;
    std::map<std::string, std::size_t> named;  // in how many tables
    std::size_t tables = 0;
    for (const auto& file : files) {
        if (is_log(file)) {
            continue;
        }
        ++tables;
        for (const Heading& one : headings_of(file)) {
            named[one.name] += core::find_quantity(one.name) != nullptr && one.name != "time" ? 1 : 0;
        }
    }
    for (const auto& [name, count] : named) {
        const bool known = std::any_of(channels.begin(), channels.end(), [&n = name](const MeasuredChannel& one) {
            return one.quantity == n || (one.message.empty() && one.field == n);
        });
        if (count == tables && !known && !(channels.empty() && measurement.clock.empty())) {
            channels.push_back({name, "", name, ""});
        }
    }
    return channels;
}

std::string dataset_text(const NewMeasurement& measurement, const std::vector<fs::path>& files, const fs::path& place) {
    bool time = false;
    for (const auto& file : files) {
        const bool log = is_log(file);
        const auto headings = log ? std::vector<Heading>() : headings_of(file);
        time = time || log || !measurement.clock.empty() ||
               std::any_of(headings.begin(), headings.end(), [](const Heading& one) { return one.name == "time"; });
    }
    std::string text = "kind = " + core::toml_string(time ? "time_series" : "static") +
                       "\ntitle = " + core::toml_string(measurement.name) + "\n";
    for (const auto& file : files) {
        const auto relative = file.lexically_relative(place);
        text += "\n[[run]]\nfile = " + core::toml_string((relative.empty() ? file : relative).generic_string()) + "\n";
    }
    const std::vector<MeasuredChannel> channels = all_channels(measurement, files);
    if (!channels.empty() || !measurement.clock.empty()) {
        text += "\n[log]\n";
        text += measurement.clock.empty() ? "" : "clock = " + core::toml_string(measurement.clock) + "\n";
        text +=
            measurement.clock_unit.empty() ? "" : "clock_unit = " + core::toml_string(measurement.clock_unit) + "\n";
    }
    for (const auto& channel : channels) {
        text += "channel." + channel.quantity + " = { ";
        text += channel.message.empty() ? "" : "message = " + core::toml_string(channel.message) + ", ";
        text += "field = " + core::toml_string(channel.field);
        text += (channel.unit.empty() ? "" : ", unit = " + core::toml_string(channel.unit)) + " }\n";
    }
    return text;
}

std::string said_of(const dynamics::Measurements& data) {
    std::size_t rows = 0;
    std::string columns;
    for (const auto& run : data.runs) {
        rows += run.table.rows();
    }
    for (const auto& column : data.runs.front().table.columns()) {
        columns += (columns.empty() ? "" : ", ") + column.name;
    }
    return core::counted(data.runs.size(), "run") + ", " + core::counted(rows, "row") + ": " + columns;
}

/// What a new data set says is tried in a folder of its own, with the paths of the files as they are.
std::string try_data_set(const NewMeasurement& measurement, const std::vector<fs::path>& files) {
    const core::TemporaryFolder trial;
    core::write_file(trial.path() / "dataset.toml", dataset_text(measurement, files, {}));
    try {
        return said_of(dynamics::read_measurements(trial.path()));
    } catch (const core::InputError& error) {
        const bool own = error.place().file.starts_with(trial.path().string());
        throw core::InputError(error.kind(), error.message(), own ? core::Place{} : error.place(), error.hint());
    }
}

}  // namespace

MeasuredChannel measured_channel(const std::string& text) {
    MeasuredChannel channel;
    const auto equal = text.find('=');
    if (equal == std::string::npos || equal == 0 || equal + 1 == text.size()) {
        throw core::UsageError("parse", "'" + text + "' is not of the form quantity=FIELD:unit", {},
                               "gap=rng_cm:cm, or of a log gap=RFND/Dist:m");
    }
    channel.quantity = core::trimmed(std::string_view(text).substr(0, equal));
    if (core::find_quantity(channel.quantity) == nullptr) {
        throw core::UsageError("name", core::no_quantity(channel.quantity), {}, core::quantity_hint(channel.quantity));
    }
    std::string field = text.substr(equal + 1);
    if (const auto colon = field.rfind(':'); colon != std::string::npos && core::is_unit(field.substr(colon + 1))) {
        channel.unit = field.substr(colon + 1);
        field.resize(colon);
    }
    const auto stroke = field.rfind('/');
    channel.message = stroke == std::string::npos || stroke == 0 ? "" : field.substr(0, stroke);
    channel.field = stroke == std::string::npos || stroke == 0 ? field : field.substr(stroke + 1);
    return channel;
}

std::vector<fs::path> measured_files(const std::vector<fs::path>& given) {
    std::vector<fs::path> files;
    for (const auto& one : given) {
        const fs::path path = fs::absolute(one).lexically_normal();
        if (!fs::is_directory(path) || fs::exists(path / "dataset.toml") || is_log(path)) {
            files.push_back(path);
            continue;
        }
        std::vector<fs::path> inside;
        for (const auto& entry : fs::directory_iterator(path)) {
            if (is_log(entry.path()) || is_table(entry.path())) {
                inside.push_back(entry.path());
            }
        }
        std::sort(inside.begin(), inside.end());
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

bool holds_measurements(const fs::path& path) {
    if (path.filename() == "dataset.toml" || fs::exists(path / "dataset.toml") || is_log(path) || is_table(path)) {
        return true;
    }
    if (!fs::is_directory(path) || measured_files({path}).empty()) {
        return false;
    }
    // Tables beside CFD files (loads, monitors) are not what the folder is about.
    return std::none_of(fs::directory_iterator(path), fs::directory_iterator(), [](const fs::directory_entry& entry) {
        return !is_log(entry.path()) && !is_table(entry.path()) && postproc::importer_for(entry.path()) != nullptr;
    });
}

std::vector<MeasuredField> measured_fields(const fs::path& file, core::Progress& progress) {
    std::vector<MeasuredField> fields;
    if (is_log(file)) {
        for (const auto& series : dynamics::summarise_log(file, progress).series) {
            for (const auto& field : series.fields) {
                fields.push_back({series.name, field.name, field.unit});
            }
        }
    } else if (is_table(file)) {
        for (const auto& heading : headings_of(file)) {
            fields.push_back({"", heading.name, heading.unit.value_or("")});
        }
    }
    return fields;
}

std::vector<MeasuredChannel> guessed_channels(const std::vector<MeasuredField>& fields) {
    const std::set<std::string> ranges = {"range", "Dist", "current_distance", "distance"};
    const auto own = std::find_if(fields.begin(), fields.end(),
                                  [](const auto& one) { return one.message.empty() && one.field == "gap"; });
    if (own != fields.end()) {  // the program's own heading: only its unit may be wanting
        return own->unit.empty() ? std::vector<MeasuredChannel>{{"gap", "", "gap", ""}}
                                 : std::vector<MeasuredChannel>{};
    }
    for (const auto& one : fields) {
        if (!one.message.empty() && ranges.contains(one.field)) {
            return {{"gap", one.message, one.field, one.unit.empty() ? "m" : ""}};
        }
        if (one.message.empty() && meant_by(one.field, one.unit) == "gap") {
            return {{"gap", "", one.field, one.unit.empty() ? unit_in_name(core::plain_name(one.field)) : ""}};
        }
    }
    return {};
}

std::string guessed_clock(const std::vector<MeasuredField>& fields) {
    std::string found;
    for (const auto& one : fields) {
        if (!one.message.empty() || one.field == "time") {
            return {};
        }
        if (found.empty() && meant_by(one.field, one.unit) == "time") {
            const std::string unit = one.unit.empty() ? unit_in_name(core::plain_name(one.field)) : "";
            found = one.field + (unit.empty() ? "" : ":" + unit);
        }
    }
    return found;
}

std::string text_of(const MeasuredChannel& channel) {
    return channel.quantity + "=" + (channel.message.empty() ? "" : channel.message + "/") + channel.field +
           (channel.unit.empty() ? "" : ":" + channel.unit);
}

namespace {

/// Where a measurement stands in a study.
struct Place {
    fs::path study;  ///< folder
    std::vector<fs::path> files;
    fs::path data;     ///< what study.toml names
    bool own = false;  ///< a data set that is written for it
};

/// ".." leads on from where links end.
Place place_of(const fs::path& folder, const NewMeasurement& measurement) {
    Place place;
    place.study = fs::weakly_canonical(fs::absolute(folder));
    for (const auto& file : measured_files(measurement.data)) {
        place.files.push_back(fs::weakly_canonical(file));
    }
    if (place.files.empty()) {
        throw core::InputError("missing", "there are no measurements", {},
                               "a folder with dataset.toml, logs, or tables with time and gap");
    }
    const fs::path& first = place.files.front();
    place.data = first.filename() == "dataset.toml" ? first.parent_path() : first;
    place.own = place.files.size() != 1 || !fs::exists(place.data / "dataset.toml");
    if (place.own) {
        place.data = place.study / "measurements" / measurement.name;
    }
    return place;
}

/// The lines of study.toml.
std::string lines_of(const Place& place, const NewMeasurement& measurement, const fs::path& data) {
    const auto relative = [&](const fs::path& path) {
        return fs::weakly_canonical(fs::absolute(path)).lexically_relative(place.study).generic_string();
    };
    return "\n[[measurement]]\nname = " + core::toml_string(measurement.name) +
           "\nmodel = " + core::toml_string(relative(measurement.model)) +
           "\ndata = " + core::toml_string(relative(data)) + (measurement.discover ? "\ndiscover = true\n" : "\n");
}

}  // namespace

AddedMeasurement with_new_measurement(const fs::path& folder, const NewMeasurement& measurement) {
    AddedMeasurement added;
    added.file = folder / "study.toml";
    const Place place = place_of(folder, measurement);
    if (measurement.model.empty()) {
        throw core::InputError("missing", "there is no model to judge the measurements by", {},
                               "a model.toml; `underbody new model` writes one to begin with");
    }
    static_cast<void>(dynamics::read_model(measurement.model));  // says what is wrong with it
    if (!place.own) {
        added.said = said_of(dynamics::read_measurements(place.data));
    } else {
        added.said = try_data_set(measurement, place.files);
        added.dataset = place.data / "dataset.toml";
        if (fs::exists(added.dataset)) {
            throw core::InputError("exists", "there is a data set already", {added.dataset.string(), {}, {}, {}},
                                   "take another name");
        }
        added.dataset_text = dataset_text(measurement, place.files, place.data);
    }
    const std::string before = core::read_file(added.file);
    added.text = before + lines_of(place, measurement, place.data);
    try {  // a data set that is not written yet is no file that could be named
        added.study = Study::from_text(
            before + lines_of(place, measurement, place.own ? place.files.front() : place.data), added.file);
        added.study.measurements.back().data = place.data;
    } catch (const core::InputError& error) {
        throw core::InputError(error.kind(), error.message() + "; nothing was written", {}, error.hint());
    }
    return added;
}

void take_out(const fs::path& folder, const NewMeasurement& measurement) {
    const fs::path file = folder / "study.toml";
    const Place place = place_of(folder, measurement);
    std::string text = core::read_file(file);
    const std::string lines = lines_of(place, measurement, place.data);
    const auto at = text.find(lines);
    if (at == std::string::npos) {
        throw core::InputError("changed",
                               "the lines of the measurement '" + measurement.name +
                                   "' have been changed since they were written, so they stay",
                               {file.string(), {}, {}, {}}, "take them out by hand");
    }
    text.erase(at, lines.size());
    {
        const core::ReplacingAllowed of_the_user;  // who asked for it
        core::write_file(file, text);
    }
    const fs::path dataset = place.data / "dataset.toml";
    if (place.own && fs::exists(dataset) &&
        core::read_file(dataset) == dataset_text(measurement, place.files, place.data)) {
        std::error_code not_empty;  // what else was put there stays
        fs::remove(dataset, not_empty);
        fs::remove(place.data, not_empty);
        fs::remove(place.data.parent_path(), not_empty);
    }
}

void write_added(const AddedMeasurement& added) {
    if (!added.dataset.empty()) {
        fs::create_directories(added.dataset.parent_path());
        core::write_file(added.dataset, added.dataset_text);
    }
    try {
        const core::ReplacingAllowed of_the_user;  // who asked for it
        core::write_file(added.file, added.text);
    } catch (...) {  // half of it would be in the way of the next attempt
        std::error_code ignored;
        fs::remove(added.dataset, ignored);
        fs::remove(added.dataset.parent_path(), ignored);
        throw;
    }
}

}  // namespace underbody::cases
