#include "surrogates/discovery/flexible.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr double same_place = 1e-9;       ///< of the range: closer values are one
constexpr double least_span = 1e-12;      ///< of the range, between a knot and the last
constexpr double least_variance = 1e-24;  ///< of a column: below it does not vary
constexpr double dependent = 1e-7;        ///< pivot of a column, scaled to one, that says no more than those before it
constexpr double nothing_left = 1e-6;     ///< of a column's length, beside those that are taken
constexpr double steady = 1e-9;           ///< of the largest of a diagonal, added to it: it can be inverted
constexpr double barely_steady = 1e-12;   ///< likewise where the numbers are wanted as they are
constexpr double ridge_step = 0.75;       ///< decades between the ridges that are tried

}  // namespace

SplineBasis::SplineBasis(const std::vector<double>& values, std::size_t columns) {
    std::vector<double> distinct = values;
    std::sort(distinct.begin(), distinct.end());
    const double range = distinct.empty() ? 0 : distinct.back() - distinct.front();
    distinct.erase(
        std::unique(distinct.begin(), distinct.end(), [&](double a, double b) { return b - a <= same_place * range; }),
        distinct.end());
    const std::size_t count = distinct.size() < 2 ? 0 : std::min(columns, distinct.size() - 1);
    if (count == 0) {
        return;
    }
    width_ = range > 0 ? range : 1;
    for (std::size_t k = 0; k <= count; ++k) {
        knots_.push_back(quantile(distinct, static_cast<double>(k) / static_cast<double>(count)));
    }
    for (const double knot : knots_) {
        per_span_.push_back(1 / std::max((knots_.back() - knot) / width_, least_span));
    }
    shift_.assign(count, 0);
    scale_.assign(count, 1);
    std::vector<double> sum(count, 0);
    std::vector<double> square(count, 0);
    std::vector<double> out(count);
    for (const double value : values) {
        raw(value, out.data(), nullptr);
        for (std::size_t k = 0; k < count; ++k) {
            sum[k] += out[k];
            square[k] += out[k] * out[k];
        }
    }
    const double n = static_cast<double>(values.size());
    for (std::size_t k = 0; k < count; ++k) {
        shift_[k] = sum[k] / n;
        const double variance = square[k] / n - shift_[k] * shift_[k];
        scale_[k] = variance > least_variance ? 1 / std::sqrt(variance) : 0;
    }
}

void SplineBasis::raw(double value, double* out, double* slope) const {
    // Hastie, Tibshirani and Friedman, Elements of Statistical Learning (2009), eq. 5.4-5.5
    const std::size_t last = knots_.size() - 1;
    const double per_width = 1 / width_;
    const auto above = [&](std::size_t k) { return std::max(0.0, (value - knots_[k]) * per_width); };
    out[0] = (value - knots_.front()) * per_width;
    if (slope != nullptr) {
        slope[0] = per_width;
    }
    if (last < 2) {
        return;
    }
    const double end = above(last);
    const double end_cube = end * end * end;
    const double before = above(last - 1);
    const double tail = (before * before * before - end_cube) * per_span_[last - 1];
    const double tail_slope = 3 * (before * before - end * end) * per_span_[last - 1];
    for (std::size_t k = 0; k + 1 < last; ++k) {
        const double d = above(k);
        out[k + 1] = (d * d * d - end_cube) * per_span_[k] - tail;
        if (slope != nullptr) {
            slope[k + 1] = (3 * (d * d - end * end) * per_span_[k] - tail_slope) * per_width;
        }
    }
}

void SplineBasis::evaluate(double value, double* out, double* slope) const {
    if (scale_.empty()) {
        return;
    }
    raw(value, out, slope);
    for (std::size_t k = 0; k < scale_.size(); ++k) {
        out[k] = (out[k] - shift_[k]) * scale_[k];
        if (slope != nullptr) {
            slope[k] *= scale_[k];
        }
    }
}

FlexibleBasis::FlexibleBasis(const std::vector<std::vector<double>>& values, std::size_t columns_each) {
    for (const std::vector<double>& variable : values) {
        splines_.emplace_back(variable, std::min(columns_each, most_columns));
        columns_ *= 1 + splines_.back().columns();
    }
}

void FlexibleBasis::evaluate(const double* point, double* out) const {
    out[0] = 1;
    std::size_t filled = 1;
    double own[most_columns];
    for (std::size_t v = 0; v < splines_.size(); ++v) {
        splines_[v].evaluate(point[v], own);
        const std::size_t before = filled;
        for (std::size_t j = 0; j < splines_[v].columns(); ++j) {
            for (std::size_t k = 0; k < before; ++k) {
                out[filled++] = own[j] * out[k];
            }
        }
    }
}

double FlexibleBasis::sum(const double* coefficients, const double* point, double* slopes) const {
    double own[most_columns];
    double own_slope[most_columns];
    if (splines_.empty()) {
        return coefficients[0];
    }
    if (splines_.size() == 1) {
        splines_[0].evaluate(point[0], own, own_slope);
        double total = coefficients[0];
        slopes[0] = 0;
        for (std::size_t j = 0; j < splines_[0].columns(); ++j) {
            total += coefficients[j + 1] * own[j];
            slopes[0] += coefficients[j + 1] * own_slope[j];
        }
        return total;
    }
    // the last variable is the outermost: coefficients of its columns are themselves sums over the others
    double all[6 * most_columns];
    double all_slope[6 * most_columns];
    for (std::size_t v = 0; v < splines_.size(); ++v) {
        all[v * most_columns] = 1;
        all_slope[v * most_columns] = 0;
        splines_[v].evaluate(point[v], own, own_slope);
        slopes[v] = 0;
        for (std::size_t j = 0; j < splines_[v].columns() && j + 1 < most_columns; ++j) {
            all[v * most_columns + j + 1] = own[j];
            all_slope[v * most_columns + j + 1] = own_slope[j];
        }
    }
    double total = 0;
    if (splines_.size() == 2) {
        const std::size_t inner = splines_[0].columns() + 1;
        const double* second = all + most_columns;
        const double* second_slope = all_slope + most_columns;
        for (std::size_t j = 0; j <= splines_[1].columns(); ++j) {
            double value = 0;
            double slope = 0;
            for (std::size_t k = 0; k < inner; ++k) {
                value += coefficients[j * inner + k] * all[k];
                slope += coefficients[j * inner + k] * all_slope[k];
            }
            total += value * second[j];
            slopes[0] += slope * second[j];
            slopes[1] += value * second_slope[j];
        }
        return total;
    }
    std::size_t digit[6] = {};
    for (std::size_t column = 0; column < columns_; ++column) {
        if (coefficients[column] != 0) {
            double product = coefficients[column];
            for (std::size_t v = 0; v < splines_.size(); ++v) {
                product *= all[v * most_columns + digit[v]];
            }
            total += product;
            for (std::size_t s = 0; s < splines_.size(); ++s) {
                double part = coefficients[column];
                for (std::size_t v = 0; v < splines_.size(); ++v) {
                    part *= v == s ? all_slope[v * most_columns + digit[v]] : all[v * most_columns + digit[v]];
                }
                slopes[s] += part;
            }
        }
        for (std::size_t v = 0; v < splines_.size(); ++v) {
            if (++digit[v] <= splines_[v].columns()) {
                break;
            }
            digit[v] = 0;
        }
    }
    return total;
}

DesignMatrix orthonormal(const DesignMatrix& matrix) {
    const Eigen::Map<const Eigen::MatrixXd> a(matrix.values.data(), static_cast<Eigen::Index>(matrix.rows),
                                              static_cast<Eigen::Index>(matrix.columns));
    DesignMatrix result;
    result.rows = matrix.rows;
    if (matrix.columns == 0 || matrix.rows == 0) {
        return result;
    }
    Eigen::MatrixXd scaled = a;
    for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
        const double size = scaled.col(k).norm();
        if (size > 0) {
            scaled.col(k) /= size;
        }
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
    qr.setThreshold(dependent);
    const Eigen::Index rank = qr.rank();
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(scaled.rows(), rank);
    result.columns = static_cast<std::size_t>(rank);
    result.values.assign(q.data(), q.data() + q.size());
    return result;
}

std::vector<double> orthonormal_mix(const DesignMatrix& matrix) {
    const Eigen::Map<const Eigen::MatrixXd> a(matrix.values.data(), static_cast<Eigen::Index>(matrix.rows),
                                              static_cast<Eigen::Index>(matrix.columns));
    Eigen::MatrixXd gram = a.transpose() * a / static_cast<double>(std::max<std::size_t>(matrix.rows, 1));
    gram.diagonal().array() += steady * gram.diagonal().maxCoeff() + core::least_divisor;
    const Eigen::MatrixXd mix = gram.llt().matrixU().solve(Eigen::MatrixXd::Identity(gram.rows(), gram.cols()));
    return {mix.data(), mix.data() + mix.size()};
}

double explained_square(const DesignMatrix& orthonormal_columns, const std::vector<double>& y) {
    const auto rows = static_cast<Eigen::Index>(orthonormal_columns.rows);
    const Eigen::Map<const Eigen::MatrixXd> q(orthonormal_columns.values.data(), rows,
                                              static_cast<Eigen::Index>(orthonormal_columns.columns));
    return (q.transpose() * Eigen::Map<const Eigen::VectorXd>(y.data(), rows)).squaredNorm();
}

DesignMatrix orthonormal_beside(const DesignMatrix& taken, const DesignMatrix& matrix) {
    if (taken.columns == 0) {
        return orthonormal(matrix);
    }
    using Map = Eigen::Map<const Eigen::MatrixXd>;
    const Map q(taken.values.data(), static_cast<Eigen::Index>(taken.rows), static_cast<Eigen::Index>(taken.columns));
    Eigen::MatrixXd left =
        Map(matrix.values.data(), static_cast<Eigen::Index>(matrix.rows), static_cast<Eigen::Index>(matrix.columns));
    DesignMatrix result = matrix;
    for (Eigen::Index k = 0; k < left.cols(); ++k) {
        const double size = left.col(k).norm();
        left.col(k) -= q * (q.transpose() * left.col(k));
        if (left.col(k).norm() < nothing_left * size) {
            left.col(k).setZero();
        }
    }
    result.values.assign(left.data(), left.data() + left.size());
    return orthonormal(result);
}

std::vector<std::vector<double>> moves_without_groups(const DesignMatrix& jacobian,
                                                      const std::vector<double>& residuals,
                                                      const std::vector<std::size_t>& begin,
                                                      const std::vector<double>& numbers, double ridge) {
    const Eigen::Map<const Eigen::MatrixXd> j(jacobian.values.data(), static_cast<Eigen::Index>(jacobian.rows),
                                              static_cast<Eigen::Index>(jacobian.columns));
    const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
    const Eigen::MatrixXd normal = j.transpose() * j;
    Eigen::VectorXd slope = j.transpose() * r;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        slope(static_cast<Eigen::Index>(k)) += ridge * numbers[k];
    }
    std::vector<std::vector<double>> moves;
    for (std::size_t g = 0; g + 1 < begin.size(); ++g) {
        const Eigen::Index from = static_cast<Eigen::Index>(begin[g]);
        const Eigen::Index count = static_cast<Eigen::Index>(begin[g + 1] - begin[g]);
        const Eigen::MatrixXd own = j.middleRows(from, count);
        Eigen::MatrixXd others = normal - own.transpose() * own;
        others.diagonal().array() += steady * normal.diagonal().maxCoeff() + barely_steady + ridge;
        const Eigen::VectorXd move = others.ldlt().solve(own.transpose() * r.segment(from, count) - slope);
        moves.emplace_back(move.data(), move.data() + move.size());
    }
    return moves;
}

std::vector<double> grouped_variances(const DesignMatrix& jacobian, const std::vector<double>& residuals,
                                      const std::vector<std::size_t>& begin) {
    const Eigen::Map<const Eigen::MatrixXd> j(jacobian.values.data(), static_cast<Eigen::Index>(jacobian.rows),
                                              static_cast<Eigen::Index>(jacobian.columns));
    const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
    const Eigen::Index n = j.cols();
    Eigen::MatrixXd normal = j.transpose() * j;
    normal.diagonal().array() += barely_steady * normal.diagonal().maxCoeff() + core::least_divisor;
    const Eigen::MatrixXd inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(n, n);
    const std::size_t groups = begin.size() - 1;
    for (std::size_t g = 0; g < groups; ++g) {
        const Eigen::Index from = static_cast<Eigen::Index>(begin[g]);
        const Eigen::Index count = static_cast<Eigen::Index>(begin[g + 1] - begin[g]);
        const Eigen::VectorXd score = j.middleRows(from, count).transpose() * r.segment(from, count);
        middle += score * score.transpose();
    }
    if (groups > 1) {
        middle *= static_cast<double>(groups) / static_cast<double>(groups - 1);
    }
    const Eigen::MatrixXd grouped = inverse * middle * inverse;
    std::vector<double> variances(static_cast<std::size_t>(n), 0);
    for (Eigen::Index k = 0; k < n; ++k) {
        if (j.col(k).squaredNorm() > 0) {
            variances[static_cast<std::size_t>(k)] = std::max(inverse(k, k), groups > 2 ? grouped(k, k) : 0);
        }
    }
    return variances;
}

void take_out(const DesignMatrix& basis, std::vector<double>& y) {
    for (std::size_t k = 0; k < basis.columns; ++k) {
        const double* column = basis.values.data() + k * basis.rows;
        double dot = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            dot += column[i] * y[i];
        }
        for (std::size_t i = 0; i < y.size(); ++i) {
            y[i] -= dot * column[i];
        }
    }
}

RidgeFit ridge_fit(const DesignMatrix& matrix, const std::vector<double>& y) {
    const Eigen::Index n = static_cast<Eigen::Index>(matrix.rows);
    const Eigen::Map<const Eigen::MatrixXd> a(matrix.values.data(), n, static_cast<Eigen::Index>(matrix.columns));
    const Eigen::Map<const Eigen::VectorXd> b(y.data(), n);
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd s = svd.singularValues();
    const Eigen::VectorXd c = svd.matrixU().transpose() * b;
    const double outside = std::max(0.0, b.squaredNorm() - c.squaredNorm());
    double best = core::no_limit;
    double ridge = 0;
    for (int step = -10; step <= 8; ++step) {
        const double trial = s.size() > 0 ? s(0) * s(0) * std::pow(10.0, ridge_step * step - 4) : 0;
        double rest = outside;
        double degrees = 0;
        for (Eigen::Index k = 0; k < s.size(); ++k) {
            const double keep = s(k) * s(k) / (s(k) * s(k) + trial + core::least_divisor);
            rest += (1 - keep) * (1 - keep) * c(k) * c(k);
            degrees += keep;
        }
        const double left = std::max(static_cast<double>(n) - degrees, 1.0);
        if (rest / (left * left) < best) {
            best = rest / (left * left);
            ridge = trial;
        }
    }
    RidgeFit fit;
    Eigen::VectorXd shrunk(s.size());
    fit.residual_square = outside;
    for (Eigen::Index k = 0; k < s.size(); ++k) {
        const double keep = s(k) * s(k) / (s(k) * s(k) + ridge + core::least_divisor);
        shrunk(k) = s(k) > barely_steady * s(0) ? keep * c(k) / s(k) : 0;
        fit.residual_square += (1 - keep) * (1 - keep) * c(k) * c(k);
        fit.degrees += keep;
    }
    const Eigen::VectorXd coefficients = svd.matrixV() * shrunk;
    const Eigen::VectorXd fitted = a * coefficients;
    fit.coefficients.assign(coefficients.data(), coefficients.data() + coefficients.size());
    fit.fitted.assign(fitted.data(), fitted.data() + fitted.size());
    return fit;
}

}  // namespace underbody::discovery
