#include "surrogates/discovery/static/load_cell.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/counted.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/model/measurements.h"

namespace underbody::discovery {

namespace {

/// A stretch of rows at one set point.
struct Block {
    double gap = 0, voltage = 0, direction = 0;
    double begin = 0;
    double middle = 0;  ///< s
    double mean_value = 0;
    double scatter = 0;    ///< standard deviation of a reading
    double effective = 1;  ///< independent readings
    std::size_t row = 0;   ///< first row in the log
    [[nodiscard]] bool on() const { return voltage > 0; }
    [[nodiscard]] double variance() const { return scatter * scatter / effective; }
};

class Reducer {
public:
    Reducer(const core::Table& log, const LoadCellOptions& options) : log_(log), options_(options) {}

    LoadCellReduction run() {
        find_quantity();
        find_blocks();
        take_zeros();
        find_drift();
        find_hysteresis();
        find_friction();
        if (options_.without_thrust) {
            take_thrust_off();
        }
        write();
        return std::move(result_);
    }

private:
    struct Reading {
        const Block* block = nullptr;
        double force = 0;
        double variance = 0;
    };

    [[noreturn]] void refuse(const std::string& message, const std::string& hint) const {
        throw core::InputError("missing", message, core::Place{log_.source, {}, {}, {}}, hint);
    }

    void find_quantity() {
        for (const char* needed : {"time", "gap", "jet_voltage"}) {
            if (log_.find(needed) == nullptr) {
                refuse(std::string("the log of a load cell needs the column ") + needed,
                       "time [s], gap [mm], jet_voltage [V], lift_force [gf]");
            }
        }
        for (const std::string& name : dynamics::force_channels()) {
            if (log_.find(name) != nullptr) {
                if (!quantity_.empty()) {
                    refuse("two readings in one log: " + quantity_ + " and " + name, "reduce them one after the other");
                }
                quantity_ = name;
            }
        }
        if (quantity_.empty()) {
            refuse("no force or moment in the log", "name the reading: lift_force [gf], pitch_moment [N m], ...");
        }
    }

    [[nodiscard]] double volts(std::size_t row) const {
        const double voltage = log_.numbers("jet_voltage")[row];
        return std::isfinite(voltage) ? voltage : 0;
    }
    /// Of the slide; 0 where the log does not say.
    [[nodiscard]] double way(std::size_t row) const {
        const core::Column* direction = log_.find("approach_direction");
        return direction != nullptr && std::isfinite(direction->numbers[row]) ? direction->numbers[row] : 0;
    }

    /// What was read from a row on to before another, once it had settled; nothing without a reading.
    [[nodiscard]] std::optional<Block> block_of(std::size_t begin, std::size_t end) const {
        const std::vector<double>& time = log_.numbers("time");
        const std::vector<double>& reading = log_.numbers(quantity_);
        std::vector<double> values;
        double middle = 0;
        for (std::size_t k = begin; k < end; ++k) {
            if (time[k] >= time[begin] + options_.settle && std::isfinite(reading[k])) {
                values.push_back(reading[k]);
                middle += time[k];
            }
        }
        if (values.empty()) {
            return {};
        }
        const double n = static_cast<double>(values.size());
        Block block{
            log_.numbers("gap")[begin], volts(begin), way(begin), time[begin], middle / n, mean(values), 0, 1, begin};
        double square = 0;
        for (const double value : values) {
            square += (value - block.mean_value) * (value - block.mean_value);
        }
        block.scatter = n > 1 ? std::sqrt(square / (n - 1)) : 0;
        const double r = n > 8 ? std::clamp(autocorrelation(values, 1), 0.0, 0.98) : 0;
        block.effective = std::max(1.0, n * (1 - r) / (1 + r));
        return block;
    }

    void find_blocks() {
        const std::vector<double>& time = log_.numbers("time");
        const std::vector<double>& gap = log_.numbers("gap");
        std::size_t begin = 0;
        std::vector<double> scatters;
        for (std::size_t i = 1; i <= time.size(); ++i) {
            if (i < time.size() && time[i] < time[i - 1]) {
                throw core::InputError("order", "time runs backwards", log_.place(i, "time"),
                                       "one log a day of measuring, in the order of measurement");
            }
            if (i < time.size() && gap[i] == gap[begin] && volts(i) == volts(begin) && way(i) == way(begin)) {
                continue;
            }
            if (const std::optional<Block> block = block_of(begin, i)) {
                scatters.push_back(block->scatter);
                blocks_.push_back(*block);
            }
            begin = i;
        }
        result_.noise = median(scatters);
        if (std::none_of(blocks_.begin(), blocks_.end(), [](const Block& block) { return !block.on(); })) {
            refuse("no block with the pump off: the zero of the load cell is not known",
                   "rows with jet_voltage 0 before and after the others");
        }
    }

    /// The zero at a time from the pump-off blocks of the same gap around it.
    struct Zero {
        double value = 0;
        double variance = 0;
    };
    [[nodiscard]] std::optional<Zero> zero_at(const Block& block, bool& held) const {
        const Block* before = nullptr;
        const Block* after = nullptr;
        const bool own_side = std::any_of(blocks_.begin(), blocks_.end(), [&](const Block& other) {
            return !other.on() && other.gap == block.gap && other.direction == block.direction;
        });
        for (const Block& other : blocks_) {
            if (!other.on() && other.gap == block.gap && (other.direction == block.direction || !own_side)) {
                if (other.middle <= block.middle) {
                    before = &other;
                } else if (after == nullptr) {
                    after = &other;
                }
            }
        }
        held = before == nullptr || after == nullptr;
        if (before == nullptr && after == nullptr) {
            return {};
        }
        if (held) {
            const Block& only = before != nullptr ? *before : *after;
            return Zero{only.mean_value, only.variance()};
        }
        const double share = (block.middle - before->middle) / (after->middle - before->middle);
        return Zero{(1 - share) * before->mean_value + share * after->mean_value,
                    (1 - share) * (1 - share) * before->variance() + share * share * after->variance()};
    }

    void take_zeros() {
        std::size_t held_count = 0;
        std::size_t without = 0;
        for (const Block& block : blocks_) {
            if (!block.on()) {
                continue;
            }
            bool held = false;
            const std::optional<Zero> zero = zero_at(block, held);
            if (!zero) {
                ++without;
                continue;
            }
            held_count += held ? 1 : 0;
            readings_.push_back({&block, block.mean_value - zero->value, block.variance() + zero->variance});
        }
        if (without > 0) {
            warn(core::counted(without, "block has no pump-off block at its gap and was left out",
                               "blocks have no pump-off block at their gap and were left out"));
        }
        if (held_count > 0) {
            warn(core::counted(held_count, "block has", "blocks have") +
                 " a pump-off block on one side only: its value was held, a drift goes into the force");
        }
    }

    /// Slope of the zeros over time, each gap and side of the slide with its own level.
    void find_drift() {
        std::map<std::pair<double, double>, std::vector<const Block*>> zeros;
        for (const Block& block : blocks_) {
            if (!block.on()) {
                zeros[{block.gap, block.direction}].push_back(&block);
            }
        }
        double above = 0, below = 0;
        for (const auto& [level, list] : zeros) {
            double time = 0, value = 0;
            for (const Block* block : list) {
                time += block->middle / static_cast<double>(list.size());
                value += block->mean_value / static_cast<double>(list.size());
            }
            for (const Block* block : list) {
                above += (block->middle - time) * (block->mean_value - value);
                below += (block->middle - time) * (block->middle - time);
            }
        }
        result_.drift_rate = below > 0 ? above / below : std::nan("");
    }

    /// The slide leaves another force when it comes from the other side.
    void find_hysteresis() {
        struct Side {
            double sum = 0, count = 0;
        };
        std::map<std::pair<double, double>, std::map<double, Side>> points;
        for (const Reading& reading : readings_) {
            Side& side = points[{reading.block->gap, reading.block->voltage}][reading.block->direction];
            side.sum += reading.force;
            side.count += 1;
        }
        double sum = 0, count = 0;
        for (const auto& [point, sides] : points) {
            if (sides.size() == 2) {
                const Side& low = sides.begin()->second;
                const Side& high = sides.rbegin()->second;
                sum += 0.5 * (high.sum / high.count - low.sum / low.count);
                count += 1;
            }
        }
        result_.hysteresis = count > 0 ? sum / count : 0;
    }

    /// Blocks at one gap and voltage differ by more than their noise: the slide sticks, from one side or the other.
    void find_friction() {
        std::map<std::pair<double, double>, std::vector<const Reading*>> points;
        for (const Reading& reading : readings_) {
            points[{reading.block->gap, reading.block->voltage}].push_back(&reading);
        }
        double square = 0, expected = 0, degrees = 0;
        for (const auto& [point, list] : points) {
            const double n = static_cast<double>(list.size());
            if (n < 2) {
                continue;
            }
            double middle = 0;
            for (const Reading* reading : list) {
                middle += reading->force / n;
            }
            for (const Reading* reading : list) {
                square += (reading->force - middle) * (reading->force - middle);
                expected += reading->variance * (n - 1) / n;
            }
            degrees += n - 1;
        }
        if (degrees > 0) {
            result_.friction = std::sqrt(std::max(0.0, (square - expected) / degrees));
        } else {
            warn(
                "no set point was measured twice: the friction of the slide is not known and not in the sigmas, which "
                "are too small by it");
        }
    }

    void take_thrust_off() {
        std::map<double, std::pair<double, double>> far;  // voltage -> gap, force
        for (const Reading& reading : readings_) {
            auto& [gap, force] = far.try_emplace(reading.block->voltage, -1, 0).first->second;
            if (reading.block->gap >= gap) {
                gap = reading.block->gap;
                force = reading.force;
            }
        }
        for (Reading& reading : readings_) {
            reading.force -= far.at(reading.block->voltage).second;
        }
        note("the force at the largest gap of each voltage was taken off as the thrust of the free jet");
    }

    void write() {
        std::vector<double> time, gap, voltage, direction, force, sigma;
        for (const Reading& reading : readings_) {
            time.push_back(reading.block->middle);
            gap.push_back(reading.block->gap);
            voltage.push_back(reading.block->voltage);
            direction.push_back(reading.block->direction);
            force.push_back(reading.force);
            sigma.push_back(std::sqrt(reading.variance + result_.friction * result_.friction));
        }
        const std::string unit = core::find_quantity(quantity_)->unit;
        result_.table.source = log_.source;
        result_.table.comments.push_back(
            " reduced from " + log_.source +
            ": mean of each pump-on block less the zero between the pump-off blocks around it");
        result_.table.add_numbers("time", "s", time);
        result_.table.add_numbers("gap", "m", gap);
        result_.table.add_numbers("jet_voltage", "V", voltage);
        if (log_.find("approach_direction") != nullptr) {
            result_.table.add_numbers("approach_direction", "1", direction);
        }
        result_.table.add_numbers(quantity_, unit, force);
        result_.table.add_numbers(quantity_ + "_sigma", unit, sigma);
    }

    void warn(const std::string& text) {
        result_.problems.push_back({core::Problem::Severity::warning, text, core::Place{log_.source, {}, {}, {}}});
    }
    void note(const std::string& text) {
        result_.problems.push_back({core::Problem::Severity::note, text, core::Place{log_.source, {}, {}, {}}});
    }

    const core::Table& log_;
    const LoadCellOptions& options_;
    std::string quantity_;
    std::vector<Block> blocks_;
    std::vector<Reading> readings_;
    LoadCellReduction result_;
};

}  // namespace

bool is_load_cell_log(const core::Table& table) {
    const core::Column* gap = table.find("gap");
    const core::Column* voltage = table.find("jet_voltage");
    if (gap == nullptr || voltage == nullptr || table.find("time") == nullptr || gap->is_text() || voltage->is_text()) {
        return false;
    }
    const auto forces = std::count_if(dynamics::force_channels().begin(), dynamics::force_channels().end(),
                                      [&](const std::string& name) { return table.find(name) != nullptr; });
    std::vector<double> lengths;
    std::size_t begin = 0;
    bool off = false;
    for (std::size_t i = 1; i <= table.rows(); ++i) {
        if (i == table.rows() || gap->numbers[i] != gap->numbers[begin] ||
            voltage->numbers[i] != voltage->numbers[begin]) {
            lengths.push_back(static_cast<double>(i - begin));
            off = off || voltage->numbers[begin] == 0;
            begin = i;
        }
    }
    return forces == 1 && off && lengths.size() >= 3 && median(lengths) >= 5;
}

std::string reduction_text(const LoadCellReduction& reduction) {
    std::string unit;
    for (const core::Column& column : reduction.table.columns()) {
        if (reduction.table.find(column.name + "_sigma") != nullptr) {
            unit = column.unit;
        }
    }
    const auto with_unit = [&](double value) { return value_text({"", value, 0, unit}); };
    return std::to_string(reduction.table.rows()) + " set points by their pump-off blocks; " +
           (std::isfinite(reduction.drift_rate)
                ? "the zero drifts by " + with_unit(3600 * reduction.drift_rate) + " an hour"
                : "the drift of the zero is not known (no gap has two pump-off blocks)") +
           (reduction.hysteresis != 0 ? ", hysteresis of the slide +-" + with_unit(std::abs(reduction.hysteresis))
                                      : "") +
           ", friction between repeats " + with_unit(reduction.friction) + ", noise of a reading " +
           with_unit(reduction.noise);
}

LoadCellReduction reduce_load_cell(const core::Table& log, const LoadCellOptions& options) {
    return Reducer(log, options).run();
}

}  // namespace underbody::discovery
