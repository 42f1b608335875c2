#include "surrogates/dynamics/model/force_tables.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/model/vehicle_forces.h"
#include "surrogates/tables/fit/table_batch.h"
#include "surrogates/tables/points/select.h"

namespace underbody::dynamics {

namespace {

using tables::ForceTable;

/// One axis of a table of the model that lies along a channel.
struct TableAxisOf {
    const ForceTable* table = nullptr;
    std::size_t axis = 0;
    std::string quantity;
    bool correction = false;

    [[nodiscard]] const tables::TableAxis& get() const { return table->axes()[axis]; }
};

std::vector<TableAxisOf> table_axes(const Model& model, Channel channel) {
    std::vector<TableAxisOf> found;
    const auto take = [&](const ForceTable& table, const std::string& quantity, bool correction) {
        for (std::size_t k = 0; k < table.axes().size(); ++k) {
            Channel own{};
            if (find_channel(table.axes()[k].name, own) && own == channel) {
                found.push_back({&table, k, quantity, correction});
            }
        }
    };
    for (const ForceSource& source : model.forces) {
        take(source.table, source.quantity, false);
    }
    for (const EffectUse& use : model.effects) {
        if (use.table) {
            take(*use.table, use.quantity.empty() ? use.table->quantity() : use.quantity, true);
        }
    }
    return found;
}

/// A channel as an axis of all quantities.
struct ModelAxis {
    Channel channel{};
    double lower = 0, upper = 0;  ///< ends of the grid
    std::vector<TableAxisOf> tables;
};

class Maker {
public:
    Maker(const Model& declared, const ForceTablesOptions& options, core::Progress& progress)
        : model_(of_the_vehicle(declared, out_.remarks)), options_(options), progress_(progress), held_(options.held) {
        // With its declared parameters as effects, so that their errors count.
        with_errors_ = declared;
        std::erase_if(with_errors_.effects, [](const EffectUse& use) {
            const EffectInfo& info = effect(use.name).info();
            return info.belongs_to_the_rig || info.seen_in == SeenIn::time_series;
        });
        quantities_ = options.quantities.empty() ? model_.quantities() : options.quantities;
        for (const std::string& quantity : quantities_) {
            const auto known = model_.quantities();
            if (std::find(known.begin(), known.end(), quantity) == known.end()) {
                throw core::UsageError("name", "the model has no force source of '" + quantity + "'",
                                       {model_.name, {}, {}, {}}, core::did_you_mean(quantity, known));
            }
        }
    }

    ForceTables made() {
        choose_axes();
        std::vector<Channel> channels;
        for (const ModelAxis& axis : axes_) {
            channels.push_back(axis.channel);
        }
        hold_the_rest(channels);
        hold_scales(model_, channels, held_, out_.remarks);
        list_held(channels);
        for (const std::string& quantity : quantities_) {
            models_.emplace_back(model_, quantity);
        }
        make_points(channels);
        for (std::size_t q = 0; q < quantities_.size(); ++q) {
            out_.tables.push_back(tables::sampled_table(function(q, channels), options_.sampling, progress_));
        }
        return std::move(out_);
    }

private:
    [[nodiscard]] bool concerns(const TableAxisOf& axis, const std::string& quantity) const {
        return axis.quantity == quantity;
    }

    void choose_axes() {
        if (options_.axes.empty()) {
            for (std::size_t i = 0; i < channel_count; ++i) {
                const auto channel = static_cast<Channel>(i);
                const bool asked =
                    std::find(options_.asked.begin(), options_.asked.end(), channel) != options_.asked.end();
                const bool by_condition = model_.conditions.has(channel) && channel != Channel::gap && !asked;
                if (held_.has(channel) || table_axes(model_, channel).empty()) {
                    continue;
                }
                if (by_condition) {
                    held_[channel] = model_.conditions[channel];
                } else {
                    add_axis({channel_name(channel), {}, {}});
                }
            }
        }
        for (const ForceAxis& axis : options_.axes) {
            add_axis(axis);
        }
        if (axes_.empty()) {
            throw core::UsageError("axis", "all axes of the model's tables are held: nothing is left to vary",
                                   {model_.name, {}, {}, {}});
        }
        if (axes_.size() > tables::max_axes) {
            std::string names;
            for (const ModelAxis& axis : axes_) {
                names += (names.empty() ? "" : ", ") + std::string(channel_name(axis.channel));
            }
            throw core::UsageError(
                "axis", "a table has at most " + std::to_string(tables::max_axes) + " axes, here these vary: " + names,
                {model_.name, {}, {}, {}}, "name the axes to use, or hold one");
        }
    }

    void add_axis(const ForceAxis& asked) {
        ModelAxis axis;
        if (!find_channel(asked.name, axis.channel)) {
            throw core::UsageError("name", "there is no axis '" + asked.name + "'", {},
                                   core::did_you_mean(asked.name, channel_names()));
        }
        for (const ModelAxis& other : axes_) {
            if (other.channel == axis.channel) {
                throw core::UsageError("axis", "axis '" + asked.name + "' is named twice");
            }
        }
        axis.tables = table_axes(model_, axis.channel);
        if (axis.tables.empty()) {
            scale_range(asked, axis);
        } else {
            axis.lower = INFINITY;
            axis.upper = -INFINITY;
            for (const TableAxisOf& own : axis.tables) {
                axis.lower = std::min(axis.lower, own.get().lower);
                axis.upper = std::max(axis.upper, own.get().upper);
            }
            if (asked.lower.value_or(axis.lower) < axis.lower || asked.upper.value_or(axis.upper) > axis.upper) {
                out_.remarks.push_back(
                    {core::Problem::Severity::warning,
                     asked.name + " is asked from " +
                         core::told_range(asked.lower.value_or(axis.lower), asked.upper.value_or(axis.upper),
                                          channel_unit(axis.channel)) +
                         ", the tables of the model cover " +
                         core::told_range(axis.lower, axis.upper, channel_unit(axis.channel)) + ": it ends with them",
                     {model_.name, {}, {}, {}}});
            }
            axis.lower = std::max(axis.lower, asked.lower.value_or(axis.lower));
            axis.upper = std::min(axis.upper, asked.upper.value_or(axis.upper));
        }
        if (!(axis.lower < axis.upper)) {
            throw core::UsageError("range", "the range of axis '" + asked.name + "' is empty, " +
                                                core::format_number(axis.lower, 6) + " to " +
                                                core::format_number(axis.upper, 6) + " " + channel_unit(axis.channel));
        }
        axes_.push_back(std::move(axis));
    }

    /// Of a channel that scales forces, or that an effect knows.
    void scale_range(const ForceAxis& asked, ModelAxis& axis) {
        double reference = 0;
        for (const ForceSource& source : model_.forces) {
            for (const ForceScale& scale : source.scales) {
                reference = scale.channel == axis.channel ? std::max(reference, scale.reference) : reference;
            }
        }
        if (!matters(axis.channel)) {
            throw core::UsageError("axis", "no force of the model depends on " + asked.name, {model_.name, {}, {}, {}},
                                   "its forces depend on their tables' axes and scales");
        }
        if (reference == 0 && !(asked.lower && asked.upper)) {
            throw core::UsageError("range", "nothing says the range of axis '" + asked.name + "'",
                                   {model_.name, {}, {}, {}}, "give it: " + asked.name + "=LOWER:UPPER");
        }
        axis.lower = asked.lower.value_or(0.0);
        axis.upper = asked.upper.value_or(2 * reference);
        if (!asked.upper) {
            out_.remarks.push_back({core::Problem::Severity::note,
                                    asked.name + " runs from " + core::format_number(axis.lower, 6) + " to " +
                                        core::format_number(axis.upper, 6) + " " + channel_unit(axis.channel) +
                                        ", twice the reference of its scale",
                                    {model_.name, {}, {}, {}}});
        }
    }

    /// Axes of tables that are no axes of the result and that nothing holds.
    void hold_the_rest(const std::vector<Channel>& channels) {
        for (const Channel channel : {Channel::pitch, Channel::pitch_rate, Channel::heave_velocity}) {
            const bool free = std::find(channels.begin(), channels.end(), channel) == channels.end();
            if (free && !held_.has(channel) && !model_.conditions.has(channel) &&
                !table_axes(model_, channel).empty()) {
                held_[channel] = 0;
                out_.remarks.push_back({core::Problem::Severity::note,
                                        std::string(channel_name(channel)) + " is held at 0",
                                        {model_.name, {}, {}, {}}});
            }
        }
    }

    /// What the forces depend on beside the axes.
    void list_held(const std::vector<Channel>& channels) {
        for (std::size_t i = 0; i < channel_count; ++i) {
            const auto channel = static_cast<Channel>(i);
            if (std::find(channels.begin(), channels.end(), channel) != channels.end() || !matters(channel)) {
                continue;
            }
            if (options_.held.has(channel)) {
                out_.held.push_back({channel, options_.held[channel], "given"});
            } else if (model_.conditions.has(channel)) {
                out_.held.push_back({channel, model_.conditions[channel], "condition of the model"});
            } else if (held_.has(channel)) {
                const bool by_table = !table_axes(model_, channel).empty();
                out_.held.push_back({channel, held_[channel], by_table ? "default" : "reference of its scale"});
            }
        }
    }

    /// Does a table, a scale, the coupling or an effect know the channel?
    [[nodiscard]] bool matters(Channel channel) const {
        bool known = !table_axes(model_, channel).empty() ||
                     (channel == Channel::speed && model_.coupling.kind == Coupling::Kind::sheltered);
        for (const ForceSource& source : model_.forces) {
            known = known || std::any_of(source.scales.begin(), source.scales.end(),
                                         [&](const ForceScale& scale) { return scale.channel == channel; });
        }
        for (const EffectUse& use : model_.effects) {
            const auto& depends = effect(use.name).info().depends_on;
            known = known || std::find(depends.begin(), depends.end(), channel_name(channel)) != depends.end();
        }
        return known;
    }

    [[nodiscard]] Conditions at(const std::vector<Channel>& channels, const double* point) const {
        Conditions conditions = held_;
        for (std::size_t k = 0; k < channels.size(); ++k) {
            conditions[channels[k]] = point[k];
        }
        return conditions;
    }

    /// Set points of the tables, with every quantity, to show what the forces are made of.
    void make_points(const std::vector<Channel>& channels) {
        std::vector<std::vector<double>> grid;
        std::size_t count = 1;
        for (const ModelAxis& axis : axes_) {
            std::set<double> points{axis.lower, axis.upper};
            for (const TableAxisOf& own : axis.tables) {
                points.insert(own.get().points.begin(), own.get().points.end());
            }
            std::erase_if(points, [&](double x) { return x < axis.lower || x > axis.upper; });
            grid.emplace_back(points.begin(), points.end());
            count *= grid.back().size();
        }
        if (count > options_.sampling.most_nodes) {
            throw core::InputError("range",
                                   "the tables of the model have more than " +
                                       std::to_string(options_.sampling.most_nodes) + " set points together",
                                   {model_.name, {}, {}, {}}, "hold one of their axes, such as speed=0.5m/s");
        }
        std::vector<std::vector<double>> columns(axes_.size()), forces(quantities_.size());
        for (std::size_t row = 0; row < count; ++row) {
            double point[tables::max_axes];
            std::size_t rest = row;
            for (std::size_t k = axes_.size(); k-- > 0;) {
                point[k] = grid[k][rest % grid[k].size()];
                rest /= grid[k].size();
                columns[k].push_back(point[k]);
            }
            const Conditions conditions = at(channels, point);
            for (std::size_t q = 0; q < quantities_.size(); ++q) {
                forces[q].push_back(models_[q](conditions));
            }
        }
        points_.source = model_.name;
        for (std::size_t k = 0; k < axes_.size(); ++k) {
            points_.add_numbers(channel_name(channels[k]), channel_unit(channels[k]), std::move(columns[k]));
        }
        for (std::size_t q = 0; q < quantities_.size(); ++q) {
            points_.add_numbers(quantities_[q], core::find_quantity(quantities_[q])->unit, std::move(forces[q]));
        }
        add_constants(points_, model_, channels, held_);
    }

    /// Lines, ends and kinks of one quantity along a channel.
    tables::SampledAxis sampled_axis(const ModelAxis& axis, const std::string& quantity) const {
        tables::SampledAxis result{channel_name(axis.channel),
                                   channel_unit(axis.channel),
                                   axis.lower,
                                   axis.upper,
                                   options_.range.of(channel_name(axis.channel)),
                                   {axis.lower, axis.upper},
                                   {}};
        for (const TableAxisOf& own : axis.tables) {
            if (!concerns(own, quantity)) {
                continue;
            }
            const std::vector<double>& knots = own.table->knots(own.axis);
            result.lines.insert(result.lines.end(), knots.begin(), knots.end());
            result.kinks.push_back(knots.front());  // there the table begins to hold its value
            result.kinks.push_back(knots.back());
            if (!own.correction) {
                result.lower = std::max(result.lower, own.get().lower);
                result.upper = std::min(result.upper, own.get().upper);
            }
        }
        for (const ForceSource& source : model_.forces) {
            for (const ForceScale& scale : source.scales) {
                if (source.quantity == quantity && scale.channel == axis.channel) {
                    result.kinks.insert(result.kinks.end(), {-scale.dead_band, 0.0, scale.dead_band});
                }
            }
        }
        for (const EffectUse& use : model_.effects) {
            const std::vector<double> bends = effect(use.name).kinks(axis.channel, use);
            result.kinks.insert(result.kinks.end(), bends.begin(), bends.end());
        }
        std::erase_if(result.lines, [&](double x) { return x < axis.lower || x > axis.upper; });
        std::sort(result.lines.begin(), result.lines.end());
        if (!(result.lower < result.upper)) {
            throw core::InputError("range",
                                   "the tables of " + quantity + " have no range of " + result.name + " in common",
                                   {model_.name, {}, {}, {}});
        }
        return result;
    }

    /// Where all tables of a quantity have data.
    tables::Support support_of(const std::string& quantity, const std::vector<Channel>& channels,
                               const StaticModel& model) const {
        std::vector<std::set<double>> lines(axes_.size());
        bool everywhere = true;
        for (std::size_t k = 0; k < axes_.size(); ++k) {
            lines[k] = {axes_[k].lower, axes_[k].upper};
            for (const TableAxisOf& own : axes_[k].tables) {
                const tables::Support* support =
                    own.correction || !concerns(own, quantity) ? nullptr : tables::data_support(*own.table);
                if (support != nullptr && !support->empty()) {
                    everywhere = false;
                    lines[k].insert(support->lines()[own.axis].begin(), support->lines()[own.axis].end());
                }
            }
            std::erase_if(lines[k], [&](double x) { return x < axes_[k].lower || x > axes_[k].upper; });
        }
        if (everywhere) {
            return {};
        }
        std::vector<std::vector<double>> sorted;
        for (const auto& x : lines) {
            sorted.emplace_back(x.begin(), x.end());
        }
        return {std::move(sorted), [&](const double* low, const double* high) {
                    double middle[tables::max_axes];
                    for (std::size_t k = 0; k < channels.size(); ++k) {
                        middle[k] = 0.5 * (low[k] + high[k]);
                    }
                    return !no_data(quantity, model.seen(at(channels, middle)));
                }};
    }

    [[nodiscard]] bool no_data(const std::string& quantity, const Conditions& seen) const {
        return std::any_of(model_.forces.begin(), model_.forces.end(), [&](const ForceSource& source) {
            const tables::Support* support = source.quantity == quantity ? tables::data_support(source.table) : nullptr;
            double point[tables::max_axes] = {};
            for (std::size_t k = 0; k < source.axes.size(); ++k) {
                point[k] = seen.get(source.axes[k], 0);
            }
            return support != nullptr && support->no_data(point);
        });
    }

    tables::SampledFunction function(std::size_t q, const std::vector<Channel>& channels) {
        tables::SampledFunction f;
        f.quantity = quantities_[q];
        f.unit = core::find_quantity(f.quantity)->unit;
        f.kind = "force of a model";
        for (const core::Problem& remark : model_.remarks) {  // of its tables: what their numbers are worth
            if (remark.severity != core::Problem::Severity::note) {
                f.remarks.push_back(remark);
            }
        }
        f.source = model_.name;
        for (const ModelAxis& axis : axes_) {
            f.axes.push_back(sampled_axis(axis, f.quantity));
        }
        f.value = [this, q, channels](const double* point) { return models_[q](at(channels, point)); };
        f.sigma = [this, error = ForceError(with_errors_, f.quantity), channels](const double* point) {
            return error(at(channels, point));
        };
        f.support = support_of(f.quantity, channels, models_[q]);
        f.points = points_;
        for (std::size_t i = 0; i < channel_count; ++i) {
            const auto channel = static_cast<Channel>(i);
            const double value = held_.get(channel, model_.conditions[channel]);
            if (!std::isnan(value) && std::find(channels.begin(), channels.end(), channel) == channels.end()) {
                f.conditions.emplace_back(channel_name(channel), value);
            }
        }
        return f;
    }

    ForceTables out_;
    Model model_, with_errors_;
    const ForceTablesOptions& options_;
    core::Progress& progress_;
    Conditions held_;
    std::vector<std::string> quantities_;
    std::vector<ModelAxis> axes_;
    std::vector<StaticModel> models_;
    core::Table points_;
};

}  // namespace

ForceTables force_tables(const Model& model, const ForceTablesOptions& options, core::Progress& progress) {
    return Maker(model, options, progress).made();
}

}  // namespace underbody::dynamics
