// A measurement for a study: a data set, a vehicle's log or tables of runs become a [[measurement]] in study.toml, and
// a data set where there is none. Checked before anything is written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

/// Where a quantity stands in a log or in a CSV file with headings of its own.
struct MeasuredChannel {
    std::string quantity;  ///< "gap"
    std::string message;   ///< of a log; empty: a column of a CSV file
    std::string field;
    std::string unit;  ///< empty: as the file states it
    bool operator==(const MeasuredChannel&) const = default;
};

/// "gap=RFND/Dist:cm", "gap=rng_cm:cm", "gap=/range/range"; the message ends at the last '/'.
/// Throws core::UsageError for another form, an unknown quantity (with the nearest).
MeasuredChannel measured_channel(const std::string& text);

struct NewMeasurement {
    std::string name;
    std::vector<std::filesystem::path> data;  ///< a folder with dataset.toml, or logs and tables of runs
    std::filesystem::path model;
    std::vector<MeasuredChannel> channels;
    std::string clock;       ///< field that says when; empty: the log's own time, the column time
    std::string clock_unit;  ///< of that field where it states none
    bool discover = true;
};

struct AddedMeasurement {
    std::filesystem::path file;     ///< study.toml
    std::string text;               ///< of it, with the new lines
    std::filesystem::path dataset;  ///< the dataset.toml that is written; empty: there is one
    std::string dataset_text;
    Study study;
    std::string said;  ///< "2 runs, 1402 rows: time, gap, input_force"
};

/// The study with the measurement; nothing is written but in a folder of its own for a moment, where a new data set is
/// tried. Throws core::InputError and core::UsageError: the study, the model, what is missing in the data (a time
/// series needs time and gap), a name that is taken.
AddedMeasurement with_new_measurement(const std::filesystem::path& folder, const NewMeasurement& measurement);

/// Writes the data set, then study.toml.
void write_added(const AddedMeasurement& added);

/// The other way round: takes out what was written for that measurement, the lines in study.toml and the data set,
/// which stays where it was changed since. Throws core::InputError: the lines were changed since; nothing is written
/// then.
void take_out(const std::filesystem::path& folder, const NewMeasurement& measurement);

/// The data files in what somebody gave: a folder with dataset.toml stays one, of other folders the logs and tables in
/// them, by content.
std::vector<std::filesystem::path> measured_files(const std::vector<std::filesystem::path>& given);

/// True for a data set, a vehicle's log, a table with a gap, and a folder that holds one of these.
bool holds_measurements(const std::filesystem::path& path);

/// A number that a log or a table holds.
struct MeasuredField {
    std::string message;  ///< of a log; empty: a column of a CSV file
    std::string field;
    std::string unit;  ///< as the file states it; empty: it does not
    bool operator==(const MeasuredField&) const = default;
};

/// What the file holds; of a log its whole messages are read. Empty for a data set, which says itself what it holds,
/// and for what is neither. Throws as dynamics::summarise_log.
std::vector<MeasuredField> measured_fields(const std::filesystem::path& file,
                                           core::Progress& progress = core::Progress::none());

/// Channels that these fields name plainly: a range finder is the gap. None where the headings are the program's own.
std::vector<MeasuredChannel> guessed_channels(const std::vector<MeasuredField>& fields);
/// The field that says when, as `NewMeasurement::clock` with its unit behind a ':' where the heading tells it; empty: a
/// log's own time, a column `time`, or no field that looks like a time.
std::string guessed_clock(const std::vector<MeasuredField>& fields);
/// "gap=RFND/Dist:cm": what measured_channel reads.
std::string text_of(const MeasuredChannel& channel);

}  // namespace underbody::cases
