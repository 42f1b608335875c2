#include "surrogates/dynamics/model/run_pieces.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <utility>

#include "core/counted.h"
#include "core/no_limit.h"
#include "core/quantile.h"
#include "core/text.h"

namespace underbody::dynamics {

namespace {

constexpr double day = 86400;                                // s
constexpr double shortest_pause = 60, steps_of_pause = 100;  // s; usual steps
constexpr double longest_pause = 30 * day;                   // s: no rig waits longer, its clock was set
constexpr double absolute = 1e8;                             // s: no rig runs so long, its clock counts from 1970
constexpr std::size_t least_rows = 20;                       // of a piece
constexpr double least_share = 0.1, most_left_out = 0.25;    // of the longest piece; of all rows

enum class Cut { begin, pause, set_on, set_back };

struct Piece {
    Cut cut = Cut::begin;  ///< before its first row
    std::size_t first = 0, last = 0;
    [[nodiscard]] std::size_t rows() const { return last - first; }
};

std::vector<Piece> cut(const std::vector<double>& time, double usual, bool at_pauses) {
    const double pause = std::max(shortest_pause, steps_of_pause * usual);
    std::vector<Piece> pieces{{Cut::begin, 0, time.size()}};
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double step = time[i] - time[i - 1];
        const Cut here = step < 0                                ? Cut::set_back
                         : step > std::max(longest_pause, pause) ? Cut::set_on
                         : at_pauses && step > pause             ? Cut::pause
                                                                 : Cut::begin;
        if (here != Cut::begin) {
            pieces.back().last = i;
            pieces.push_back({here, i, time.size()});
        }
    }
    return pieces;
}

std::size_t longest(const std::vector<Piece>& pieces) {
    std::size_t most = 0;
    for (const Piece& piece : pieces) {
        most = std::max(most, piece.rows());
    }
    return most;
}

bool long_enough(const Piece& piece, std::size_t longest) {
    return piece.rows() >= least_rows &&
           static_cast<double>(piece.rows()) >= least_share * static_cast<double>(longest);
}

bool too_much_left_out(const std::vector<Piece>& pieces) {
    const std::size_t most = longest(pieces);
    std::size_t left_out = 0, all = 0;
    for (const Piece& piece : pieces) {
        all += piece.rows();
        left_out += long_enough(piece, most) ? 0 : piece.rows();
    }
    return static_cast<double>(left_out) > most_left_out * static_cast<double>(all);
}

/// "1.01 s", "55.9 years".
std::string long_time(double seconds) {
    constexpr double year = 365.25 * day;
    return seconds > year  ? core::format_number(seconds / year, 3) + " years"
           : seconds > day ? core::format_number(seconds / day, 3) + " days"
                           : core::format_number(seconds, 4) + " s";
}

/// "2025-11-28 13:38:56 UTC", of seconds since 1970.
std::string date(double seconds) {
    const auto whole = static_cast<std::time_t>(seconds);
    std::tm parts{};
    ::gmtime_r(&whole, &parts);
    char text[64];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &parts);
    return text;
}

std::string what_happened(const Piece& piece, const std::vector<double>& time) {
    const double step = time[piece.first] - time[piece.first - 1];
    return piece.cut == Cut::pause
               ? "nothing was logged for " + long_time(step) + " before this row"
               : "the clock was set " + std::string(step < 0 ? "back" : "on") + " by " + long_time(std::abs(step)) +
                     " before this row; its times are counted on from the row before";
}

/// The table with its times less `offset`.
core::Table with_times_less(const core::Table& table, double offset) {
    core::Table moved;
    moved.source = table.source;
    moved.comments = table.comments;
    for (const core::Column& column : table.columns()) {
        if (column.is_text()) {
            moved.add_text(column.name, column.text);
            continue;
        }
        std::vector<double> numbers = column.numbers;
        if (column.name == "time") {
            for (double& t : numbers) {
                t -= offset;
            }
        }
        moved.add_numbers(column.name, column.unit, std::move(numbers), column.written_unit);
    }
    return moved;
}

/// Throws where time stands still, and where its pieces are too short to be runs.
void check_order(const MeasuredRun& run, const std::vector<Piece>& pieces) {
    const std::vector<double>& time = run.table.numbers("time");
    const auto throw_at = [&](std::size_t i, const std::string& what, const std::string& hint) {
        throw core::InputError("order",
                               "time " + what + " from " + core::format_number(time[i - 1], 14) + " s to " +
                                   core::format_number(time[i], 14) + " s",
                               run.table.place(i, "time"), hint);
    };
    const auto still = std::adjacent_find(time.begin(), time.end());
    if (still != time.end()) {
        throw_at(static_cast<std::size_t>(still - time.begin()) + 1, "stands still",
                 "rows of one time are rows written twice, or times written with too few digits: seconds since 1970 "
                 "need twelve digits and more");
    }
    if (pieces.size() > 1 && too_much_left_out(pieces)) {
        const bool back = pieces[1].cut == Cut::set_back;
        throw_at(pieces[1].first, back ? "runs backwards" : "jumps",
                 "if the logger started anew here or its clock was set, make two runs of the file; the other runs can "
                 "be used as they are");
    }
}

void move_clock(MeasuredRun& run, double offset) {
    run.table = with_times_less(run.table, offset);
    run.clock_offset += offset;
}

}  // namespace

std::vector<MeasuredRun> pieces_of(const MeasuredRun& run, core::Problems& problems) {
    const std::vector<double>& time = run.table.numbers("time");
    const double usual = core::usual_step(time);
    std::vector<Piece> pieces = cut(time, usual, true);
    if (too_much_left_out(pieces)) {
        pieces = cut(time, usual, false);
    }
    check_order(run, pieces);
    if (pieces.size() == 1) {
        return {run};
    }
    const std::size_t most = longest(pieces);
    std::vector<MeasuredRun> runs;
    double offset = 0;
    for (const Piece& piece : pieces) {
        if (piece.cut == Cut::set_on || piece.cut == Cut::set_back) {
            offset += time[piece.first] - time[piece.first - 1] - usual;
        }
        const bool kept = long_enough(piece, most);
        const core::Place place = run.table.place(piece.first, "time");
        if (piece.cut != Cut::begin) {
            problems.push_back(
                {core::Problem::Severity::warning, what_happened(piece, time) + ": read as a run of its own", place});
        }
        if (!kept) {
            problems.push_back({core::Problem::Severity::warning,
                                "the " + core::counted(piece.rows(), "row") +
                                    " from here to where the clock or the log is interrupted are left out: too few "
                                    "beside the rest",
                                place});
            continue;
        }
        std::vector<std::size_t> rows(piece.rows());
        std::iota(rows.begin(), rows.end(), piece.first);
        MeasuredRun one = run;
        one.name += runs.empty() ? "" : " piece " + std::to_string(runs.size() + 1);
        one.table = run.table.selected(rows);
        if (offset != 0) {
            move_clock(one, offset);
        }
        runs.push_back(std::move(one));
    }
    return runs;
}

void count_from_first_reading(Measurements& data) {
    double first = core::no_limit;
    std::vector<MeasuredRun*> counted;
    for (MeasuredRun& run : data.runs) {
        const double begin = run.table.numbers("time").front();
        if (begin > absolute) {
            first = std::min(first, std::floor(begin));
            counted.push_back(&run);
        }
    }
    for (MeasuredRun* run : counted) {
        move_clock(*run, first);
    }
    if (!counted.empty()) {
        data.problems.push_back({core::Problem::Severity::note,
                                 "times are counted from " + core::format_number(first) +
                                     " s of the clock of the logs (" + date(first) + " if it counts from 1970)",
                                 core::Place{counted.front()->table.source, {}, {}, {}}});
    }
}

}  // namespace underbody::dynamics
