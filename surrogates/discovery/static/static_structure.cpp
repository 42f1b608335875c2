#include "surrogates/discovery/static/static_structure.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/no_limit.h"
#include "core/random.h"
#include "core/units.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

constexpr double shows_structure = 1e-3;  ///< chance below which a quantity's smooth function counts beside the others'
constexpr double least_logarithm = 1e-12;
constexpr double same_level = 1e-4;  ///< of the range

DesignMatrix design(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                    const std::vector<Channel>& variables, std::size_t columns_each) {
    const auto& observations = experiment.observations();
    std::vector<std::vector<double>> values(variables.size());
    for (std::size_t v = 0; v < variables.size(); ++v) {
        for (const std::size_t i : chosen) {
            values[v].push_back(observations[i].at[variables[v]]);
        }
    }
    const FlexibleBasis basis(values, columns_each);
    const std::size_t each = basis.columns();
    DesignMatrix matrix;
    matrix.rows = chosen.size();
    matrix.columns = each * experiment.quantities().size();
    matrix.values.assign(matrix.rows * matrix.columns, 0);
    std::vector<double> point(variables.size());
    std::vector<double> out(each);
    for (std::size_t row = 0; row < chosen.size(); ++row) {
        const Observation& one = observations[chosen[row]];
        for (std::size_t v = 0; v < variables.size(); ++v) {
            point[v] = one.at[variables[v]];
        }
        basis.evaluate(point.data(), out.data());
        for (std::size_t k = 0; k < each; ++k) {
            matrix.at(row, one.quantity * each + k) = out[k];
        }
    }
    return matrix;
}

double evidence(double gain, std::size_t columns) { return surprise(gain, static_cast<double>(columns)); }

}  // namespace

namespace {

/// Functions of one variable times a power of another: most forces in water grow as a power of a speed or a voltage.
DesignMatrix scaled_design(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen, Channel variable,
                           Channel scale, int power, std::size_t columns) {
    DesignMatrix matrix = design(experiment, chosen, {variable}, columns);
    for (std::size_t row = 0; row < chosen.size(); ++row) {
        const double factor = std::pow(experiment.observations()[chosen[row]].at[scale], power);
        for (std::size_t k = 0; k < matrix.columns; ++k) {
            matrix.at(row, k) *= factor;
        }
    }
    return matrix;
}

/// The columns that belong to one measured quantity.
DesignMatrix of_quantity(const DesignMatrix& matrix, std::size_t quantity, std::size_t quantities) {
    const std::size_t each = matrix.columns / quantities;
    DesignMatrix part;
    part.rows = matrix.rows;
    part.columns = each;
    part.values.assign(matrix.values.begin() + static_cast<std::ptrdiff_t>(quantity * each * matrix.rows),
                       matrix.values.begin() + static_cast<std::ptrdiff_t>((quantity + 1) * each * matrix.rows));
    return part;
}

}  // namespace

StaticStructure::StaticStructure(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen)
    : quantities_(experiment.quantities().size()) {
    const std::vector<Channel>& varying = experiment.varying();
    const bool few = chosen.size() < 60 * quantities_;  // a tow tank's dozen of runs
    const std::size_t rows_a_column = few ? 3 : 4;
    const auto add = [&](const std::vector<Channel>& variables, DesignMatrix matrix) {
        for (std::size_t k = 0; k < matrix.columns; ++k) {
            experiment.whiten(chosen, matrix.values.data() + k * matrix.rows);
        }
        for (std::size_t q = 0; q < quantities_; ++q) {
            DesignMatrix basis = orthonormal(of_quantity(matrix, q, quantities_));
            if (basis.columns > 0 && basis.columns * quantities_ * rows_a_column <= chosen.size()) {
                tests_.push_back({variables, q, std::move(basis)});
            }
        }
    };
    for (const Channel channel : varying) {
        add({channel}, design(experiment, chosen, {channel}, 6));
        if (few) {
            add({channel}, design(experiment, chosen, {channel}, 2));
        }
        if (channel == Channel::time || channel == Channel::gap) {
            add({channel},
                design(experiment, chosen, {channel}, 16));  // several waves in a day of measuring, or over the gap
        }
    }
    for (std::size_t a = 0; a < varying.size(); ++a) {
        for (std::size_t b = a + 1; b < varying.size(); ++b) {
            if (few) {
                add({varying[a], varying[b]}, design(experiment, chosen, {varying[a], varying[b]}, 1));
            }
            add({varying[a], varying[b]}, design(experiment, chosen, {varying[a], varying[b]}, 3));
            add({varying[a], varying[b]}, design(experiment, chosen, {varying[a], varying[b]}, 5));
        }
    }
    for (const Channel scale : {Channel::speed, Channel::jet_voltage}) {
        if (std::find(varying.begin(), varying.end(), scale) == varying.end()) {
            continue;
        }
        for (const Channel variable : varying) {
            if (variable != scale) {
                for (const int power : {1, 2}) {
                    add({variable, scale}, scaled_design(experiment, chosen, variable, scale, power, 6));
                    if (variable == Channel::gap) {
                        add({variable, scale}, scaled_design(experiment, chosen, variable, scale, power, 16));
                    }
                }
            }
        }
    }
}

namespace {

/// What a fit of the columns takes off the square of each row.
void add_gain_of_rows(const DesignMatrix& basis, const std::vector<double>& y, std::vector<double>& gain) {
    std::vector<double> left = y;
    take_out(basis, left);
    for (std::size_t i = 0; i < y.size(); ++i) {
        gain[i] += y[i] * y[i] - left[i] * left[i];
    }
}

}  // namespace

StaticStructure::OfQuantity StaticStructure::best_of(std::size_t quantity, const std::vector<double>& residuals) const {
    OfQuantity own;
    const double penalty = std::log(static_cast<double>(residuals.size()) / static_cast<double>(quantities_));
    double best = core::no_limit;
    double strongest = 0;
    std::size_t count = 0;
    for (const Test& test : tests_) {
        if (test.quantity != quantity) {
            continue;
        }
        ++count;
        const double gain = explained_square(test.basis, residuals);
        const double degrees = static_cast<double>(test.basis.columns);
        strongest = std::max(strongest, evidence(gain, test.basis.columns));
        const double criterion = degrees * penalty - gain;
        if (criterion < best) {
            best = criterion;
            own.test = &test;
            own.fit.variables.clear();
            for (const Channel channel : test.variables) {
                own.fit.variables.emplace_back(dynamics::channel_name(channel));
            }
            own.fit.gain = gain;
            own.fit.degrees = degrees;
        }
    }
    own.fit.p = std::min(1.0, std::pow(10.0, -strongest) * static_cast<double>(std::max<std::size_t>(count, 1)));
    return own;
}

SmoothFit StaticStructure::best(const std::vector<double>& residuals) const {
    SmoothFit whole;
    double smallest = 1;
    std::vector<OfQuantity> by_quantity;
    for (std::size_t q = 0; q < quantities_; ++q) {
        by_quantity.push_back(best_of(q, residuals));
        smallest = std::min(smallest, by_quantity.back().fit.p);
    }
    whole.gain_of_row.assign(residuals.size(), 0);
    for (const auto& [own, test] : by_quantity) {
        if (own.p < shows_structure || own.p == smallest) {
            if (test != nullptr) {
                add_gain_of_rows(test->basis, residuals, whole.gain_of_row);
            }
            whole.gain += own.gain;
            whole.degrees += own.degrees;
            for (const std::string& name : own.variables) {
                if (std::find(whole.variables.begin(), whole.variables.end(), name) == whole.variables.end()) {
                    whole.variables.push_back(name);
                }
            }
        }
    }
    whole.p = std::min(1.0, smallest * static_cast<double>(quantities_));
    return whole;
}

double simulated_gate(const StaticStructure& structure, const std::vector<DesignMatrix>& directions,
                      const std::vector<double>& residuals, const std::vector<double>& noise_like, std::uint64_t seed,
                      core::Progress& progress) {
    std::vector<const DesignMatrix*> all;
    for (const StaticStructure::Test& test : structure.tests()) {
        all.push_back(&test.basis);
    }
    for (const DesignMatrix& direction : directions) {
        if (direction.columns > 0) {
            all.push_back(&direction);
        }
    }
    const auto statistic = [&](const std::vector<double>& y) {
        double largest = 0;
        for (const DesignMatrix* basis : all) {
            largest = std::max(largest, evidence(explained_square(*basis, y), basis->columns));
        }
        return largest;
    };
    const double observed = statistic(residuals);
    const std::size_t n = noise_like.size();
    constexpr std::size_t block = 4;
    constexpr int draws = 499;
    const double size = root_mean_square(noise_like);
    core::Random random(seed);
    int as_large = 0;
    double largest_drawn = 0;
    std::vector<double> drawn(n);
    for (int d = 0; d < draws; ++d) {
        progress.check();
        for (std::size_t begin = 0; begin < n; begin += block) {
            const std::size_t from = random.below(n);
            const double sign = random.uniform() < 0.5 ? -1 : 1;
            for (std::size_t k = 0; k < block && begin + k < n; ++k) {
                drawn[begin + k] = sign * noise_like[(from + k) % n] / core::never_zero(size);
            }
        }
        const double of_noise = statistic(drawn);
        largest_drawn = std::max(largest_drawn, of_noise);
        as_large += of_noise >= observed ? 1 : 0;
        if (as_large >= 40) {
            return static_cast<double>(as_large + 1) / (d + 2);  // far from significant: no need to count further
        }
    }
    // beyond every draw: the statistic is a negative decimal logarithm of a chance, so its tail falls tenfold a unit
    const double beyond = as_large == 0 ? std::min(observed - largest_drawn, 12.0) : 0;
    return static_cast<double>(as_large + 1) / (draws + 1) * std::pow(10.0, -std::max(beyond, 0.0));
}

namespace {

/// One way to write a correction down: splines of every variable, or of the first times a power of the second.
class CorrectionShape {
public:
    /// `columns` of each variable that gets splines: all of them, or the first alone where the second comes in as a
    /// power.
    CorrectionShape(const std::vector<std::vector<double>>& values, int power, const std::vector<std::size_t>& columns)
        : power_(power) {
        for (const std::vector<double>& variable : values) {
            // gaps from 1 to 40 mm and the like: what happens near the ground needs the finer steps
            const auto [low, high] = std::minmax_element(variable.begin(), variable.end());
            logarithmic_.push_back(*low > 0 && *high > 6 * *low);
        }
        std::vector<std::vector<double>> seen;
        for (std::size_t v = 0; v < columns.size(); ++v) {
            seen.emplace_back();
            for (const double value : values[v]) {
                seen.back().push_back(scaled(v, value));
            }
        }
        basis_ = FlexibleBasis(seen, columns);
    }
    [[nodiscard]] std::size_t columns() const { return basis_.columns(); }
    void evaluate(const double* point, double* out) const {
        double inside[4] = {};
        for (std::size_t v = 0; v < logarithmic_.size(); ++v) {
            inside[v] = scaled(v, point[v]);
        }
        basis_.evaluate(inside, out);
        if (power_ > 0) {
            const double factor = std::pow(point[1], power_);
            for (std::size_t k = 0; k < basis_.columns(); ++k) {
                out[k] *= factor;
            }
        }
    }

    /// One row a point; `values[v]` are the variable v's.
    [[nodiscard]] DesignMatrix design(const std::vector<std::vector<double>>& values, std::size_t rows) const {
        DesignMatrix matrix;
        matrix.rows = rows;
        matrix.columns = columns();
        matrix.values.resize(matrix.rows * matrix.columns);
        std::vector<double> point(values.size());
        std::vector<double> out(columns());
        for (std::size_t row = 0; row < matrix.rows; ++row) {
            for (std::size_t v = 0; v < values.size(); ++v) {
                point[v] = values[v][row];
            }
            evaluate(point.data(), out.data());
            for (std::size_t k = 0; k < out.size(); ++k) {
                matrix.at(row, k) = out[k];
            }
        }
        return matrix;
    }

private:
    [[nodiscard]] double scaled(std::size_t v, double value) const {
        return logarithmic_[v] ? std::log(std::max(value, least_logarithm)) : value;
    }
    int power_;
    std::vector<bool> logarithmic_;
    FlexibleBasis basis_;
};

/// Sum of squares that fits to the other set points leave, a fifth of them held out at a time.
double held_out_square(const DesignMatrix& matrix, const std::vector<double>& y,
                       const std::vector<std::size_t>& set_point) {
    constexpr std::size_t folds = 5;
    const std::size_t points = *std::max_element(set_point.begin(), set_point.end()) + 1;
    core::Random random(1);
    std::vector<std::size_t> fold(points);
    for (std::size_t g = 0; g < points; ++g) {
        fold[g] = random.below(folds);
    }
    double sum = 0;
    for (std::size_t f = 0; f < folds; ++f) {
        std::vector<std::size_t> inside;
        for (std::size_t i = 0; i < y.size(); ++i) {
            if (fold[set_point[i]] != f) {
                inside.push_back(i);
            }
        }
        if (inside.empty() || inside.size() == y.size()) {
            continue;
        }
        DesignMatrix part;
        part.rows = inside.size();
        part.columns = matrix.columns;
        part.values.reserve(part.rows * part.columns);
        std::vector<double> own;
        for (std::size_t k = 0; k < matrix.columns; ++k) {
            for (const std::size_t i : inside) {
                part.values.push_back(matrix.values[k * matrix.rows + i]);
            }
        }
        for (const std::size_t i : inside) {
            own.push_back(y[i]);
        }
        const RidgeFit fit = ridge_fit(part, own);
        for (std::size_t i = 0; i < y.size(); ++i) {
            if (fold[set_point[i]] == f) {
                double left = y[i];
                for (std::size_t k = 0; k < matrix.columns; ++k) {
                    left -= fit.coefficients[k] * matrix.values[k * matrix.rows + i];
                }
                sum += left * left;
            }
        }
    }
    return sum;
}

struct CorrectionForm {
    int power = 0;
    std::vector<std::size_t> columns;
};

/// From coarse to fine: few knots for a slow law, as many as levels for a bump between two of them. Which one is for
/// the data to say.
std::vector<CorrectionForm> correction_forms(const std::vector<Channel>& variables) {
    constexpr std::size_t fine = FlexibleBasis::most_columns;
    std::vector<CorrectionForm> forms;
    if (variables.size() == 1) {
        return {{0, {5}}, {0, {10}}, {0, {fine}}};
    }
    forms.push_back({0, std::vector<std::size_t>(variables.size(), variables.size() == 2 ? 5 : 3)});
    if (variables.size() == 2) {
        forms.insert(forms.end(), {{0, {6, 6}}, {0, {10, 4}}, {0, {fine, 2}}, {0, {fine, 3}}});
        if (variables[1] == Channel::speed || variables[1] == Channel::jet_voltage) {
            for (const int power : {1, 2, 3}) {
                forms.insert(forms.end(), {{power, {5}}, {power, {10}}, {power, {fine}}});
            }
        }
    }
    return forms;
}

/// Grid lines of a table: the levels that were measured and the middles between them, or equal steps where there are
/// many.
std::vector<double> grid_lines(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const double range = values.back() - values.front();
    values.erase(
        std::unique(values.begin(), values.end(), [&](double a, double b) { return b - a < same_level * range; }),
        values.end());
    std::vector<double> lines;
    if (values.size() <= 24) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            if (k > 0) {
                lines.push_back(0.5 * (values[k - 1] + values[k]));
            }
            lines.push_back(values[k]);
        }
        return lines;
    }
    for (int k = 0; k <= 32; ++k) {
        lines.push_back(quantile(values, k / 32.0));
    }
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    return lines;
}

/// With one more line on either side, a tenth of the range away, at which a correction has faded to nothing.
std::vector<double> with_fade(std::vector<double> lines) {
    constexpr double fade = 0.1;
    const double range = lines.back() - lines.front();
    lines.insert(lines.begin(), lines.front() - fade * range);
    lines.push_back(lines.back() + fade * range);
    return lines;
}

/// Residuals of one quantity, and where they were seen.
struct SeenResiduals {
    std::vector<std::vector<double>> values;  ///< of each variable
    std::vector<double> y;
    std::vector<std::size_t> set_point;
};

SeenResiduals residuals_of(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                           const std::vector<Channel>& variables, std::size_t quantity,
                           const std::vector<double>& residuals) {
    SeenResiduals seen;
    seen.values.resize(variables.size());
    for (std::size_t row = 0; row < chosen.size(); ++row) {
        const Observation& one = experiment.observations()[chosen[row]];
        if (one.quantity == quantity) {
            for (std::size_t v = 0; v < variables.size(); ++v) {
                seen.values[v].push_back(one.at[variables[v]]);
            }
            seen.y.push_back(residuals[row]);
            seen.set_point.push_back(one.set_point);
        }
    }
    return seen;
}

/// The form whose error is least where it was not fitted.
std::unique_ptr<CorrectionShape> best_shape(const std::vector<Channel>& variables, const SeenResiduals& seen) {
    std::unique_ptr<CorrectionShape> shape;
    double best = core::no_limit;
    for (const auto& [power, columns] : correction_forms(variables)) {
        auto trial = std::make_unique<CorrectionShape>(seen.values, power, columns);
        if (3 * trial->columns() > seen.y.size() && shape != nullptr) {
            continue;  // as many numbers as that would follow the noise
        }
        const double error = held_out_square(trial->design(seen.values, seen.y.size()), seen.y, seen.set_point);
        if (error < best) {
            best = error;
            shape = std::move(trial);
        }
    }
    return shape;
}

/// A fitted form on the grid of its table: no larger than the residual that it explains, and nothing on the outer
/// lines.
struct GriddedCorrection {
    std::vector<std::vector<double>> grid;  ///< of each variable
    std::vector<double> value;
};

GriddedCorrection on_grid(const CorrectionShape& shape, const SeenResiduals& seen) {
    const RidgeFit fit = ridge_fit(shape.design(seen.values, seen.y.size()), seen.y);
    std::vector<std::vector<double>> lines;
    std::size_t count = 1;
    for (const std::vector<double>& variable : seen.values) {
        lines.push_back(with_fade(grid_lines(variable)));
        count *= lines.back().size();
    }
    double largest = 0;
    for (const double one : seen.y) {
        largest = std::max(largest, std::abs(one));
    }
    GriddedCorrection on;
    on.grid.assign(lines.size(), std::vector<double>(count));
    on.value.resize(count);
    std::vector<double> point(lines.size()), out(shape.columns());
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        bool faded = false;
        for (std::size_t v = 0; v < lines.size(); ++v) {
            const std::size_t line = rest % lines[v].size();
            faded = faded || line == 0 || line + 1 == lines[v].size();
            on.grid[v][i] = lines[v][line];
            point[v] = std::clamp(on.grid[v][i], lines[v][1], lines[v][lines[v].size() - 2]);
            rest /= lines[v].size();
        }
        shape.evaluate(point.data(), out.data());
        for (std::size_t k = 0; k < out.size(); ++k) {
            on.value[i] += out[k] * fit.coefficients[k];
        }
        on.value[i] = faded ? 0 : std::clamp(on.value[i], -largest, largest);
    }
    return on;
}

}  // namespace

dynamics::EffectUse smooth_correction(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                                      const std::vector<Channel>& wanted, std::size_t quantity,
                                      const std::vector<double>& residuals) {
    std::vector<Channel> variables = wanted;
    std::stable_sort(variables.begin(), variables.end(), [](Channel a, Channel b) {
        const auto scales = [](Channel c) { return c == Channel::speed || c == Channel::jet_voltage; };
        return scales(a) < scales(b);
    });
    const SeenResiduals seen = residuals_of(experiment, chosen, variables, quantity, residuals);
    const GriddedCorrection correction = on_grid(*best_shape(variables, seen), seen);
    core::Table table;
    const std::string& name = experiment.quantities()[quantity];
    table.source = "correction-" + name + ".csv";
    for (std::size_t v = 0; v < variables.size(); ++v) {
        table.add_numbers(dynamics::channel_name(variables[v]), dynamics::channel_unit(variables[v]),
                          correction.grid[v]);
    }
    table.add_numbers(name, core::find_quantity(name)->unit, correction.value);
    dynamics::EffectUse use = dynamics::neutral_use("unknown");
    use.quantity = name;
    use.table = tables::ForceTable::fit(table, name);
    use.table_file = table.source;
    return use;
}

}  // namespace underbody::discovery
