// Smooth functions of a few variables without a law: splines and their products, for tests and for corrections.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace underbody::discovery {

/// Natural cubic splines of one variable (its linear part included, its constant not), each column of mean zero and mean square one
/// over the values it was made from.
class SplineBasis {
public:
    /// `columns` at most the number of distinct values less one. Knots stand at quantiles of the distinct values.
    SplineBasis(const std::vector<double>& values, std::size_t columns);
    [[nodiscard]] std::size_t columns() const { return scale_.size(); }
    /// Writes columns() numbers. Beyond the outermost knots the functions go on as straight lines.
    void evaluate(double value, double* out) const;

private:
    void raw(double value, double* out) const;
    std::vector<double> knots_;
    double width_ = 1;
    std::vector<double> shift_;
    std::vector<double> scale_;
};

/// Products of the splines of several variables, with a constant: 1, s_i(x), s_j(y), s_i(x) s_j(y), ...
class FlexibleBasis {
public:
    FlexibleBasis() = default;
    /// `values[v]` are the variable v's values at the data.
    FlexibleBasis(const std::vector<std::vector<double>>& values, std::size_t columns_each);
    [[nodiscard]] std::size_t columns() const { return columns_; }
    void evaluate(const double* point, double* out) const;

private:
    std::vector<SplineBasis> splines_;
    std::size_t columns_ = 1;
};

/// Column-major matrix of plain doubles, so that no linear-algebra header is needed here.
struct DesignMatrix {
    std::size_t rows = 0;
    std::size_t columns = 0;
    std::vector<double> values;  ///< values[column * rows + row]
    double& at(std::size_t row, std::size_t column) { return values[column * rows + row]; }
};

/// An orthonormal basis of the columns (near-dependent ones dropped).
DesignMatrix orthonormal(const DesignMatrix& matrix);
/// Sum of squares of `y` in the span of orthonormal columns.
double explained_square(const DesignMatrix& orthonormal_columns, const std::vector<double>& y);

/// Least squares with a ridge chosen by generalised cross-validation (Golub, Heath and Wahba 1979).
struct RidgeFit {
    std::vector<double> coefficients;
    double residual_square = 0;
    double degrees = 0;      ///< effective degrees of freedom
    std::vector<double> fitted;
};
RidgeFit ridge_fit(const DesignMatrix& matrix, const std::vector<double>& y);

}  // namespace underbody::discovery
