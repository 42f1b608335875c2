// Smooth functions of a few variables without a law: splines and their products, for tests and for corrections.
#pragma once

#include <cstddef>
#include <vector>

namespace underbody::discovery {

/// Natural cubic splines of one variable (its linear part included, its constant not), each column of mean zero and
/// mean square one over the values it was made from.
class SplineBasis {
public:
    /// `columns` at most the number of distinct values less one. Knots stand at quantiles of the distinct values.
    SplineBasis(const std::vector<double>& values, std::size_t columns);
    [[nodiscard]] std::size_t columns() const { return scale_.size(); }
    /// Writes columns() numbers, and their slopes where asked for. Beyond the outermost knots the functions go on as
    /// straight lines.
    void evaluate(double value, double* out, double* slope = nullptr) const;

private:
    void raw(double value, double* out, double* slope) const;
    std::vector<double> knots_;
    std::vector<double> per_span_;  ///< 1 over the distance from a knot to the last one, in widths
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
    /// With its own number of columns for each variable.
    FlexibleBasis(const std::vector<std::vector<double>>& values, const std::vector<std::size_t>& columns) {
        for (std::size_t v = 0; v < values.size(); ++v) {
            splines_.emplace_back(values[v], columns[v] < most_columns ? columns[v] : most_columns);
            columns_ *= 1 + splines_.back().columns();
        }
    }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    void evaluate(const double* point, double* out) const;
    /// Sum of coefficients times columns, and its slope along each variable.
    [[nodiscard]] double sum(const double* coefficients, const double* point, double* slopes) const;
    static constexpr std::size_t most_columns = 16;  ///< of one variable

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
/// Square matrix, column-major, that makes the columns orthonormal (mean square one, one after the other): columns *
/// mix. Splines of one variable are nearly alike; as they stand a prior on their coefficients would forbid what bends
/// often.
std::vector<double> orthonormal_mix(const DesignMatrix& matrix);
/// Sum of squares of `y` in the span of orthonormal columns.
double explained_square(const DesignMatrix& orthonormal_columns, const std::vector<double>& y);

/// Takes the part of `y` in the span of orthonormal columns away.
void take_out(const DesignMatrix& orthonormal_columns, std::vector<double>& y);

/// Columns of `matrix` with their parts in the span of `taken` (orthonormal) removed, made orthonormal.
DesignMatrix orthonormal_beside(const DesignMatrix& taken, const DesignMatrix& matrix);

/// For each group of rows (begin[g] .. begin[g + 1]) how far the numbers behind the columns move when that group is
/// left out of the fit, to first order about a fit of all groups whose residuals are `residuals`. With a ridge about
/// zero of that weight on the numbers, which stand at `numbers` (empty: no ridge).
std::vector<std::vector<double>> moves_without_groups(const DesignMatrix& jacobian,
                                                      const std::vector<double>& residuals,
                                                      const std::vector<std::size_t>& begin,
                                                      const std::vector<double>& numbers = {}, double ridge = 0);

/// Variances of the numbers behind the columns from how much groups of rows disagree (sandwich of Huber 1967, grouped),
/// each at least that of white unit residuals; 0 for a column of zeros.
std::vector<double> grouped_variances(const DesignMatrix& jacobian, const std::vector<double>& residuals,
                                      const std::vector<std::size_t>& begin);

/// Least squares with a ridge chosen by generalised cross-validation (Golub, Heath and Wahba 1979).
struct RidgeFit {
    std::vector<double> coefficients;
    double residual_square = 0;
    double degrees = 0;  ///< effective degrees of freedom
    std::vector<double> fitted;
};
RidgeFit ridge_fit(const DesignMatrix& matrix, const std::vector<double>& y);

}  // namespace underbody::discovery
