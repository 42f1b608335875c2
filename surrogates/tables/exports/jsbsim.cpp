// JSBSim: <function> with <table>s of the value, its slopes and its error. JSBSim interpolates linearly between the points of a table and holds
// the ends, so the grid is one that is dense enough for that, and the file says so.
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

class Writer {
public:
    explicit Writer(const ExportGrid& grid) : g_(grid), n_(grid.axes.size()) {}

    std::string text() {
        std::string out = "<?xml version=\"1.0\"?>\n<!--\n";
        for (const auto& line : g_.origin) {
            out += "  " + without_dashes(line) + "\n";
        }
        out += "  JSBSim interpolates linearly and has no cubics: the points are so dense that this differs from the table by no more than said above.\n";
        out += "  Outside the range of an axis JSBSim holds the end value; it cannot refuse, extrapolate or say that it is outside.\n";
        out += "  Inputs are properties in SI units:";
        for (const auto& axis : g_.axes) {
            out += " underbody/" + axis.name + " [" + axis.unit + "]";
        }
        out += "\n-->\n<aerodynamics>\n";
        const auto& data = g_.surface.hermite();
        out += function("", "", [&](std::size_t node) { return data[node << n_]; });
        for (std::size_t k = 0; k < n_; ++k) {
            out += function("_per_" + g_.axes[k].name, "slope along " + g_.axes[k].name + ", " + g_.unit + " per " + g_.axes[k].unit,
                            [&](std::size_t node) { return data[(node << n_) + (std::size_t{1} << k)]; });
        }
        out += function("_sigma", "one standard deviation, " + g_.unit, [&](std::size_t node) { return g_.error.empty() ? 0 : g_.error.node_sigma()[node]; });
        return out + "</aerodynamics>\n";
    }

private:
    [[nodiscard]] const std::vector<double>& x(std::size_t k) const { return g_.axes[k].points; }
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
            for (std::size_t i = 0; i < x(0).size(); ++i) {
                out += "    " + core::format_number(x(0)[i]) + " " + core::format_number(f(i)) + "\n";
            }
            out += "   </tableData>\n";
        } else if (n_ == 2) {
            out += "   <tableData>\n" + block(f, 1, 0) + "   </tableData>\n";
        } else {
            for (std::size_t i = 0; i < x(2).size(); ++i) {
                out += "   <tableData breakPoint=\"" + core::format_number(x(2)[i]) + "\">\n" + block(f, x(2).size(), i) + "   </tableData>\n";
            }
        }
        return out + "  </table>\n </function>\n";
    }

    /// Rows along axis 0, columns along axis 1, out of nodes with the last axis fastest.
    template <class F>
    std::string block(F&& f, std::size_t layers, std::size_t layer) {
        std::string out = "    ";
        for (const double y : x(1)) {
            out += " " + core::format_number(y);
        }
        out += "\n";
        for (std::size_t i = 0; i < x(0).size(); ++i) {
            out += "    " + core::format_number(x(0)[i]);
            for (std::size_t j = 0; j < x(1).size(); ++j) {
                out += " " + core::format_number(f((i * x(1).size() + j) * layers + layer));
            }
            out += "\n";
        }
        return out;
    }

    const ExportGrid& g_;
    std::size_t n_;
};

}  // namespace

void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    result.remarks.push_back({core::Problem::Severity::note, "JSBSim interpolates linearly: within " + core::format_number(grid.thinning_error, 3) + " " + grid.unit + " of the table", {}});
    for (const auto& axis : grid.axes) {
        if (axis.range != RangePolicy::clamp) {
            result.remarks.push_back({core::Problem::Severity::warning, "JSBSim holds the ends of " + axis.name + ": it cannot " + to_string(axis.range), {}});
        }
    }
    core::write_file(path, Writer(grid).text());
}

}  // namespace underbody::tables
