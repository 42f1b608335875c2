#include "surrogates/tables/analysis/zero_lines.h"

#include <cmath>
#include <map>

namespace underbody::tables {

namespace {

double bisected(const std::function<double(double)>& f, double low, double high) {
    const bool rising = f(high) > f(low);
    for (int i = 0; i < 80 && high - low > 1e-15 * (std::abs(low) + std::abs(high)); ++i) {
        const double middle = 0.5 * (low + high);
        ((f(middle) > 0) == rising ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

class Contour {
public:
    Contour(const PlaneFunction& f, const std::vector<double>& x, const std::vector<double>& y) : f_(f), x_(x), y_(y) {}

    std::vector<ZeroLine> lines(core::Progress& progress) {
        std::vector<double> value(x_.size() * y_.size());
        for (std::size_t i = 0; i < x_.size(); ++i) {
            progress.check();
            for (std::size_t j = 0; j < y_.size(); ++j) {
                value[i * y_.size() + j] = f_(x_[i], y_[j]);
            }
        }
        const auto at = [&](std::size_t i, std::size_t j) { return value[i * y_.size() + j] >= 0; };
        for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
            for (std::size_t j = 0; j + 1 < y_.size(); ++j) {
                std::vector<std::size_t> edges;  // bottom, right, top, left of the cell: ids shared by neighbours
                if (at(i, j) != at(i + 1, j)) {
                    edges.push_back(along_x(i, j));
                }
                if (at(i + 1, j) != at(i + 1, j + 1)) {
                    edges.push_back(along_y(i + 1, j));
                }
                if (at(i, j + 1) != at(i + 1, j + 1)) {
                    edges.push_back(along_x(i, j + 1));
                }
                if (at(i, j) != at(i, j + 1)) {
                    edges.push_back(along_y(i, j));
                }
                for (std::size_t e = 0; e + 1 < edges.size(); e += 2) {
                    link_[edges[e]].push_back(edges[e + 1]);
                    link_[edges[e + 1]].push_back(edges[e]);
                }
            }
        }
        return joined();
    }

private:
    [[nodiscard]] std::size_t along_x(std::size_t i, std::size_t j) const { return 2 * (i * y_.size() + j); }
    [[nodiscard]] std::size_t along_y(std::size_t i, std::size_t j) const { return 2 * (i * y_.size() + j) + 1; }

    ZeroPoint root(std::size_t edge) {
        const std::size_t node = edge / 2;
        const std::size_t i = node / y_.size();
        const std::size_t j = node % y_.size();
        if (edge % 2 == 0) {
            return {bisected([&](double x) { return f_(x, y_[j]); }, x_[i], x_[i + 1]), y_[j]};
        }
        return {x_[i], bisected([&](double y) { return f_(x_[i], y); }, y_[j], y_[j + 1])};
    }

    std::vector<ZeroLine> joined() {
        std::map<std::size_t, bool> seen;
        std::vector<ZeroLine> lines;
        const auto follow = [&](std::size_t start) {
            ZeroLine line;
            std::size_t edge = start;
            while (true) {
                seen[edge] = true;
                line.push_back(root(edge));
                std::size_t next = edge;
                for (const std::size_t other : link_[edge]) {
                    if (!seen[other]) {
                        next = other;
                        break;
                    }
                }
                if (next == edge) {
                    break;
                }
                edge = next;
            }
            lines.push_back(std::move(line));
        };
        for (const auto& [edge, others] : link_) {
            if (others.size() == 1 && !seen[edge]) {
                follow(edge);
            }
        }
        for (const auto& [edge, others] : link_) {
            if (!seen[edge]) {
                follow(edge);
            }
        }
        return lines;
    }

    const PlaneFunction& f_;
    const std::vector<double>& x_;
    const std::vector<double>& y_;
    std::map<std::size_t, std::vector<std::size_t>> link_;
};

}  // namespace

std::vector<ZeroLine> zero_lines(const PlaneFunction& f, const std::vector<double>& x, const std::vector<double>& y,
                                 core::Progress& progress) {
    return Contour(f, x, y).lines(progress);
}

}  // namespace underbody::tables
