#include "surrogates/tables/fit/force_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "core/told.h"
#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/points/select.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

using core::InputError;

const std::vector<std::string>& fit_kinds() {
    static const std::vector<std::string> words = {"automatic", "interpolation", "gaussian_process",
                                                   "spline"};  // in the order of FitOptions::Kind
    return words;
}

std::string to_string(FitOptions::Kind kind) { return fit_kinds()[static_cast<std::size_t>(kind)]; }

std::optional<FitOptions::Kind> fit_kind(const std::string& word) {
    const std::string known = word == "auto" ? "automatic" : word == "gp" ? "gaussian_process" : word;
    const auto at = std::find(fit_kinds().begin(), fit_kinds().end(), known);
    return at == fit_kinds().end() ? std::nullopt
                                   : std::optional(static_cast<FitOptions::Kind>(at - fit_kinds().begin()));
}

ForceTable::ForceTable(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

const std::string& ForceTable::quantity() const { return impl_->quantity; }
const std::string& ForceTable::unit() const { return impl_->unit; }
const std::vector<TableAxis>& ForceTable::axes() const { return impl_->axes; }
const std::string& ForceTable::kind() const { return impl_->kind; }
const std::string& ForceTable::source() const { return impl_->source; }
double ForceTable::sampling_error() const { return impl_->sampling_error; }
double ForceTable::point_scatter() const { return impl_->point_scatter; }
const core::Problems& ForceTable::remarks() const { return impl_->remarks; }
const core::Table& ForceTable::points() const { return impl_->points; }
const std::vector<double>& ForceTable::knots(std::size_t axis) const { return impl_->surface.axis(axis).points(); }
const std::vector<std::pair<std::string, double>>& ForceTable::conditions() const { return impl_->constants; }

bool ForceTable::is_monotone_interpolation() const {
    const CubicGrid& surface = impl_->surface;
    const std::vector<double>& data = surface.hermite();
    const std::size_t n = surface.dimensions();
    std::vector<double> values;
    for (std::size_t node = 0; node < surface.nodes(); ++node) {
        values.push_back(data[node << n]);
    }
    const CubicGrid again(surface.points(), values, SlopeRule::monotone);
    std::vector<double> size(std::size_t{1} << n, 0.0), off(size);
    for (std::size_t i = 0; i < data.size(); ++i) {
        const std::size_t derivative = i & (size.size() - 1);
        size[derivative] = std::max(size[derivative], std::abs(data[i]));
        off[derivative] = std::max(off[derivative], std::abs(data[i] - again.hermite()[i]));
    }
    return std::equal(off.begin(), off.end(), size.begin(), [](double o, double s) { return o <= 1e-9 * s; });
}

ForceTable ForceTable::read(const std::filesystem::path& path, const std::string& quantity, const FitOptions& options) {
    return fit(read_points(path), quantity, options);
}

std::optional<ForceTable> ForceTable::exported(const core::Table& table, const std::string& quantity,
                                               const FitOptions& options) {
    auto impl = fit_exported(table, quantity, options);
    return impl ? std::optional<ForceTable>(ForceTable(std::move(impl))) : std::nullopt;
}

ForceTable ForceTable::fit(const core::Table& table, const std::string& quantity, const FitOptions& options) {
    if (options.kind == FitOptions::Kind::automatic) {
        if (auto as_it_was = exported(table, quantity, options)) {
            return *as_it_was;
        }
    }
    return ForceTable(fit_points(set_points(table, quantity, options), options));
}

double ForceTable::value(const double* point, double* slope) const noexcept {
    return impl_->surface.value(point, slope);
}

double ForceTable::value_by_policy(const double* point, double* slope, unsigned free) const {
    unsigned going_on = 0;
    for (std::size_t k = 0; k < impl_->axes.size(); ++k) {
        const TableAxis& axis = impl_->axes[k];
        if ((free >> k & 1) != 0 || (point[k] >= axis.lower && point[k] <= axis.upper) || std::isnan(point[k])) {
            continue;
        }
        if (axis.range == RangePolicy::refuse) {
            throw InputError(
                "range",
                axis.name + " " + core::told(point[k], axis.unit) + " is outside the table, which covers " +
                    core::told_range(axis.lower, axis.upper, axis.unit) + " and refuses all else",
                {impl_->source, {}, {}, {}},
                "take a value in the range, or let " + axis.name + " hold its end value (clamp) or extrapolate");
        }
        going_on |= axis.range == RangePolicy::extrapolate ? 1U << k : 0;
    }
    return going_on == 0 ? impl_->surface.value(point, slope) : impl_->surface.continued(point, slope, going_on);
}

Evaluation ForceTable::at(std::span<const double> point) const {
    const Impl& t = *impl_;
    const std::size_t n = t.axes.size();
    if (point.size() != n) {
        throw InputError("axis",
                         "this table has " + std::to_string(n) + " axes, the point " + std::to_string(point.size()));
    }
    Evaluation result;
    for (std::size_t k = 0; k < n; ++k) {
        const TableAxis& axis = t.axes[k];
        if (std::isnan(point[k])) {
            throw InputError("range", axis.name + " is not a number");
        }
        result.beyond[k] = point[k] < axis.lower   ? point[k] - axis.lower
                           : point[k] > axis.upper ? point[k] - axis.upper
                                                   : 0;
        result.outside = result.outside || result.beyond[k] != 0;
    }
    result.value = value_by_policy(point.data(), result.slope.data());
    result.sigma = sigma(point.data());
    const Support* support = t.data_support();
    result.no_data = result.outside || (support != nullptr && support->no_data(point.data()));
    return result;
}

const Support* ForceTable::Impl::data_support() const {
    return support ? support.get() : hull ? &hull->support() : nullptr;
}

double ForceTable::sigma(const double* point) const noexcept {
    std::array<double, max_axes> beyond{};
    for (std::size_t k = 0; k < impl_->axes.size(); ++k) {
        const GridAxis& axis = impl_->surface.axis(k);
        beyond[k] = point[k] < axis.lower()   ? point[k] - axis.lower()
                    : point[k] > axis.upper() ? point[k] - axis.upper()
                                              : 0;
    }
    return impl_->error.sigma(point, beyond.data());
}

ForceTable ForceTable::drawn(std::uint64_t seed) const { return ForceTable(drawn_from(*impl_, seed)); }

}  // namespace underbody::tables
