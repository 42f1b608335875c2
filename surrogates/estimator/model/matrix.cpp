#include "surrogates/estimator/model/matrix.h"

#include <algorithm>
#include <cmath>

namespace underbody::estimator {

Matrix::Matrix(std::initializer_list<std::initializer_list<double>> rows)
    : Matrix(rows.size(), rows.size() == 0 ? 0 : rows.begin()->size()) {
    std::size_t i = 0;
    for (const auto& row : rows) {
        assert(row.size() == columns_);
        std::copy(row.begin(), row.end(), values_.begin() + static_cast<std::ptrdiff_t>(i * columns_));
        ++i;
    }
}

Matrix Matrix::identity(std::size_t size) {
    Matrix m(size, size);
    for (std::size_t i = 0; i < size; ++i) {
        m(i, i) = 1;
    }
    return m;
}

Matrix Matrix::column(const Vector& values) {
    Matrix m(values.size(), 1);
    m.values_ = values;
    return m;
}

Matrix Matrix::diagonal(const Vector& values) {
    Matrix m(values.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        m(i, i) = values[i];
    }
    return m;
}

Matrix Matrix::transposed() const {
    Matrix m(columns_, rows_);
    for (std::size_t i = 0; i < rows_; ++i) {
        for (std::size_t j = 0; j < columns_; ++j) {
            m(j, i) = (*this)(i, j);
        }
    }
    return m;
}

Vector Matrix::row(std::size_t i) const {
    Vector v(columns_);
    for (std::size_t j = 0; j < columns_; ++j) {
        v[j] = (*this)(i, j);
    }
    return v;
}

Vector Matrix::column_of(std::size_t j) const {
    Vector v(rows_);
    for (std::size_t i = 0; i < rows_; ++i) {
        v[i] = (*this)(i, j);
    }
    return v;
}

void Matrix::set_row(std::size_t i, const Vector& values) {
    assert(values.size() == columns_);
    for (std::size_t j = 0; j < columns_; ++j) {
        (*this)(i, j) = values[j];
    }
}

Matrix Matrix::block(std::size_t i, std::size_t j, std::size_t rows, std::size_t columns) const {
    Matrix m(rows, columns);
    for (std::size_t a = 0; a < rows; ++a) {
        for (std::size_t b = 0; b < columns; ++b) {
            m(a, b) = (*this)(i + a, j + b);
        }
    }
    return m;
}

void Matrix::set_block(std::size_t i, std::size_t j, const Matrix& block) {
    for (std::size_t a = 0; a < block.rows(); ++a) {
        for (std::size_t b = 0; b < block.columns(); ++b) {
            (*this)(i + a, j + b) = block(a, b);
        }
    }
}

double Matrix::largest() const {
    double m = 0;
    for (const double v : values_) {
        m = std::max(m, std::abs(v));
    }
    return m;
}

bool Matrix::finite() const {
    return std::all_of(values_.begin(), values_.end(), [](double v) { return std::isfinite(v); });
}

Matrix operator+(const Matrix& a, const Matrix& b) {
    assert(a.rows() == b.rows() && a.columns() == b.columns());
    Matrix m = a;
    for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t j = 0; j < a.columns(); ++j) {
            m(i, j) += b(i, j);
        }
    }
    return m;
}

Matrix operator-(const Matrix& a, const Matrix& b) { return a + (-1.0) * b; }

Matrix operator*(const Matrix& a, const Matrix& b) {
    assert(a.columns() == b.rows());
    Matrix m(a.rows(), b.columns());
    for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t k = 0; k < a.columns(); ++k) {
            for (std::size_t j = 0; j < b.columns(); ++j) {
                m(i, j) += a(i, k) * b(k, j);
            }
        }
    }
    return m;
}

Matrix operator*(double factor, const Matrix& a) {
    Matrix m = a;
    for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t j = 0; j < a.columns(); ++j) {
            m(i, j) *= factor;
        }
    }
    return m;
}

Vector operator*(const Matrix& a, const Vector& x) {
    assert(a.columns() == x.size());
    Vector y(a.rows(), 0.0);
    for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t j = 0; j < a.columns(); ++j) {
            y[i] += a(i, j) * x[j];
        }
    }
    return y;
}

}  // namespace underbody::estimator
