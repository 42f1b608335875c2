// JSBSim: <function> with <table>s of the value, its slopes and its error. JSBSim interpolates linearly between the points of a table and holds
// the ends, so the grid is refined until linear interpolation stays within a small share of the force's range, and the file says so.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

/// Points such that linear interpolation along each axis errs by less than `share` of the range: halving of cells.
std::vector<std::vector<double>> linear_points(const ExportGrid& grid, double share, double& range) {
    const std::size_t n = grid.axes.size();
    auto points = grid.surface.points();
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i < grid.surface.nodes(); ++i) {
        low = std::min(low, grid.surface.hermite()[i << n]);
        high = std::max(high, grid.surface.hermite()[i << n]);
    }
    range = high - low;
    const double allowed = share * range / static_cast<double>(n);
    const std::size_t most = n == 1 ? 400 : n == 2 ? 60 : 20;
    for (std::size_t k = 0; k < n; ++k) {
        for (int round = 0; round < 8; ++round) {
            std::vector<double> refined;
            const auto& x = points[k];
            for (std::size_t i = 0; i + 1 < x.size(); ++i) {
                refined.push_back(x[i]);
                bool bent = false;
                const std::size_t lines = grid.surface.nodes() / grid.axes[k].points.size();
                for (std::size_t line = 0; line < lines && !bent; ++line) {
                    double at[CubicGrid::max_axes];
                    std::size_t rest = line;
                    for (std::size_t j = n; j-- > 0;) {
                        if (j != k) {
                            at[j] = grid.axes[j].points[rest % grid.axes[j].points.size()];
                            rest /= grid.axes[j].points.size();
                        }
                    }
                    const auto value = [&](double v) {
                        at[k] = v;
                        return grid.surface.value(at, nullptr);
                    };
                    bent = std::abs(value(0.5 * (x[i] + x[i + 1])) - 0.5 * (value(x[i]) + value(x[i + 1]))) > allowed;
                }
                if (bent) {
                    refined.push_back(0.5 * (x[i] + x[i + 1]));
                }
            }
            refined.push_back(x.back());
            if (refined.size() == x.size() || refined.size() > most) {
                break;
            }
            points[k] = std::move(refined);
        }
    }
    return points;
}

class Writer {
public:
    Writer(const ExportGrid& grid, std::vector<std::vector<double>> points) : g_(grid), x_(std::move(points)), n_(grid.axes.size()) {}

    std::string text(double error) {
        std::string out = "<?xml version=\"1.0\"?>\n<!--\n";
        for (const auto& line : g_.origin) {
            out += "  " + without_dashes(line) + "\n";
        }
        out += "  JSBSim interpolates linearly: on these points that differs from the table by at most " + core::format_number(error, 3) + " " + g_.unit + ".\n";
        out += "  Inputs are properties in SI units:";
        for (const auto& axis : g_.axes) {
            out += " underbody/" + axis.name + " [" + axis.unit + "]";
        }
        out += "\n-->\n<aerodynamics>\n";
        out += function("", "", [this](const double* p) { return g_.surface.value(p, nullptr); });
        for (std::size_t k = 0; k < n_; ++k) {
            out += function("_per_" + g_.axes[k].name, "slope along " + g_.axes[k].name, [this, k](const double* p) {
                double slope[CubicGrid::max_axes];
                g_.surface.value(p, slope);
                return slope[k];
            });
        }
        out += function("_sigma", "one standard deviation", [this](const double* p) { return g_.error.sigma(p, nullptr); });
        return out + "</aerodynamics>\n";
    }

private:
    static std::string without_dashes(std::string text) {
        for (std::size_t at; (at = text.find("--")) != std::string::npos;) {
            text.replace(at, 2, "- ");
        }
        return text;
    }

    template <class F>
    std::string function(const std::string& ending, const std::string& what, F&& f) {
        std::string out = " <function name=\"underbody/" + g_.quantity + ending + "\">\n  <description>" +
                          core::escape_html(what.empty() ? g_.quantity + " [" + g_.unit + "]" : what) + "</description>\n  <table>\n";
        static const char* lookups[] = {"row", "column", "table"};
        for (std::size_t k = 0; k < n_; ++k) {
            out += std::string("   <independentVar lookup=\"") + lookups[k] + "\">underbody/" + g_.axes[k].name + "</independentVar>\n";
        }
        if (n_ == 1) {
            out += "   <tableData>\n";
            for (const double x : x_[0]) {
                out += "    " + core::format_number(x) + " " + core::format_number(f(&x)) + "\n";
            }
            out += "   </tableData>\n";
        } else if (n_ == 2) {
            out += "   <tableData>\n" + block(f, 0) + "   </tableData>\n";
        } else {
            for (const double z : x_[2]) {
                out += "   <tableData breakPoint=\"" + core::format_number(z) + "\">\n" + block(f, z) + "   </tableData>\n";
            }
        }
        return out + "  </table>\n </function>\n";
    }

    template <class F>
    std::string block(F&& f, double z) {
        std::string out = "    ";
        for (const double y : x_[1]) {
            out += " " + core::format_number(y);
        }
        out += "\n";
        for (const double x : x_[0]) {
            out += "    " + core::format_number(x);
            for (const double y : x_[1]) {
                const double p[3] = {x, y, z};
                out += " " + core::format_number(f(p));
            }
            out += "\n";
        }
        return out;
    }

    const ExportGrid& g_;
    std::vector<std::vector<double>> x_;
    std::size_t n_;
};

}  // namespace

void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    if (grid.axes.size() > 3) {
        throw core::UsageError("format", "a JSBSim table has at most three axes, this one has four", {}, "hold one of them: select rows with --where");
    }
    double range = 0;
    auto points = linear_points(grid, 1e-3, range);
    // Largest difference between the cubic and the linear function, in the middle of the cells.
    double worst = 0;
    {
        const std::size_t n = grid.axes.size();
        std::vector<double> values;
        const CubicGrid sampled = grid.surface.resampled(points);
        for (std::size_t i = 0; i < sampled.nodes(); ++i) {
            values.push_back(sampled.hermite()[i << n]);
        }
        const ErrorModel straight(points, std::move(values));
        std::vector<std::size_t> cell(n, 0);
        for (bool more = true; more;) {
            double at[CubicGrid::max_axes];
            for (std::size_t k = 0; k < n; ++k) {
                at[k] = 0.5 * (points[k][cell[k]] + points[k][cell[k] + 1]);
            }
            worst = std::max(worst, std::abs(straight.sigma(at, nullptr) - grid.surface.value(at, nullptr)));
            more = false;
            for (std::size_t k = 0; k < n && !more; ++k) {
                more = ++cell[k] + 1 < points[k].size();
                cell[k] = more ? cell[k] : 0;
            }
        }
    }
    result.grid.clear();
    for (const auto& axis : points) {
        result.grid.push_back(axis.size());
    }
    result.error = std::max(result.error, worst);
    result.remarks.push_back({core::Problem::Severity::note,
                              "JSBSim interpolates linearly: within " + core::format_number(worst, 3) + " " + grid.unit + " of the table" +
                                  (grid.range == RangePolicy::extrapolate ? "; it holds the ends and does not extrapolate" : ""),
                              {}});
    core::write_file(path, Writer(grid, std::move(points)).text(worst));
}

}  // namespace underbody::tables
