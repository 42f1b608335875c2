#include "surrogates/tables/fit/sampled.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/fit/force_table_impl.h"

namespace underbody::tables {

namespace {

using Lines = std::vector<std::vector<double>>;

/// Width of the cell that stands for a jump of the slope, as a share of the axis: wide enough to survive being written
/// and read as one set point each.
constexpr double kink_width = 1e-8;

std::size_t nodes_of(const Lines& lines) {
    std::size_t count = 1;
    for (const auto& x : lines) {
        count = x.size() > SIZE_MAX / count ? SIZE_MAX : count * x.size();
    }
    return count;
}

/// Calls f(node, point) for every node, last axis fastest.
template <class F>
void for_each(const Lines& lines, core::Progress& progress, F&& f) {
    const std::size_t count = nodes_of(lines);
    double point[max_axes];
    for (std::size_t node = 0; node < count; ++node) {
        if (node % 1024 == 0) {
            progress.check();
        }
        std::size_t rest = node;
        for (std::size_t k = lines.size(); k-- > 0;) {
            point[k] = lines[k][rest % lines[k].size()];
            rest /= lines[k].size();
        }
        f(node, point);
    }
}

class Sampler {
public:
    Sampler(const SampledFunction& function, const SamplingOptions& options, core::Progress& progress)
        : f_(function), options_(options), progress_(progress) {
        for (const SampledAxis& axis : f_.axes) {
            lines_.push_back(first_lines(axis));
            narrow_.push_back(kink_width * (axis.lines.back() - axis.lines.front()));
        }
    }

    ForceTable table() {
        refine();
        auto impl = std::make_shared<ForceTable::Impl>();
        impl->quantity = f_.quantity;
        impl->unit = f_.unit;
        impl->kind = f_.kind;
        impl->source = f_.source;
        impl->points = f_.points;
        impl->constants = f_.conditions;
        impl->remarks = f_.remarks;
        impl->rule = SlopeRule::monotone;
        impl->surface = surface_;
        impl->error = error_model();
        if (!f_.support.empty()) {
            impl->support = std::make_shared<Support>(f_.support);
        }
        for (std::size_t k = 0; k < f_.axes.size(); ++k) {
            const SampledAxis& axis = f_.axes[k];
            impl->axes.push_back({axis.name, axis.unit, axis.lower, axis.upper, axis.lines, axis.range});
        }
        impl->sampling_error = largest_difference();
        if (impl->sampling_error > std::max(options_.tolerance * range_, 1e-11 * largest_)) {
            impl->remarks.push_back({core::Problem::Severity::warning,
                                     f_.quantity + " is given by its grid to " +
                                         core::format_number(impl->sampling_error, 3) + " " + f_.unit + " only, " +
                                         core::format_number(100 * impl->sampling_error / range_, 2) +
                                         " % of its range",
                                     {f_.source, {}, {}, {}}});
        }
        return ForceTable(std::move(impl));
    }

private:
    static std::vector<double> first_lines(const SampledAxis& axis) {
        std::vector<double> x = axis.lines;
        const double first = x.front(), last = x.back(), width = kink_width * (last - first);
        for (const double kink : axis.kinks) {
            if (kink > first + width && kink < last - width) {
                x.push_back(kink);
                x.push_back(kink + width);
            }
        }
        std::sort(x.begin(), x.end());
        // Lines of several tables that differ by rounding are one.
        std::vector<double> apart{x.front()};
        for (const double v : x) {
            if (v > apart.back() + 0.5 * width) {
                apart.push_back(v);
            }
        }
        apart.back() = x.back();
        return apart;
    }

    [[nodiscard]] bool is_kink(std::size_t k, std::size_t cell) const {
        return lines_[k][cell + 1] - lines_[k][cell] < 1.5 * narrow_[k];
    }

    /// Lines and two places between neighbours.
    [[nodiscard]] std::vector<double> thirds(std::size_t k) const {
        std::vector<double> x;
        for (std::size_t i = 0; i + 1 < lines_[k].size(); ++i) {
            for (int part = 0; part < 3; ++part) {
                x.push_back(lines_[k][i] + (lines_[k][i + 1] - lines_[k][i]) * part / 3.0);
            }
        }
        x.push_back(lines_[k].back());
        return x;
    }

    /// Slope at a line out of the samples along one axis, `step` numbers apart: of the cubics on both sides, without
    /// cells that stand for a kink.
    [[nodiscard]] double slope(std::size_t k, std::size_t line, const double* samples, std::size_t step) const {
        double sum = 0;
        int count = 0;
        const auto& x = lines_[k];
        const auto at = [&](std::size_t i) { return samples[i * step]; };
        const bool alone = x.size() == 2;
        if (line + 1 < x.size() && (alone || !is_kink(k, line))) {
            const std::size_t i = 3 * line;
            sum += (-11 * at(i) + 18 * at(i + 1) - 9 * at(i + 2) + 2 * at(i + 3)) / (2 * (x[line + 1] - x[line]));
            ++count;
        }
        if (line > 0 && (alone || !is_kink(k, line - 1))) {
            const std::size_t i = 3 * line;
            sum += (11 * at(i) - 18 * at(i - 1) + 9 * at(i - 2) - 2 * at(i - 3)) / (2 * (x[line] - x[line - 1]));
            ++count;
        }
        return count > 0 ? sum / count : 0;
    }

    /// Values and slopes at the nodes out of the samples, axis by axis.
    void take() {
        Lines places;
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            places.push_back(thirds(k));
        }
        std::vector<double> data(nodes_of(places));
        for_each(places, progress_, [&](std::size_t i, const double* point) { data[i] = f_.value(point); });
        const auto [low, high] = std::minmax_element(data.begin(), data.end());
        range_ = *high - *low;
        largest_ = std::max(std::abs(*low), std::abs(*high));
        // Each pass replaces the places along one axis by its lines and doubles the numbers a node has.
        std::size_t width = 1;
        for (std::size_t k = 0; k < lines_.size(); ++k, width *= 2) {
            std::size_t inner = width;
            for (std::size_t j = k + 1; j < lines_.size(); ++j) {
                inner *= places[j].size();
            }
            const std::size_t outer = data.size() / inner / places[k].size(), lines = lines_[k].size();
            // Numbers lie as [outer][axis][rest][width]; the new derivative is the higher bit.
            std::vector<double> next(outer * lines * inner * 2);
            for (std::size_t o = 0; o < outer; ++o) {
                for (std::size_t line = 0; line < lines; ++line) {
                    for (std::size_t i = 0; i < inner; ++i) {
                        const double* samples = &data[o * places[k].size() * inner + i];
                        double* to = &next[((o * lines + line) * (inner / width) + i / width) * 2 * width + i % width];
                        to[0] = samples[3 * line * inner];
                        to[width] = slope(k, line, samples, inner);
                    }
                }
            }
            data = std::move(next);
        }
        surface_ = CubicGrid(lines_, std::move(data));
    }

    struct Cells {
        std::vector<std::vector<bool>> halve;
        bool any = false;
    };

    /// Cells along each axis where the cubic misses the function, or the straight line the error, on the grid's lines
    /// along that axis.
    Cells failing() {
        Cells cells;
        const std::size_t n = lines_.size();
        const double allowed = std::max(options_.tolerance * range_ / (2.0 * static_cast<double>(n)), 1e-13 * largest_);
        for (std::size_t k = 0; k < n; ++k) {
            cells.halve.emplace_back(lines_[k].size() - 1, false);
            for (std::size_t cell = 0; cell + 1 < lines_[k].size(); ++cell) {
                if (is_kink(k, cell)) {
                    continue;
                }
                Lines along = lines_;
                const double low = lines_[k][cell], width = lines_[k][cell + 1] - low;
                along[k] = {low, low + width / 6, low + width / 2, low + 5 * width / 6, low + width};
                std::size_t stride = 1;
                for (std::size_t j = n; j-- > k + 1;) {
                    stride *= lines_[j].size();
                }
                std::vector<double> sigma(nodes_of(along));
                bool misses = false;
                for_each(along, progress_, [&](std::size_t node, const double* point) {
                    const std::size_t i = node / stride % 5;
                    misses = misses ||
                             (i > 0 && i < 4 && std::abs(surface_.value(point, nullptr) - f_.value(point)) > allowed);
                    sigma[node] = i == 1 || i == 3 || misses ? 0 : f_.sigma(point);
                    largest_sigma_ = std::max(largest_sigma_, sigma[node]);
                });
                double low_bump = INFINITY, high_bump = 0;
                for (std::size_t node = 0; node < sigma.size() && !misses; ++node) {
                    if (node / stride % 5 == 2) {
                        const double bump = sigma[node] - 0.5 * (sigma[node - 2 * stride] + sigma[node + 2 * stride]);
                        low_bump = std::min(low_bump, bump);
                        high_bump = std::max(high_bump, bump);
                    }
                }
                // One number a cell has to do for the rise of the error in all of its middles.
                const bool uneven = std::max(high_bump, 0.0) - low_bump > options_.sigma_tolerance * largest_sigma_;
                cells.halve[k][cell] = misses || (uneven && depth_ < 5);
                cells.any = cells.any || cells.halve[k][cell];
            }
        }
        return cells;
    }

    void refine() {
        if (nodes_of(lines_) > options_.most_nodes) {
            throw core::InputError(
                "range", "the tables have more than " + std::to_string(options_.most_nodes) + " set points together",
                {f_.source, {}, {}, {}}, "hold one of their axes");
        }
        for (take(); depth_ < 16; ++depth_) {
            const Cells cells = failing();
            if (!cells.any) {
                return;
            }
            Lines finer(lines_.size());
            for (std::size_t k = 0; k < lines_.size(); ++k) {
                for (std::size_t i = 0; i + 1 < lines_[k].size(); ++i) {
                    finer[k].push_back(lines_[k][i]);
                    if (cells.halve[k][i]) {
                        finer[k].push_back(0.5 * (lines_[k][i] + lines_[k][i + 1]));
                    }
                }
                finer[k].push_back(lines_[k].back());
            }
            if (nodes_of(finer) > options_.most_nodes) {
                return;
            }
            lines_ = std::move(finer);
            take();
        }
    }

    /// In the middles of cells, where a cubic misses most, and at random places in them.
    double largest_difference() {
        core::Random random(20240607);
        double worst = 0;
        const std::size_t count = std::clamp<std::size_t>(surface_.nodes(), 4000, 40000);
        for (std::size_t i = 0; i < count; ++i) {
            double point[max_axes];
            for (std::size_t k = 0; k < lines_.size(); ++k) {
                const std::size_t cell = random.below(lines_[k].size() - 1);
                const double share = i % 2 == 0 ? 0.5 : random.uniform(0, 1);
                point[k] = lines_[k][cell] + share * (lines_[k][cell + 1] - lines_[k][cell]);
            }
            worst = std::max(worst, std::abs(surface_.value(point, nullptr) - f_.value(point)));
        }
        return 1.25 * worst;  // sampled: elsewhere it may be a little larger
    }

    ErrorModel error_model() {
        const std::size_t n = lines_.size();
        std::vector<double> sigma(nodes_of(lines_));
        for_each(lines_, progress_, [&](std::size_t node, const double* point) { sigma[node] = f_.sigma(point); });
        ErrorModel error(lines_, sigma);
        std::size_t stride = 1;
        for (std::size_t k = n; k-- > 0;) {
            const auto& x = lines_[k];
            std::vector<double> cells(x.size() - 1, 0.0);
            ErrorModel::Growth growth{};
            const double reach = 0.1 * (x.back() - x.front());
            for_each(lines_, progress_, [&](std::size_t node, const double* point) {
                const std::size_t i = node / stride % x.size();
                double at[max_axes];
                std::copy(point, point + n, at);
                if (i + 1 < x.size()) {
                    at[k] = 0.5 * (x[i] + x[i + 1]);
                    const double bump = f_.sigma(at) - 0.5 * (sigma[node] + sigma[node + stride]);
                    cells[i] = std::max(cells[i], bump > 1e-12 * sigma[node] ? bump : 0);
                }
                if (i == 0 || i + 1 == x.size()) {
                    double& g = growth[i == 0 ? 0 : 1];
                    at[k] = i == 0 ? x.front() - reach : x.back() + reach;
                    g = std::max(g, (f_.sigma(at) - sigma[node]) / reach);
                    // Held at the end, the table misses what the function does beyond it.
                    g = std::max(g, std::abs(f_.value(at) - f_.value(point)) / reach);
                }
            });
            if (std::any_of(cells.begin(), cells.end(), [](double c) { return c > 0; })) {
                error.set_cell_error(k, std::move(cells));
            }
            error.set_growth(k, growth);
            stride *= x.size();
        }
        return error;
    }

    const SampledFunction& f_;
    const SamplingOptions& options_;
    core::Progress& progress_;
    Lines lines_;
    std::vector<double> narrow_;
    CubicGrid surface_;
    double range_ = 0, largest_ = 0, largest_sigma_ = 0;
    int depth_ = 0;
};

}  // namespace

ForceTable sampled_table(const SampledFunction& function, const SamplingOptions& options, core::Progress& progress) {
    return Sampler(function, options, progress).table();
}

}  // namespace underbody::tables
