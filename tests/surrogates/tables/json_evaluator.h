// Evaluates an exported table by what its JSON says about it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::test {

/// What the JSON itself says about evaluating it, done by its words.
struct JsonTable {
    nlohmann::json j;

    struct Value {
        double value = 0;
        double slope[tables::max_axes] = {};
        double sigma = 0;
        bool outside = false;
        bool no_data = false;
    };

    /// Is the cell between its lines where the point lies without data?
    [[nodiscard]] bool empty_cell(const double* p) const {
        if (!j.contains("support")) {
            return false;
        }
        std::size_t cell = 0;
        for (std::size_t k = 0; k < j["axes"].size(); ++k) {
            const auto lines = j["support"]["lines"][k].get<std::vector<double>>();
            std::size_t i = 0;
            while (i + 2 < lines.size() && p[k] >= lines[i + 1]) {
                ++i;
            }
            cell = cell * (lines.size() - 1) + i;
        }
        return j["support"]["has_data"][cell] == 0;
    }

    [[nodiscard]] Value at(const double* p) const {
        const std::size_t n = j["axes"].size();
        Value result;
        std::vector<std::size_t> cell(n), size(n);
        std::vector<double> t(n);
        std::vector<std::array<double, 4>> f(n),
            d(n);  // the four functions of each axis and their derivatives: value, slope below; value, slope above
        std::vector<bool> zero(n, false);
        bool refused = false;
        for (std::size_t k = 0; k < n; ++k) {
            const auto points = j["axes"][k]["points"].get<std::vector<double>>();
            size[k] = points.size();
            const double x = std::clamp(p[k], points.front(), points.back());
            while (cell[k] + 2 < points.size() && x >= points[cell[k] + 1]) {
                ++cell[k];
            }
            const double h = points[cell[k] + 1] - points[cell[k]];
            const double s = t[k] = (x - points[cell[k]]) / h;
            const double r = 1 - s;
            f[k] = {r * r * (1 + 2 * s), h * s * r * r, s * s * (3 - 2 * s), -h * s * s * r};
            d[k] = {-6 * s * r / h, r * r - 2 * s * r, 6 * s * r / h, s * s - 2 * s * r};
            const std::string word = j["axes"][k]["outside"];
            if (p[k] < j["axes"][k]["lower"].get<double>() || p[k] > j["axes"][k]["upper"].get<double>()) {
                result.outside = true;
                refused = refused || word == "refuse";
            }
            if (x != p[k]) {
                zero[k] = word == "clamp";
                for (std::size_t i = 0; i < 4 && word == "extrapolate"; ++i) {
                    f[k][i] += (p[k] - x) * d[k][i];
                }
            }
            if (!j["cell_error"][k].empty()) {
                result.sigma += j["cell_error"][k][cell[k]].get<double>() * 4 * s * r;
            }
            result.sigma += j["growth"][k][p[k] < x ? 0 : 1].get<double>() * std::abs(p[k] - x);
        }
        for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
            std::size_t node = 0;
            double weight = 1;
            for (std::size_t k = 0; k < n; ++k) {
                const bool up = (corner >> k & 1) != 0;
                node = node * size[k] + cell[k] + (up ? 1 : 0);
                weight *= up ? t[k] : 1 - t[k];
            }
            result.sigma += weight * j["sigma"][node].get<double>();
            for (std::size_t m = 0; m < std::size_t{1} << n; ++m) {
                const auto product = [&](std::size_t differentiated) {
                    double value = j["hermite"][node][m].get<double>();
                    for (std::size_t k = 0; k < n; ++k) {
                        value *= (k == differentiated ? d : f)[k][2 * (corner >> k & 1) + (m >> k & 1)];
                    }
                    return value;
                };
                result.value += product(n);
                for (std::size_t k = 0; k < n; ++k) {
                    result.slope[k] += zero[k] ? 0 : product(k);
                }
            }
        }
        result.no_data = result.outside || empty_cell(p);
        if (refused) {
            result.value = std::nan("");
            std::fill_n(result.slope, n, std::nan(""));
        }
        return result;
    }
};

}  // namespace underbody::test
