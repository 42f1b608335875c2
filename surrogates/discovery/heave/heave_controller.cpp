#include "surrogates/discovery/heave/heave_controller.h"

#include <Eigen/Dense>
#include <cmath>

#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr int numbers = 5;
constexpr double far_off = 4;  ///< robust standard deviations: a step of the set point, no answer to a reading

struct Rows {
    std::vector<std::array<double, numbers>> x;
    std::vector<double> y;
    std::vector<std::size_t> record;
};

Rows rows_of(const HeaveRecords& records, const std::vector<std::size_t>& chosen) {
    Rows rows;
    for (const std::size_t r : chosen) {
        const HeaveRecord& one = records.records[r];
        const std::vector<double>& u = one.held_input;
        const std::vector<double>& y = one.gap;
        for (std::size_t k = 3; k < u.size(); ++k) {
            const std::array<double, numbers> x{u[k - 1], u[k - 2], y[k - 1], y[k - 2], y[k - 3]};
            if (std::isfinite(x[2] + x[3] + x[4])) {
                rows.x.push_back(x);
                rows.y.push_back(u[k]);
                rows.record.push_back(r);
            }
        }
    }
    return rows;
}

}  // namespace

ControllerAnswer fit_controller(const HeaveRecords& records, const std::vector<std::size_t>& chosen) {
    ControllerAnswer answer;
    const Rows rows = rows_of(records, chosen);
    if (!records.input_recorded || rows.y.size() < 50) {
        return answer;
    }
    using Vector = Eigen::Matrix<double, numbers, 1>;
    Vector best = Vector::Zero();
    std::vector<bool> used(rows.y.size(), true);
    for (int round = 0; round < 3; ++round) {
        // each record's mean is taken off: its set point is its own
        std::vector<Vector> sum(records.records.size(), Vector::Zero());
        std::vector<double> sum_y(records.records.size(), 0), count(records.records.size(), 0);
        const auto x_of = [&](std::size_t i) { return Eigen::Map<const Vector>(rows.x[i].data()); };
        for (std::size_t i = 0; i < rows.y.size(); ++i) {
            if (used[i]) {
                sum[rows.record[i]] += x_of(i);
                sum_y[rows.record[i]] += rows.y[i];
                count[rows.record[i]] += 1;
            }
        }
        const auto centred = [&](std::size_t i) -> Vector {
            return x_of(i) - sum[rows.record[i]] / count[rows.record[i]];
        };
        Eigen::Matrix<double, numbers, numbers> normal = Eigen::Matrix<double, numbers, numbers>::Zero();
        Vector right = Vector::Zero();
        for (std::size_t i = 0; i < rows.y.size(); ++i) {
            if (used[i]) {
                const Vector x = centred(i);
                normal += x * x.transpose();
                right += x * (rows.y[i] - sum_y[rows.record[i]] / count[rows.record[i]]);
            }
        }
        best = normal.completeOrthogonalDecomposition().solve(right);
        std::vector<double> left;
        for (std::size_t i = 0; i < rows.y.size(); ++i) {
            const double c = std::max(count[rows.record[i]], 1.0);
            left.push_back(rows.y[i] - sum_y[rows.record[i]] / c - best.dot(x_of(i) - sum[rows.record[i]] / c));
        }
        const double sigma = robust_deviation(left);
        for (std::size_t i = 0; i < left.size(); ++i) {
            used[i] = std::abs(left[i]) <= far_off * sigma + 1e-12;
        }
    }
    answer.input = {best[0], best[1]};
    answer.reading = {best[2], best[3], best[4]};
    return answer;
}

}  // namespace underbody::discovery
