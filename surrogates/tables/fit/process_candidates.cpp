#include "surrogates/tables/fit/process_candidates.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace underbody::tables {

std::vector<std::size_t> all_rows(std::size_t count) {
    std::vector<std::size_t> rows(count);
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    return rows;
}

namespace {

/// Every so many-th point of a shuffled order: spread over the set, the same each time.
std::vector<std::size_t> spread_rows(std::size_t count, std::size_t wanted) {
    if (count <= wanted) {
        return all_rows(count);
    }
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < wanted; ++i) {
        chosen.push_back(i * count / wanted);
    }
    return chosen;
}

/// Log density of the measured forces themselves, so that forms with different scales compare.
double score_of(const GaussianProcess& process, const SetPoints& points, const std::vector<std::size_t>& rows,
                const Form& form) {
    double score = process.leave_one_out().log_density - static_cast<double>(rows.size()) * std::log(form.size);
    for (const std::size_t i : rows) {
        score -= std::log(form.factor(points.x[i]));
    }
    return score;
}

}  // namespace

std::vector<ProcessCandidate> ranked_candidates(const SetPoints& points) {
    const auto rows = spread_rows(points.x.size(), points.axes.size() > 2 ? 120 : 150);
    std::vector<ProcessCandidate> all;
    const auto consider = [&](Form form, Kernel kernel, std::vector<GpParameters> starts) {
        GpOptions options;
        options.kernel = kernel;
        options.expected_scatter = expected_scatter(points);
        options.iterations = 30;
        options.starts = std::move(starts);
        const auto process = GaussianProcess::fit(data_of(points, rows, form), options);
        // A law must earn its place: a little handicap for each one.
        const double score = score_of(process, points, rows, form) - (form.film ? 1.0 : 0.0) - (form.decay ? 0.5 : 0.0);
        options.starts = {process.parameters()};
        all.push_back({std::move(form), std::move(options), score});
    };
    for (const Form& form : candidate_forms(points)) {
        consider(form, Kernel::matern52, {});
    }
    const auto better = [](const ProcessCandidate& a, const ProcessCandidate& b) { return a.score > b.score; };
    std::stable_sort(all.begin(), all.end(), better);
    const ProcessCandidate best = all.front();
    consider(best.form, Kernel::squared_exponential, best.options.starts);
    std::stable_sort(all.begin(), all.end(), better);
    return all;
}

}  // namespace underbody::tables
