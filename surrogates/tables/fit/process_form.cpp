#include "surrogates/tables/fit/process_form.h"

#include <numeric>

#include "core/no_limit.h"
#include "core/text.h"

namespace underbody::tables {

std::string Form::text(const std::vector<TableAxis>& axes) const {
    std::string words;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        words += logarithmic[k] ? ", logarithm of " + axes[k].name : "";
        words += squared[k] ? ", force over " + axes[k].name + " squared" : "";
    }
    if (decay) {
        words += ", decay to the free-stream value as h^-" + core::format_number(decay_power, 2);
    }
    return words + (film ? ", film terms 1/h^2 and 1/h^3" : "");
}

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
    form.size = core::never_zero(std::sqrt(square / static_cast<double>(z.size())));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& x = points.x[rows[i]];
        for (std::size_t k = 0; k < n; ++k) {
            data.x.push_back(form.coordinate(k, x[k]));
        }
        double h[3];
        form.trend(x, h);
        if (form.decay) {
            data.amplitude.push_back(form.amplitude(x));
        }
        data.trend.insert(data.trend.end(), h, h + data.trends);
        data.y.push_back((z[i] - form.offset) / form.size);
        const double s = points.noise(rows[i]) / form.factor(x) / form.size;
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
                form.decay = k;
                form.decay_gap = std::sqrt(axis.lower * axis.upper);
                for (const double power : {0.5, 1.0}) {
                    form.decay_power = power;
                    if (points.x.size() >= 8) {
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

}  // namespace underbody::tables
