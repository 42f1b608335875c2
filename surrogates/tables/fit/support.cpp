#include "surrogates/tables/fit/support.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include "surrogates/tables/points/table_axis.h"

namespace underbody::tables {

namespace {

std::size_t cells_of(const std::vector<std::vector<double>>& lines) {
    std::size_t count = lines.empty() ? 0 : 1;
    for (const auto& x : lines) {
        count *= x.size() - 1;
    }
    return count;
}

/// Index of a cell along every axis.
std::array<std::size_t, max_axes> index_of(const std::vector<std::vector<double>>& lines, std::size_t cell) {
    std::array<std::size_t, max_axes> index{};
    for (std::size_t k = lines.size(); k-- > 0;) {
        index[k] = cell % (lines[k].size() - 1);
        cell /= lines[k].size() - 1;
    }
    return index;
}

}  // namespace

Support::Support(std::vector<std::vector<double>> lines, std::vector<std::uint8_t> has_data)
    : lines_(std::move(lines)), has_data_(std::move(has_data)) {
    assert(cells_of(lines_) == has_data_.size());
}

Support::Support(std::vector<std::vector<double>> lines,
                 const std::function<bool(const double*, const double*)>& has_data)
    : lines_(std::move(lines)) {
    has_data_.resize(cells_of(lines_));
    for (std::size_t cell = 0; cell < has_data_.size(); ++cell) {
        const auto index = index_of(lines_, cell);
        double low[max_axes], high[max_axes];
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            low[k] = lines_[k][index[k]];
            high[k] = lines_[k][index[k] + 1];
        }
        has_data_[cell] = has_data(low, high) ? 1 : 0;
    }
}

bool Support::no_data(const double* point) const noexcept {
    if (has_data_.empty()) {
        return false;
    }
    std::size_t cell = 0;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        if (std::isnan(point[k])) {
            return true;
        }
        const auto& x = lines_[k];
        cell = cell * (x.size() - 1) +
               static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, point[k]) - x.begin()) - 1;
    }
    return has_data_[cell] == 0;
}

Support Support::mirrored(unsigned axes) const {
    Support result = *this;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        if ((axes >> k & 1) != 0) {
            std::reverse(result.lines_[k].begin(), result.lines_[k].end());
            for (double& x : result.lines_[k]) {
                x = -x;
            }
        }
    }
    for (std::size_t cell = 0; cell < has_data_.size(); ++cell) {
        const auto index = index_of(lines_, cell);
        std::size_t to = 0;
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            const std::size_t cells = lines_[k].size() - 1;
            to = to * cells + ((axes >> k & 1) != 0 ? cells - 1 - index[k] : index[k]);
        }
        result.has_data_[to] = has_data_[cell];
    }
    return result;
}

Support Support::both(const Support& other) const {
    if (empty() || other.empty()) {
        return empty() ? other : *this;
    }
    std::vector<std::vector<double>> lines(lines_.size());
    for (std::size_t k = 0; k < lines.size(); ++k) {
        std::set_union(lines_[k].begin(), lines_[k].end(), other.lines_[k].begin(), other.lines_[k].end(),
                       std::back_inserter(lines[k]));
    }
    return {std::move(lines), [&](const double* low, const double* high) {
                double middle[max_axes];
                for (std::size_t k = 0; k < lines_.size(); ++k) {
                    middle[k] = 0.5 * (low[k] + high[k]);
                }
                return !no_data(middle) && !other.no_data(middle);
            }};
}

}  // namespace underbody::tables
