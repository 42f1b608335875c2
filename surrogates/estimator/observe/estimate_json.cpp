#include <cmath>
#include <nlohmann/json.hpp>

#include "surrogates/estimator/model/augmented_model.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::estimator {

using nlohmann::json;

json matrix_json(const Matrix& matrix) {
    json rows = json::array();
    for (std::size_t i = 0; i < matrix.rows(); ++i) {
        rows.push_back(matrix.row(i));
    }
    return rows;
}

namespace {

json poles_json(const Poles& poles) {
    json list = json::array();
    for (const auto& p : poles) {
        list.push_back({{"real", p.real()}, {"imaginary", p.imag()}});
    }
    return list;
}

json finite_or_null(double v) { return std::isfinite(v) ? json(v) : json(); }

json remarks_json(const core::Problems& remarks) {
    json list = json::array();
    for (const auto& r : remarks) {
        list.push_back(r.message);
    }
    return list;
}

}  // namespace

void to_json(json& j, const AugmentedModel& m) {
    j = {{"order", m.order},
         {"rank", m.rank},
         {"eigenvalues", m.eigenvalues},
         {"A", matrix_json(m.A)},
         {"B", matrix_json(m.B)},
         {"offset", m.offset},
         {"states", m.layout.states},
         {"inputs", m.layout.inputs},
         {"measured", m.layout.measured},
         {"fit", m.method},
         {"samples", m.samples},
         {"mean", m.mean},
         {"sigma", m.sigma},
         {"channels", m.layout.names()},
         {"poles", poles_json(eigenvalues(m.A))},
         {"remarks", remarks_json(m.remarks)}};
}

void to_json(json& j, const Separability& s) {
    json hidden = json::array();
    for (std::size_t k = 0; k < s.reduced.unobservable.columns(); ++k) {
        hidden.push_back(s.reduced.unobservable.column_of(k));
    }
    j = {{"labels", s.labels},           {"rank", s.reduced.rank},           {"full_rank", s.full.rank},
         {"determinant", s.determinant}, {"b_eff", finite_or_null(s.b_eff)}, {"unobservable", hidden},
         {"explanation", s.explanation}};
}

void to_json(json& j, const ObserverDesign& d) {
    json labels = json::object();
    for (std::size_t i = 0; i < d.filter.estimates.size() && i < d.labels.size(); ++i) {
        labels[d.filter.estimates[i]] = d.labels[i];
    }
    j = {{"kind", d.filter.name},
         {"step", d.filter.step},
         {"sensors", d.filter.measured},
         {"estimates", d.filter.estimates},
         {"gain", matrix_json(d.gain)},
         {"poles", poles_json(d.poles)},
         {"discrete_poles", poles_json(d.discrete_poles)},
         {"labels", labels},
         {"separability", d.separability},
         {"remarks", remarks_json(d.remarks)}};
    if (!d.covariance.empty()) {
        Vector sigma(d.covariance.rows());
        for (std::size_t i = 0; i < sigma.size(); ++i) {
            sigma[i] = std::sqrt(std::max(d.covariance(i, i), 0.0));
        }
        j["sigma"] = sigma;
    }
}

}  // namespace underbody::estimator
