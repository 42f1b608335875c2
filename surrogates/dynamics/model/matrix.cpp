#include "surrogates/dynamics/model/matrix.h"

#include <Eigen/Core>
#include <cmath>

namespace underbody::dynamics {

namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::Index;

Eigen::Map<const Rows> view(const Matrix& m) {
    return {m.data(), static_cast<Index>(m.rows()), static_cast<Index>(m.columns())};
}
Eigen::Map<Rows> view(Matrix& m) { return {m.data(), static_cast<Index>(m.rows()), static_cast<Index>(m.columns())}; }
Eigen::Map<const Eigen::VectorXd> view(const std::vector<double>& v) {
    return {v.data(), static_cast<Index>(v.size())};
}

template <class Expression>
Matrix made(const Expression& expression) {
    Matrix m(static_cast<std::size_t>(expression.rows()), static_cast<std::size_t>(expression.cols()));
    view(m) = expression;
    return m;
}

std::vector<double> listed(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

}  // namespace

Matrix::Matrix(std::initializer_list<std::initializer_list<double>> rows)
    : rows_(rows.size()), columns_(rows.size() == 0 ? 0 : rows.begin()->size()) {
    for (const auto& row : rows) {
        assert(row.size() == columns_);
        values_.insert(values_.end(), row);
    }
}

Matrix Matrix::identity(std::size_t size) { return diagonal(std::vector<double>(size, 1.0)); }

Matrix Matrix::column(const std::vector<double>& values) { return made(view(values)); }

Matrix Matrix::diagonal(const std::vector<double>& values) { return made(Rows(view(values).asDiagonal())); }

Matrix Matrix::transposed() const { return made(view(*this).transpose()); }

std::vector<double> Matrix::row(std::size_t i) const { return listed(view(*this).row(static_cast<Index>(i))); }

std::vector<double> Matrix::column_of(std::size_t j) const { return listed(view(*this).col(static_cast<Index>(j))); }

void Matrix::set_row(std::size_t i, const std::vector<double>& values) {
    assert(values.size() == columns_);
    view(*this).row(static_cast<Index>(i)) = view(values).transpose();
}

Matrix Matrix::block(std::size_t i, std::size_t j, std::size_t rows, std::size_t columns) const {
    return made(view(*this).block(static_cast<Index>(i), static_cast<Index>(j), static_cast<Index>(rows),
                                  static_cast<Index>(columns)));
}

void Matrix::set_block(std::size_t i, std::size_t j, const Matrix& block) {
    const auto part = view(block);
    view(*this).block(static_cast<Index>(i), static_cast<Index>(j), part.rows(), part.cols()) = part;
}

double Matrix::largest() const {
    double most = 0;
    for (const double value : values_) {
        most = std::max(most, std::abs(value));
    }
    return most;
}

bool Matrix::finite() const { return view(*this).allFinite(); }

Matrix operator+(const Matrix& a, const Matrix& b) { return made(view(a) + view(b)); }

Matrix operator-(const Matrix& a, const Matrix& b) { return made(view(a) - view(b)); }

Matrix operator*(const Matrix& a, const Matrix& b) { return made(view(a) * view(b)); }

Matrix operator*(double factor, const Matrix& a) { return made(factor * view(a)); }

std::vector<double> operator*(const Matrix& a, const std::vector<double>& x) { return listed(view(a) * view(x)); }

}  // namespace underbody::dynamics
