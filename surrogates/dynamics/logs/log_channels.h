// Channels of a run out of a vehicle's log, or out of a CSV file with names and units of its own: which field of which
// message is which quantity.
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/table.h"
#include "surrogates/dynamics/logs/log.h"

namespace underbody::dynamics {

/// Where one quantity comes from: value = (scale * number, in `unit`) + offset.
struct LogChannel {
    std::string quantity;  ///< of core::quantity_names()
    std::string message;   ///< series of the log; empty: a column of a CSV file
    std::string field;
    std::string unit;         ///< of the number; empty: what the log states, or SI
    double scale = 1;         ///< with its sign
    double offset = 0;        ///< SI, added last
    std::string clock;        ///< field of the same message that says when; empty: the log's own time (CSV: "time")
    std::string clock_unit;   ///< of that field where it states none; empty: LogChannels::clock_unit
    double clock_scale = 1;   ///< multiplies its time: its clock runs at another rate
    double clock_offset = 0;  ///< s, added then: it began at another moment
    core::Place place;        ///< where it was asked for
};

struct LogChannels {
    std::vector<LogChannel> channels;
    std::string clock_unit = "s";  ///< of clock fields that state no unit
    /// Those of logs (true) or of CSV files.
    [[nodiscard]] LogChannels of(bool logs) const;
    /// With "time" as the clock where none is named.
    [[nodiscard]] LogChannels with_csv_clock() const;
};

/// A piece of a log, s on its clock.
struct LogWindow {
    double begin = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();
};

/// One row for each reading of the gap and the heave velocity and for each change of a held input (input_force,
/// jet_voltage, jet_flow), at their own times, s since the log's start; readings within a hundredth of the gap's usual
/// step share a row. Where a gap or velocity has no reading the value is NaN; inputs are held; other quantities are the
/// mean of their readings about the row where they are logged faster, linear between them where slower, and held
/// beyond their ends. Where the clock was set back for good (in all channels as often) rows go on with the times that
/// it had then; else readings whose clock runs backwards are left out, with a warning. Throws core::InputError: a
/// message or field that is not in the log (with the nearest name), or that is there and cannot be read (with the
/// reason), a unit of another dimension, nothing within the window.
core::Table read_log_channels(const std::filesystem::path& log, const LogChannels& channels, const LogWindow& window,
                              core::Problems& problems, core::Progress& progress = core::Progress::none());

/// The same out of a CSV file: headings are names, with or without a unit.
core::Table read_csv_channels(const std::filesystem::path& file, const LogChannels& channels, const LogWindow& window,
                              core::Problems& problems);

class ChannelSink;

/// Sends the rows of a CSV table as the rows of a log to a sink that was made of such channels. `first`: the table is
/// the first piece of the file.
void send_csv(const core::Table& table, const LogChannels& channels, bool first, ChannelSink& sink);

/// Channels of the known quantities among a table's columns, under their own names.
LogChannels channels_by_name(const core::Table& table);

/// Readings of one channel, SI.
struct ChannelReadings {
    std::vector<double> time, value;
};

/// Takes the rows of a log apart into the readings of channels, as they come.
class ChannelSink : public LogSink {
public:
    ChannelSink(const LogChannels& channels, const LogWindow& window);
    bool begin(std::size_t series, const LogSeries& description) override;
    void row(std::size_t series, double time, std::span<const double> values) override;
    /// Called for each reading; the default keeps them all.
    virtual void reading(std::size_t channel, double time, double value);
    /// Throws for a channel that the log does not hold. `end`: of the log.
    void check_all_found(const std::string& log, const LogEnd& end) const;
    [[nodiscard]] std::vector<ChannelReadings>& readings() { return readings_; }
    [[nodiscard]] const LogChannels& channels() const { return channels_; }

private:
    struct Use {
        std::size_t channel = 0, field = 0;
        std::optional<std::size_t> clock;
        double clock_factor = 1, clock_offset = 0, factor = 1, offset = 0;
    };
    void use(std::size_t channel, std::size_t series, const LogSeries& description);
    LogChannels channels_;
    LogWindow window_;
    std::vector<LogSeries> seen_;
    std::map<std::size_t, std::vector<Use>> uses_;
    std::vector<bool> found_;
    std::vector<ChannelReadings> readings_;
};

}  // namespace underbody::dynamics
