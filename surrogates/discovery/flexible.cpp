#include "surrogates/discovery/flexible.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

SplineBasis::SplineBasis(const std::vector<double>& values, std::size_t columns) {
    std::vector<double> distinct = values;
    std::sort(distinct.begin(), distinct.end());
    const double range = distinct.empty() ? 0 : distinct.back() - distinct.front();
    distinct.erase(std::unique(distinct.begin(), distinct.end(), [&](double a, double b) { return b - a <= 1e-9 * range; }),
                   distinct.end());
    const std::size_t count = distinct.size() < 2 ? 0 : std::min(columns, distinct.size() - 1);
    if (count == 0) {
        return;
    }
    width_ = range > 0 ? range : 1;
    for (std::size_t k = 0; k <= count; ++k) {
        knots_.push_back(quantile(distinct, static_cast<double>(k) / static_cast<double>(count)));
    }
    shift_.assign(count, 0);
    scale_.assign(count, 1);
    std::vector<double> sum(count, 0);
    std::vector<double> square(count, 0);
    std::vector<double> out(count);
    for (const double value : values) {
        raw(value, out.data());
        for (std::size_t k = 0; k < count; ++k) {
            sum[k] += out[k];
            square[k] += out[k] * out[k];
        }
    }
    const double n = static_cast<double>(values.size());
    for (std::size_t k = 0; k < count; ++k) {
        shift_[k] = sum[k] / n;
        const double variance = square[k] / n - shift_[k] * shift_[k];
        scale_[k] = variance > 1e-24 ? 1 / std::sqrt(variance) : 0;
    }
}

void SplineBasis::raw(double value, double* out) const {
    // Hastie, Tibshirani and Friedman, Elements of Statistical Learning (2009), eq. 5.4-5.5
    const std::size_t last = knots_.size() - 1;
    const auto cube = [&](double knot) {
        const double d = (value - knot) / width_;
        return d > 0 ? d * d * d : 0.0;
    };
    const auto truncated = [&](std::size_t k) {
        return (cube(knots_[k]) - cube(knots_[last])) / std::max((knots_[last] - knots_[k]) / width_, 1e-12);
    };
    out[0] = (value - knots_.front()) / width_;
    if (last < 2) {
        return;
    }
    const double end = truncated(last - 1);
    for (std::size_t k = 0; k + 1 < last; ++k) {
        out[k + 1] = truncated(k) - end;
    }
}

void SplineBasis::evaluate(double value, double* out) const {
    if (scale_.empty()) {
        return;
    }
    raw(value, out);
    for (std::size_t k = 0; k < scale_.size(); ++k) {
        out[k] = (out[k] - shift_[k]) * scale_[k];
    }
}

FlexibleBasis::FlexibleBasis(const std::vector<std::vector<double>>& values, std::size_t columns_each) {
    for (const std::vector<double>& variable : values) {
        splines_.emplace_back(variable, columns_each);
        columns_ *= 1 + splines_.back().columns();
    }
}

void FlexibleBasis::evaluate(const double* point, double* out) const {
    out[0] = 1;
    std::size_t filled = 1;
    std::vector<double> own;
    for (std::size_t v = 0; v < splines_.size(); ++v) {
        own.resize(splines_[v].columns());
        splines_[v].evaluate(point[v], own.data());
        const std::size_t before = filled;
        for (const double factor : own) {
            for (std::size_t k = 0; k < before; ++k) {
                out[filled++] = factor * out[k];
            }
        }
    }
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
    qr.setThreshold(1e-7);
    const Eigen::Index rank = qr.rank();
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(scaled.rows(), rank);
    result.columns = static_cast<std::size_t>(rank);
    result.values.assign(q.data(), q.data() + q.size());
    return result;
}

double explained_square(const DesignMatrix& orthonormal_columns, const std::vector<double>& y) {
    double sum = 0;
    for (std::size_t k = 0; k < orthonormal_columns.columns; ++k) {
        const double* column = orthonormal_columns.values.data() + k * orthonormal_columns.rows;
        double dot = 0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            dot += column[i] * y[i];
        }
        sum += dot * dot;
    }
    return sum;
}

RidgeFit ridge_fit(const DesignMatrix& matrix, const std::vector<double>& y) {
    const Eigen::Index n = static_cast<Eigen::Index>(matrix.rows);
    const Eigen::Map<const Eigen::MatrixXd> a(matrix.values.data(), n, static_cast<Eigen::Index>(matrix.columns));
    const Eigen::Map<const Eigen::VectorXd> b(y.data(), n);
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd s = svd.singularValues();
    const Eigen::VectorXd c = svd.matrixU().transpose() * b;
    const double outside = std::max(0.0, b.squaredNorm() - c.squaredNorm());
    double best = 1e300;
    double ridge = 0;
    for (int step = -10; step <= 8; ++step) {
        const double trial = s.size() > 0 ? s(0) * s(0) * std::pow(10.0, 0.75 * step - 4) : 0;
        double rest = outside;
        double degrees = 0;
        for (Eigen::Index k = 0; k < s.size(); ++k) {
            const double keep = s(k) * s(k) / (s(k) * s(k) + trial + 1e-300);
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
        const double keep = s(k) * s(k) / (s(k) * s(k) + ridge + 1e-300);
        shrunk(k) = s(k) > 1e-12 * s(0) ? keep * c(k) / s(k) : 0;
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
