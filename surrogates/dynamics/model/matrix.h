// A small dense matrix as a plain value, so that no linear-algebra library crosses the public headers.
#pragma once

#include <cassert>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace underbody::dynamics {

/// Row-major, zero when made by size. Sizes of operands are the caller's duty (assertions).
class Matrix {
public:
    Matrix() = default;
    Matrix(std::size_t rows, std::size_t columns) : rows_(rows), columns_(columns), values_(rows * columns, 0.0) {}
    Matrix(std::initializer_list<std::initializer_list<double>> rows);

    static Matrix identity(std::size_t size);
    static Matrix column(const std::vector<double>& values);
    static Matrix diagonal(const std::vector<double>& values);

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    [[nodiscard]] bool empty() const { return values_.empty(); }
    [[nodiscard]] double* data() { return values_.data(); }
    [[nodiscard]] const double* data() const { return values_.data(); }

    double& operator()(std::size_t i, std::size_t j) {
        assert(i < rows_ && j < columns_);
        return values_[i * columns_ + j];
    }
    double operator()(std::size_t i, std::size_t j) const {
        assert(i < rows_ && j < columns_);
        return values_[i * columns_ + j];
    }

    [[nodiscard]] Matrix transposed() const;
    [[nodiscard]] std::vector<double> row(std::size_t i) const;
    [[nodiscard]] std::vector<double> column_of(std::size_t j) const;
    void set_row(std::size_t i, const std::vector<double>& values);
    /// `rows` x `columns` entries from (i, j).
    [[nodiscard]] Matrix block(std::size_t i, std::size_t j, std::size_t rows, std::size_t columns) const;
    void set_block(std::size_t i, std::size_t j, const Matrix& block);
    [[nodiscard]] double largest() const;  ///< max |entry|
    [[nodiscard]] bool finite() const;

private:
    std::size_t rows_ = 0;
    std::size_t columns_ = 0;
    std::vector<double> values_;
};

Matrix operator+(const Matrix& a, const Matrix& b);
Matrix operator-(const Matrix& a, const Matrix& b);
Matrix operator*(const Matrix& a, const Matrix& b);
Matrix operator*(double factor, const Matrix& a);
std::vector<double> operator*(const Matrix& a, const std::vector<double>& x);

}  // namespace underbody::dynamics
