// Gaussian process of a force table: which coordinates and known laws it uses, and its table for fast evaluation.
//
// Known laws (physics notes 4.4 and 5.2): force ~ speed^2 and ~ jet voltage^2 (the process then models force over that square); film terms ~ 1/h^2 and
// 1/h^3 over a gap axis, a constant free-stream value at large gaps; gaps that span decades act through their logarithm.
#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "core/text.h"
#include "surrogates/tables/fit.h"
#include "surrogates/tables/force_table_impl.h"
#include "surrogates/tables/gaussian_process.h"

namespace underbody::tables {

namespace {

using core::InputError;

/// How raw set points and forces become the numbers that the process sees.
struct Form {
    std::vector<bool> logarithmic;       ///< per axis
    std::vector<double> start, span;     ///< of the coordinate
    std::vector<bool> squared;           ///< per axis: force grows with its square
    std::vector<double> reference;       ///< per axis: the square counts from here
    std::optional<std::size_t> film;     ///< axis with 1/h^2 and 1/h^3
    double film_gap = 1;
    std::optional<std::size_t> swelling;  ///< gap axis toward whose small end the process grows as (lower/h)^swell
    double swell = 0;
    double swell_gap = 1;
    double offset = 0, size = 1;         ///< of force over squares

    [[nodiscard]] double coordinate(std::size_t k, double x) const {
        return ((logarithmic[k] ? std::log(x) : x) - start[k]) / span[k];
    }
    [[nodiscard]] double coordinate_slope(std::size_t k, double x) const { return (logarithmic[k] ? 1 / x : 1) / span[k]; }
    [[nodiscard]] double factor(const std::vector<double>& x) const {
        double product = 1;
        for (std::size_t k = 0; k < x.size(); ++k) {
            product *= squared[k] ? std::pow(x[k] / reference[k], 2) : 1;
        }
        return product;
    }
    [[nodiscard]] double amplitude(const std::vector<double>& x) const { return swelling ? std::pow(x[*swelling] / swell_gap, -swell) : 1; }
    [[nodiscard]] std::size_t trends() const { return film ? 3 : 1; }
    void trend(const std::vector<double>& x, double* h) const {
        h[0] = 1;
        if (film) {
            const double r = film_gap / x[*film];
            h[1] = r * r;
            h[2] = r * r * r;
        }
    }
    [[nodiscard]] std::string text(const std::vector<TableAxis>& axes) const {
        std::string words;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            words += logarithmic[k] ? ", logarithm of " + axes[k].name : "";
            words += squared[k] ? ", force over " + axes[k].name + " squared" : "";
        }
        if (swelling) {
            words += ", larger at small gaps as h^-" + core::format_number(swell, 2);
        }
        return words + (film ? ", film terms 1/h^2 and 1/h^3" : "");
    }
};

GpData data_of(const SetPoints& points, const std::vector<std::size_t>& rows, Form& form) {
    GpData data;
    const std::size_t n = points.axes.size();
    data.axes = n;
    data.trends = form.trends();
    std::vector<double> z;
    for (const std::size_t i : rows) {
        z.push_back(points.value[i] / form.factor(points.x[i]));
    }
    const double mean = std::accumulate(z.begin(), z.end(), 0.0) / static_cast<double>(z.size());
    double square = 0;
    for (const double v : z) {
        square += (v - mean) * (v - mean);
    }
    form.offset = mean;
    form.size = std::max(std::sqrt(square / static_cast<double>(z.size())), 1e-300);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& x = points.x[rows[i]];
        for (std::size_t k = 0; k < n; ++k) {
            data.x.push_back(form.coordinate(k, x[k]));
        }
        double h[3];
        form.trend(x, h);
        if (form.swelling) {
            data.amplitude.push_back(form.amplitude(x));
        }
        data.trend.insert(data.trend.end(), h, h + data.trends);
        data.y.push_back((z[i] - form.offset) / form.size);
        const double s = points.has_sigma() ? points.sigma[rows[i]] / form.factor(x) / form.size : 0;
        data.noise.push_back(s * s);
    }
    return data;
}

std::vector<Form> candidate_forms(const SetPoints& points) {
    const std::size_t n = points.axes.size();
    Form plain;
    plain.logarithmic.assign(n, false);
    plain.squared.assign(n, false);
    plain.reference.assign(n, 1);
    for (const auto& axis : points.axes) {
        plain.start.push_back(axis.lower);
        plain.span.push_back(axis.upper - axis.lower);
    }
    std::vector<Form> forms{plain};
    const bool force = points.quantity.ends_with("_force") || points.quantity.ends_with("_moment");
    for (std::size_t k = 0; k < n; ++k) {
        const TableAxis& axis = points.axes[k];
        if (axis.name == "gap" && axis.lower > 0 && axis.upper / axis.lower >= 4) {
            std::vector<Form> more;
            for (Form form : forms) {
                form.logarithmic[k] = true;
                form.start[k] = std::log(axis.lower);
                form.span[k] = std::log(axis.upper / axis.lower);
                more.push_back(form);
                form.film = k;
                form.film_gap = axis.lower;
                if (points.x.size() >= 6) {
                    more.push_back(form);
                }
                form.film.reset();
                form.swelling = k;
                form.swell_gap = std::sqrt(axis.lower * axis.upper);
                for (const double power : {0.5, 1.0}) {
                    form.swell = power;
                    if (n > 1 && points.x.size() >= 8) {
                        more.push_back(form);
                    }
                }
            }
            forms.insert(forms.end(), more.begin(), more.end());
        }
        if (force && (axis.name == "speed" || axis.name == "jet_voltage") && axis.lower > 0) {
            std::vector<Form> more;
            for (Form form : forms) {
                form.squared[k] = true;
                form.reference[k] = axis.upper;
                more.push_back(form);
            }
            forms.insert(forms.end(), more.begin(), more.end());
        }
    }
    return forms;
}

/// Every so many-th point of a shuffled order: spread over the set, the same each time.
std::vector<std::size_t> spread_rows(std::size_t count, std::size_t wanted) {
    std::vector<std::size_t> rows(count);
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    if (count <= wanted) {
        return rows;
    }
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < wanted; ++i) {
        chosen.push_back(i * count / wanted);
    }
    return chosen;
}

/// Log density of the measured forces themselves, so that forms with different scales compare.
double score_of(const GaussianProcess& process, const SetPoints& points, const std::vector<std::size_t>& rows, const Form& form) {
    double score = process.leave_one_out().log_density - static_cast<double>(rows.size()) * std::log(form.size);
    for (const std::size_t i : rows) {
        score -= std::log(form.factor(points.x[i]));
    }
    return score;
}

void check_spread(const SetPoints& points) {
    const std::size_t n = points.axes.size();
    if (points.x.size() < n + 2) {
        throw InputError("few", std::to_string(points.x.size()) + " points are too few for a table of " + std::to_string(n) + " axes",
                         {points.table.source, {}, {}, {}}, "it needs at least " + std::to_string(n + 2) + " different set points");
    }
    if (n < 2) {
        return;
    }
    Eigen::MatrixXd x(static_cast<Eigen::Index>(points.x.size()), static_cast<Eigen::Index>(n));
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        for (Eigen::Index k = 0; k < x.cols(); ++k) {
            const TableAxis& axis = points.axes[static_cast<std::size_t>(k)];
            x(i, k) = (points.x[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] - axis.lower) / (axis.upper - axis.lower);
        }
    }
    x.rowwise() -= x.colwise().mean();
    const Eigen::MatrixXd gram = x.transpose() * x / static_cast<double>(x.rows());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gram);
    if (svd.singularValues()(x.cols() - 1) < 1e-10) {
        std::string names;
        for (const auto& axis : points.axes) {
            names += (names.empty() ? "" : " and ") + axis.name;
        }
        throw InputError("collinear", "all points lie on a line or plane of " + names + ": the axes cannot be told apart", {points.table.source, {}, {}, {}},
                         "name one of them as the axis, or add points off the line");
    }
}

/// More points than a dense process can take are averaged over the boxes of a regular grid.
SetPoints reduced(const SetPoints& points, std::size_t most, core::Problems& remarks) {
    if (points.x.size() <= most) {
        return points;
    }
    const std::size_t n = points.axes.size();
    SetPoints result = points;
    for (std::size_t side = static_cast<std::size_t>(std::pow(static_cast<double>(most), 1.0 / static_cast<double>(n))) + 1; side > 1; --side) {
        std::vector<std::vector<std::size_t>> boxes;
        std::size_t total = 1;
        for (std::size_t k = 0; k < n; ++k) {
            total *= side;
        }
        boxes.resize(total);
        for (std::size_t i = 0; i < points.x.size(); ++i) {
            std::size_t box = 0;
            for (std::size_t k = 0; k < n; ++k) {
                const auto& axis = points.axes[k];
                const bool log = axis.name == "gap" && axis.lower > 0 && axis.upper / axis.lower >= 4;
                const double t = log ? std::log(points.x[i][k] / axis.lower) / std::log(axis.upper / axis.lower) : (points.x[i][k] - axis.lower) / (axis.upper - axis.lower);
                box = box * side + std::min(side - 1, static_cast<std::size_t>(t * static_cast<double>(side)));
            }
            boxes[box].push_back(i);
        }
        const auto filled = static_cast<std::size_t>(std::count_if(boxes.begin(), boxes.end(), [](const auto& b) { return !b.empty(); }));
        if (filled > most) {
            continue;
        }
        result.x.clear();
        result.value.clear();
        result.sigma.clear();
        result.row.clear();
        for (const auto& box : boxes) {
            if (box.empty()) {
                continue;
            }
            const auto count = static_cast<double>(box.size());
            std::vector<double> x(n, 0.0);
            double value = 0, square = 0, stated = 0;
            for (const std::size_t i : box) {
                for (std::size_t k = 0; k < n; ++k) {
                    x[k] += points.x[i][k] / count;
                }
                value += points.value[i] / count;
                square += points.value[i] * points.value[i] / count;
                stated += points.has_sigma() ? points.sigma[i] * points.sigma[i] / (count * count) : 0;
            }
            result.x.push_back(x);
            result.value.push_back(value);
            result.row.push_back(points.row[box.front()]);
            if (points.has_sigma()) {
                result.sigma.push_back(std::sqrt(std::max(stated, 1e-300)));
            }
        }
        remarks.push_back({core::Problem::Severity::warning,
                           std::to_string(points.x.size()) + " points are more than a Gaussian process takes: they are averaged to " +
                               std::to_string(result.x.size()) + " over boxes of equal size",
                           {points.table.source, {}, {}, {}}});
        break;
    }
    return result;
}

std::vector<double> knots_of(const SetPoints& points, const Form& form, const GpParameters& p, std::size_t k) {
    const TableAxis& axis = points.axes[k];
    static constexpr std::size_t most[] = {400, 90, 30, 15};
    const std::size_t n = points.axes.size();
    const auto wanted = static_cast<std::size_t>(std::ceil((n < 3 ? 8.0 : 5.0) / p.length[k])) + 2;
    const std::size_t count = std::clamp<std::size_t>(std::max(wanted, form.logarithmic[k] ? std::size_t{24} : std::size_t{8}), 6, most[n - 1]);
    std::vector<double> knots(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count - 1);
        knots[i] = i == 0 ? axis.lower : i + 1 == count ? axis.upper : form.logarithmic[k] ? axis.lower * std::pow(axis.upper / axis.lower, t) : axis.lower + t * (axis.upper - axis.lower);
    }
    if (n == 1) {
        // The third derivative of a Matern process jumps at its points.
        const double apart = 1e-3 * (axis.upper - axis.lower) / static_cast<double>(count);
        for (const double x : axis.points.size() <= 200 ? axis.points : std::vector<double>{}) {
            const auto next = std::lower_bound(knots.begin(), knots.end(), x);
            const bool near_next = next != knots.end() && *next - x < apart;
            const bool near_last = next != knots.begin() && x - *(next - 1) < apart;
            if (!near_next && !near_last) {
                knots.insert(next, x);
            }
        }
    }
    return knots;
}

/// Exact Hermite data of the mean on a tensor grid: the kernel is a product over the axes, so each axis has its own matrices.
std::vector<double> hermite_of(const GaussianProcess& process, const Form& form, const std::vector<std::vector<double>>& grid) {
    const GpData& d = process.data();
    const std::size_t n = grid.size();
    const std::size_t points = d.count();
    // part[k][derivative][i * points + q]: kernel factor of grid line i and point q.
    std::vector<std::array<std::vector<double>, 2>> part(n);
    for (std::size_t k = 0; k < n; ++k) {
        for (auto& matrix : part[k]) {
            matrix.resize(grid[k].size() * points);
        }
        for (std::size_t i = 0; i < grid[k].size(); ++i) {
            const double t = form.coordinate(k, grid[k][i]);
            const double rate = form.coordinate_slope(k, grid[k][i]) / process.parameters().length[k];
            const bool swells = form.swelling == k;
            const double amplitude = swells ? std::pow(grid[k][i] / form.swell_gap, -form.swell) : 1;
            const double amplitude_slope = swells ? -form.swell * amplitude / grid[k][i] : 0;
            for (std::size_t q = 0; q < points; ++q) {
                const auto v = kernel_value(process.kernel(), (t - d.x[q * n + k]) / process.parameters().length[k]);
                part[k][0][i * points + q] = amplitude * v.value;
                part[k][1][i * points + q] = amplitude * v.slope * rate + amplitude_slope * v.value;
            }
        }
    }
    std::size_t count = 1;
    for (const auto& axis : grid) {
        count *= axis.size();
    }
    const std::size_t width = std::size_t{1} << n;
    std::vector<double> hermite(count * width);
    // Products over all axes but the last are kept from node to node.
    std::vector<double> product(width / 2 * points);
    const double scale = process.parameters().scale * process.parameters().scale;
    const std::size_t last = grid[n - 1].size();
    for (std::size_t begin = 0; begin < count; begin += last) {
        for (std::size_t mask = 0; mask < width / 2; ++mask) {
            double* to = &product[mask * points];
            for (std::size_t q = 0; q < points; ++q) {
                to[q] = scale * process.weights()[q] * d.amplitude_of(q);
            }
            std::size_t rest = begin / last;
            for (std::size_t k = n - 1; k-- > 0;) {
                const double* from = &part[k][mask >> k & 1][(rest % grid[k].size()) * points];
                rest /= grid[k].size();
                for (std::size_t q = 0; q < points; ++q) {
                    to[q] *= from[q];
                }
            }
        }
        for (std::size_t i = 0; i < last; ++i) {
            for (std::size_t mask = 0; mask < width; ++mask) {
                const double* a = &product[(mask & (width / 2 - 1)) * points];
                const double* b = &part[n - 1][mask >> (n - 1) & 1][i * points];
                hermite[(begin + i) * width + mask] = Eigen::Map<const Eigen::VectorXd>(a, static_cast<Eigen::Index>(points))
                                                          .dot(Eigen::Map<const Eigen::VectorXd>(b, static_cast<Eigen::Index>(points)));
            }
        }
    }
    return hermite;
}

/// Trend, size and squares on top of the process, with their own derivatives.
void add_laws(std::vector<double>& hermite, const GaussianProcess& process, const Form& form, const std::vector<std::vector<double>>& grid) {
    const std::size_t n = grid.size();
    const std::size_t width = std::size_t{1} << n;
    const auto& c = process.coefficients();
    for (std::size_t node = 0; node < hermite.size() / width; ++node) {
        double* data = &hermite[node * width];
        std::vector<double> x(n);
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            x[k] = grid[k][rest % grid[k].size()];
            rest /= grid[k].size();
        }
        data[0] += c[0];
        if (form.film) {
            const double r = form.film_gap / x[*form.film];
            data[0] += c[1] * r * r + c[2] * r * r * r;
            data[std::size_t{1} << *form.film] -= (2 * c[1] * r * r + 3 * c[2] * r * r * r) / x[*form.film];
        }
        for (std::size_t m = 0; m < width; ++m) {
            data[m] *= form.size;
        }
        data[0] += form.offset;
        for (std::size_t k = 0; k < n; ++k) {
            if (!form.squared[k]) {
                continue;
            }
            const double p = std::pow(x[k] / form.reference[k], 2);
            const double slope = 2 * x[k] / (form.reference[k] * form.reference[k]);
            for (std::size_t m = 0; m < width; ++m) {
                if ((m >> k & 1) == 0) {
                    const std::size_t with = m | std::size_t{1} << k;
                    data[with] = p * data[with] + slope * data[m];
                    data[m] *= p;
                }
            }
        }
    }
}

/// Standard deviations at all nodes; on large grids at every other line, or fewer, and linear between.
std::vector<double> sigma_of(const GaussianProcess& process, const Form& form, const std::vector<std::vector<double>>& grid, double inflation) {
    const std::size_t n = grid.size();
    std::size_t count = 1;
    for (const auto& axis : grid) {
        count *= axis.size();
    }
    const double work = static_cast<double>(process.data().count()) * static_cast<double>(process.data().count());
    std::size_t skip = 1;
    while (work * static_cast<double>(count) / std::pow(static_cast<double>(skip), static_cast<double>(n)) > 2e9 && skip < 8) {
        ++skip;
    }
    std::vector<std::vector<double>> coarse(n);
    std::size_t coarse_count = 1;
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < grid[k].size(); i += skip) {
            coarse[k].push_back(grid[k][i]);
        }
        if (coarse[k].back() != grid[k].back()) {
            coarse[k].push_back(grid[k].back());
        }
        coarse_count *= coarse[k].size();
    }
    std::vector<double> t(coarse_count * n), h(coarse_count * form.trends()), factor(coarse_count), amplitude(coarse_count);
    std::vector<double> x(n);
    for (std::size_t node = 0; node < coarse_count; ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            x[k] = coarse[k][rest % coarse[k].size()];
            rest /= coarse[k].size();
            t[node * n + k] = form.coordinate(k, x[k]);
        }
        form.trend(x, &h[node * form.trends()]);
        factor[node] = form.factor(x) * form.size;
        amplitude[node] = form.amplitude(x);
    }
    std::vector<double> sigma = process.variances(t, h, amplitude);
    const double scatter = process.parameters().scatter;
    for (std::size_t node = 0; node < coarse_count; ++node) {
        sigma[node] = factor[node] * std::sqrt(inflation * inflation * sigma[node] + scatter * scatter);
    }
    if (skip == 1) {
        return sigma;
    }
    const ErrorModel between(coarse, std::move(sigma));
    std::vector<double> all(count);
    for (std::size_t node = 0; node < count; ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            x[k] = grid[k][rest % grid[k].size()];
            rest /= grid[k].size();
        }
        all[node] = between.sigma(x.data(), nullptr);
    }
    return all;
}

struct Chosen {
    Form form;
    GpOptions options;
    double score = -INFINITY;
};

Chosen choose_form(const SetPoints& points) {
    const auto rows = spread_rows(points.x.size(), points.axes.size() > 2 ? 120 : 150);
    Chosen best;
    // Points without stated errors are mostly computed ones: little scatter is expected beside the stated error.
    const double expected = points.has_sigma() ? 1e-3 : 1e-2;
    const auto consider = [&](Form form, Kernel kernel, std::vector<GpParameters> starts) {
        GpOptions options;
        options.kernel = kernel;
        options.expected_scatter = expected;
        options.iterations = 30;
        options.starts = std::move(starts);
        const auto process = GaussianProcess::fit(data_of(points, rows, form), options);
        // A law must earn its place: a little handicap for each one.
        double score = score_of(process, points, rows, form) - (form.film ? 1.0 : 0.0) - (form.swelling ? 0.5 : 0.0);
        if (score > best.score) {
            options.starts = {process.parameters()};
            best = {form, options, score};
        }
    };
    for (const Form& form : candidate_forms(points)) {
        consider(form, Kernel::matern52, {});
    }
    consider(best.form, Kernel::squared_exponential, best.options.starts);
    return best;
}

}  // namespace

std::shared_ptr<ForceTable::Impl> fit_gaussian_process(const SetPoints& all_points, const FitOptions& options, std::vector<double>* misses) {
    check_spread(all_points);
    core::Problems remarks = all_points.remarks;
    const SetPoints points = reduced(all_points, 1200, remarks);
    Chosen chosen = choose_form(points);
    std::vector<std::size_t> rows(points.x.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    Form& form = chosen.form;
    GpData data = data_of(points, rows, form);
    const bool refit = points.x.size() <= 600;
    chosen.options.iterations = points.x.size() <= 150 ? 40 : 14;
    const GaussianProcess process = refit ? GaussianProcess::fit(std::move(data), chosen.options)
                                          : GaussianProcess(std::move(data), chosen.options.kernel, chosen.options.starts.front());
    const auto left_out = process.leave_one_out();
    double square = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        square += std::pow(process.data().y[i] - left_out.mean[i], 2) / left_out.variance[i];
    }
    // The process must not be surer than its own leave-one-out errors allow.
    // Nor than so few points can tell about lengths and sizes that were fitted to them.
    const auto count = static_cast<double>(rows.size());
    const double fitted = std::min(static_cast<double>(points.axes.size() + form.trends()) + 1.0, 0.75 * count);
    const double inflation = std::clamp(std::sqrt(square / count), 1.0, 5.0) * std::sqrt(count / (count - fitted));
    if (misses != nullptr) {
        misses->clear();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            misses->push_back((left_out.mean[i] - process.data().y[i]) * form.size * form.factor(points.x[i]));
        }
    }
    auto table = std::make_shared<ForceTable::Impl>();
    table->quantity = points.quantity;
    table->unit = points.unit;
    table->source = points.table.source;
    table->axes = points.axes;
    table->points = points.table;
    table->constants = points.constants;
    table->range = options.range;
    table->kind = "Gaussian process";
    table->rule = SlopeRule::not_a_knot;
    std::string words = std::string("Gaussian process (") + (chosen.options.kernel == Kernel::matern52 ? "Matern 5/2" : "squared exponential") + form.text(points.axes) +
                        "): lengths";
    const auto& p = process.parameters();
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
        words += std::string(k == 0 ? " " : ", ") + core::format_number(p.length[k] * form.span[k], 3) + (form.logarithmic[k] ? " e-foldings of " : " " + points.axes[k].unit + " of ") +
                 points.axes[k].name;
    }
    words += ", unexplained scatter " + core::format_number(p.scatter * form.size, 2) + " " + points.unit +
             (inflation > 1.01 ? ", error widened by " + core::format_number(inflation, 3) + " after leave-one-out" : "");
    remarks.push_back({core::Problem::Severity::note, words, {points.table.source, {}, {}, {}}});
    table->remarks = std::move(remarks);
    std::vector<std::vector<double>> grid;
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
        grid.push_back(knots_of(points, form, p, k));
    }
    auto hermite = hermite_of(process, form, grid);
    add_laws(hermite, process, form, grid);
    table->error = ErrorModel(grid, sigma_of(process, form, grid, inflation));
    table->surface = CubicGrid(grid, std::move(hermite));
    for (std::size_t k = 0; k < grid.size(); ++k) {
        table->error.set_growth(k, end_growth(table->surface, k));
    }
    return table;
}

}  // namespace underbody::tables
