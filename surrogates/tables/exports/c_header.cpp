// C99 header: static arrays and static inline functions; no heap, no library, bounded steps.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

/// Index of uniform buckets for one axis, short enough for a small controller.
struct Index {
    std::vector<std::size_t> first;
    double per_unit = 0;
};

Index index_of(const std::vector<double>& x) {
    const std::size_t cells = x.size() - 1;
    const double span = x.back() - x.front();
    double shortest = span;
    for (std::size_t i = 0; i < cells; ++i) {
        shortest = std::min(shortest, x[i + 1] - x[i]);
    }
    const double wanted = std::ceil(span / shortest) + 1;
    const auto buckets =
        static_cast<std::size_t>(std::clamp(wanted, static_cast<double>(cells), static_cast<double>(8 * cells)));
    Index index;
    index.per_unit = static_cast<double>(buckets) / span;
    std::size_t i = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        // A little early, so that rounding in the controller's own arithmetic cannot start behind the cell.
        const double begin = x.front() + (static_cast<double>(b) - 1e-3) / index.per_unit;
        while (i + 1 < cells && begin >= x[i + 1]) {
            ++i;
        }
        index.first.push_back(i);
    }
    return index;
}

class Writer {
public:
    explicit Writer(const ExportGrid& grid)
        : g_(grid),
          n_(grid.axes.size()),
          many_(grid.quantities.size() > 1),
          name_(grid.name),
          real_(grid.single_precision ? "float" : "double") {}

    std::string text() {
        data();
        helpers();
        evaluation();
        shorthands();
        // Another table has another guard, also under the same name: then a compiler says what is defined twice, and
        // nothing is left out in silence.
        std::string content;
        std::swap(content, out_);
        head("UNDERBODY_" + upper_name() + "_" + core::content_hash(content).substr(0, 12) + "_H");
        return out_ + content + "\n#endif\n";
    }

private:
    std::string number(double v) const {
        if (!g_.single_precision) {
            std::string text = core::format_number(v);
            return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
        }
        std::string text = core::format_number(static_cast<double>(static_cast<float>(v)), 9);
        return (text.find_first_of(".en") == std::string::npos ? text + ".0" : text) + "f";
    }
    [[nodiscard]] std::string upper_name() const {
        std::string text = name_;
        std::transform(text.begin(), text.end(), text.begin(),
                       [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
        return text;
    }
    [[nodiscard]] std::string index_type() const {
        const bool small =
            std::all_of(g_.axes.begin(), g_.axes.end(), [](const ExportAxis& a) { return a.points.size() <= 65535; });
        return small ? "unsigned short" : "unsigned";
    }
    /// Of an array of one quantity.
    [[nodiscard]] std::string own(const ExportQuantity& q, const std::string& what) const {
        return many_ ? identifier(q.name) + "_" + what : what;
    }
    /// A member of the result for one quantity.
    [[nodiscard]] std::string member(const ExportQuantity& q, const std::string& what) const {
        return "result->" + (many_ ? identifier(q.name) + "." : std::string()) + what;
    }

    template <class Values, class Format>
    void array(const std::string& type, const std::string& name, const Values& values, Format&& format) {
        out_ += "static const " + type + " " + name_ + "_" + name + "[" + std::to_string(values.size()) + "] = {";
        std::size_t column = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::string item = format(values[i]) + (i + 1 < values.size() ? "," : "");
            if (column == 0 || column + item.size() > 118) {
                out_ += "\n    ";
                column = 4;
            }
            out_ += item + " ";
            column += item.size() + 1;
        }
        out_ += "\n};\n";
    }
    void reals(const std::string& name, const std::vector<double>& values) {
        array(real_, name, values, [this](double v) { return number(v); });
    }

    /// Coordinates as the controller has them: in single precision neighbours may not become one.
    [[nodiscard]] std::vector<double> coordinates(std::vector<double> x) const {
        for (std::size_t i = 0; g_.single_precision && i < x.size(); ++i) {
            float v = static_cast<float>(x[i]);
            if (i > 0 && v <= static_cast<float>(x[i - 1])) {
                v = std::nextafter(static_cast<float>(x[i - 1]), INFINITY);
            }
            x[i] = static_cast<double>(v);
        }
        return x;
    }

    /// What was written, from what, and how it is called.
    void comment() {
        out_ += "/*\n";
        for (auto line : header_lines(g_)) {
            for (std::size_t at; (at = line.find("*/")) != std::string::npos;) {
                line.replace(at, 2, "* /");
            }
            for (std::size_t at; (at = line.find("/*")) != std::string::npos;) {
                line.replace(at, 2, "/ *");
            }
            out_ += " * " + line + "\n";
        }
        out_ += " *\n * Use: " + name_ + "_result r; " + name_ + "_at(point, &r);  with point[] = {";
        for (std::size_t k = 0; k < n_; ++k) {
            out_ += (k == 0 ? "" : ", ") + g_.axes[k].name + " [" + g_.axes[k].unit + "]";
        }
        out_ += "}\n";
        const std::string of = many_ ? "_" + identifier(g_.first().name) : "";
        out_ += " *      or " + name_ + of + "_value(";
        for (std::size_t k = 0; k < n_; ++k) {
            out_ += (k == 0 ? "" : ", ") + identifier(g_.axes[k].name);
        }
        out_ += ") for the value alone.\n * A point that is not a number gives a value that is not a number.\n */\n";
    }

    void result_types() {
        const auto members = [&](const std::string& unit) {
            out_ += "    " + name_ + "_real value;                /* " + unit + " */\n";
            out_ += "    " + name_ + "_real slope[" + std::to_string(n_) + "];             /* " + unit +
                    " per unit of each axis */\n";
            out_ += "    " + name_ + "_real sigma;                /* " + unit + ", one standard deviation */\n";
        };
        if (many_) {
            out_ += "typedef struct {\n";
            members("N or N m");
            out_ += "} " + name_ + "_quantity;\n\n";
        }
        out_ += "typedef struct {\n";
        for (const auto& q : g_.quantities) {
            if (many_) {
                out_ += "    " + name_ + "_quantity " + identifier(q.name) + ";   /* " + q.unit + " */\n";
            } else {
                members(q.unit);
            }
        }
        out_ += "    " + name_ + "_real beyond[" + std::to_string(n_) +
                "];            /* how far outside each axis, signed; 0 inside */\n";
        out_ += "    int outside;                   /* 1 when the point lies outside the table */\n";
        out_ +=
            "    int refused;                   /* 1 when it lies outside an axis that refuses this: value and slopes "
            "are not numbers then */\n";
        out_ +=
            "    int no_data;                   /* 1 where no points of the table lie around: outside, or in an empty "
            "corner of its box */\n} " +
            name_ + "_result;\n\n";
    }

    void head(const std::string& guard) {
        comment();
        out_ += "#ifndef " + guard + "\n#define " + guard + "\n\n";
        out_ += "#define " + upper_name() + "_AXES " + std::to_string(n_) + "\n\n";
        out_ += "typedef " + real_ + " " + name_ + "_real;\n\n";
        result_types();
    }

    void data() {
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = std::to_string(k);
            const auto x = coordinates(g_.axes[k].points);
            out_ += "/* " + g_.axes[k].name + " [" + g_.axes[k].unit + "] */\n";
            reals("x" + id, x);
            const Index index = index_of(x);
            per_unit_.push_back(index.per_unit);
            buckets_.push_back(index.first.size());
            array(index_type(), "first" + id, index.first, [](std::size_t v) { return std::to_string(v); });
            for (const auto& q : g_.quantities) {
                if (has_cells(q, k)) {
                    reals(own(q, "cell" + id), q.error.cell_error(k));
                }
            }
        }
        for (const auto& q : g_.quantities) {
            out_ += "/* " + (many_ ? q.name + ": " : std::string()) + "value, slope along axis 0";
            out_ += n_ > 1 ? ", slope along axis 1, both, ..." : "";
            out_ += " at every grid point, last axis fastest */\n";
            reals(own(q, "data"), q.surface.hermite());
            if (has_sigma(q)) {
                out_ += "/* one standard deviation at every grid point */\n";
                reals(own(q, "sigma_data"), q.error.node_sigma());
            }
        }
        support_data();
        out_ += "\n";
    }

    /// A bit a cell, the first in the lowest bit.
    void support_data() {
        if (g_.support.empty()) {
            return;
        }
        out_ +=
            "/* where there are points: lines along each axis, and a bit for every cell between them, last axis "
            "fastest */\n";
        for (std::size_t k = 0; k < n_; ++k) {
            reals("known" + std::to_string(k), coordinates(g_.support.lines()[k]));
        }
        std::vector<unsigned> bytes((g_.support.has_data().size() + 7) / 8, 0);
        for (std::size_t i = 0; i < g_.support.has_data().size(); ++i) {
            bytes[i / 8] |= g_.support.has_data()[i] != 0 ? 1U << i % 8 : 0;
        }
        array("unsigned char", "known", bytes, [](unsigned v) { return std::to_string(v); });
    }

    [[nodiscard]] static bool has_sigma(const ExportQuantity& q) {
        const auto& sigma = q.error.node_sigma();
        return std::any_of(sigma.begin(), sigma.end(), [](double s) { return s != 0; });
    }
    [[nodiscard]] static bool has_cells(const ExportQuantity& q, std::size_t k) {
        const auto& cells = q.error.cell_error(k);
        return std::any_of(cells.begin(), cells.end(), [](double s) { return s != 0; });
    }

    void helpers() {
        out_ += "static inline unsigned " + name_ + "_cell(const " + name_ + "_real* x, const " + index_type() +
                "* first, unsigned cells, unsigned buckets, " + name_ + "_real per_unit, " + name_ + "_real v) {\n";
        out_ +=
            "    unsigned b = (unsigned)((v - x[0]) * per_unit);\n    unsigned i = first[b < buckets ? b : buckets - "
            "1u];\n";
        out_ += "    while (i + 1u < cells && v >= x[i + 1u]) {\n        ++i;\n    }\n    return i;\n}\n\n";
        // w: values and slopes of the four cubic Hermite functions.
        out_ += "static inline void " + name_ + "_weights(" + name_ + "_real h, " + name_ + "_real t, " + name_ +
                "_real* w, " + name_ + "_real* d) {\n";
        const std::string one = number(1), two = number(2), three = number(3), six = number(6);
        out_ += "    const " + name_ + "_real r = " + one + " - t;\n";
        out_ += "    w[0] = r * r * (" + one + " + " + two + " * t);\n    w[1] = h * t * r * r;\n";
        out_ += "    w[2] = t * t * (" + three + " - " + two + " * t);\n    w[3] = -h * t * t * r;\n";
        out_ += "    d[2] = " + six + " * t * r / h;\n    d[0] = -d[2];\n    d[1] = r * (" + one + " - " + three +
                " * t);\n    d[3] = t * (" + three + " * t - " + two + ");\n}\n\n";
        if (!g_.support.empty()) {
            out_ += "/* cell between ascending lines; beyond them the nearest */\nstatic inline unsigned " + name_ +
                    "_between(const " + name_ + "_real* x, unsigned cells, " + name_ +
                    "_real v) {\n    unsigned low = 0, high = cells;\n    while (high - low > 1u) {\n"
                    "        const unsigned middle = (low + high) / 2u;\n        if (v >= x[middle]) {\n            "
                    "low = middle;\n        } else {\n"
                    "            high = middle;\n        }\n    }\n    return low;\n}\n\n";
        }
        if (many_) {
            sum_function();
        }
    }

    void evaluation() {
        const std::string real = name_ + "_real";
        const std::string n = std::to_string(n_);
        out_ += "/* Everything at a point. */\nstatic inline void " + name_ + "_at(const " + real + "* point, " +
                name_ + "_result* result) {\n";
        out_ += "    " + real + " w[" + n + "][4], d[" + n + "][4], t[" + n + "], over[" + n + "];\n";
        out_ += "    unsigned cell[" + n + "];\n    int held[" + n + "];\n";
        out_ += "    result->outside = 0;\n";
        for (std::size_t k = 0; k < n_; ++k) {
            axis_part(k);
        }
        for (const auto& q : g_.quantities) {
            if (many_) {
                out_ += "    " + name_ + "_sum(" + name_ + "_" + own(q, "data") + ", cell, w, d, &" +
                        member(q, "value") + ", " + member(q, "slope") + ");\n";
            } else {
                sum_part(name_ + "_data", "result->value", "result->slope");
            }
            sigma_part(q);
        }
        outside_part();
        no_data_part();
        out_ += "}\n\n";
    }

    void axis_part(std::size_t k) {
        const std::string real = name_ + "_real";
        const std::string id = std::to_string(k);
        const std::string x = name_ + "_x" + id;
        const ExportAxis& axis = g_.axes[k];
        const std::size_t cells = axis.points.size() - 1;
        const std::string inside = "        } else {\n            /* inside */\n        }\n";
        const std::string last = x + "[" + std::to_string(cells) + "]";
        out_ += "    {\n        const " + real + " v = point[" + id + "];\n        " + real + " p = v;\n";
        out_ += "        result->beyond[" + id + "] = " + number(0) + ";\n        over[" + id + "] = " + number(0) +
                ";\n        held[" + id + "] = 0;\n";
        out_ +=
            "        if (!(v >= " + x + "[0])) {\n            p = " + x + "[0];\n            held[" + id + "] = 1;\n";
        out_ += "            over[" + id + "] = v - p;\n";
        out_ += "        } else if (v > " + last + ") {\n            p = " + last + ";\n            held[" + id +
                "] = 1;\n";
        out_ += "            over[" + id + "] = v - p;\n" + inside;
        const std::string lower = axis.ends_with_range() ? x + "[0]" : number(axis.lower),
                          upper = axis.ends_with_range() ? last : number(axis.upper);
        out_ += "        if (!(v >= " + lower + ")) {\n            result->beyond[" + id + "] = v - " + lower +
                ";\n            result->outside = 1;\n";
        out_ += "        } else if (v > " + upper + ") {\n            result->beyond[" + id + "] = v - " + upper +
                ";\n            result->outside = 1;\n" + inside;
        out_ += "        cell[" + id + "] = " + name_ + "_cell(" + x + ", " + name_ + "_first" + id + ", " +
                std::to_string(cells) + "u, " + std::to_string(buckets_[k]) + "u, " + number(per_unit_[k]) + ", p);\n";
        out_ += "        {\n            const " + real + " h = " + x + "[cell[" + id + "] + 1u] - " + x + "[cell[" +
                id + "]];\n";
        // Not a number: v < x[0] is false, v - v carries it on.
        out_ += "            t[" + id + "] = (p - " + x + "[cell[" + id + "]]) / h;\n            if (!(v >= " + x +
                "[0]) && !(v < " + x + "[0])) {\n                t[" + id + "] = v - v;\n            }\n";
        out_ += "            " + name_ + "_weights(h, t[" + id + "], w[" + id + "], d[" + id + "]);\n";
        if (axis.range == RangePolicy::extrapolate) {
            // The functions of the end cell go on along their tangents.
            out_ += "            if (held[" + id +
                    "] != 0) {\n                unsigned m;\n                for (m = 0; m < 4u; ++m) {\n              "
                    "     "
                    " w[" +
                    id + "][m] += over[" + id + "] * d[" + id + "][m];\n                }\n            }\n";
        }
        out_ += "        }\n    }\n";
    }

    /// The sum of one quantity, for all of them.
    void sum_function() {
        const std::string real = name_ + "_real";
        out_ += "static inline void " + name_ + "_sum(const " + real + "* data, const unsigned* cell, " + real +
                " (*w)[4], " + real + " (*d)[4], " + real + "* value, " + real + "* slope) {\n";
        sum_part("data", "*value", "slope");
        out_ += "}\n\n";
    }

    void sum_part(const std::string& data, const std::string& value, const std::string& slope) {
        const std::string real = name_ + "_real";
        if (n_ == 1) {
            out_ += "    {\n        const " + real + "* a = " + data + " + 2u * cell[0];\n";
            out_ += "        " + value + " = w[0][0] * a[0] + w[0][1] * a[1] + w[0][2] * a[2] + w[0][3] * a[3];\n";
            out_ += "        " + slope +
                    "[0] = d[0][0] * a[0] + d[0][1] * a[1] + d[0][2] * a[2] + d[0][3] * a[3];\n    }\n";
            return;
        }
        if (n_ == 2) {
            const std::string columns = std::to_string(g_.axes[1].points.size()) + "u";
            out_ +=
                "    {\n        const " + real + "* a = " + data + " + 4u * (cell[0] * " + columns + " + cell[1]);\n";
            out_ += "        const " + real + "* b = a + 4u * " + columns + ";\n        " + real +
                    " g[4], s[4];\n        unsigned i;\n";
            out_ += "        /* along axis 0, for value and axis-1 slope at both ends of axis 1 */\n";
            out_ += "        for (i = 0; i < 4u; ++i) {\n            const unsigned j = 2u * i;\n";
            out_ += "            g[i] = w[0][0] * a[j] + w[0][1] * a[j + 1u] + w[0][2] * b[j] + w[0][3] * b[j + 1u];\n";
            out_ +=
                "            s[i] = d[0][0] * a[j] + d[0][1] * a[j + 1u] + d[0][2] * b[j] + d[0][3] * b[j + 1u];\n     "
                "   }\n";
            out_ += "        " + value + " = w[1][0] * g[0] + w[1][1] * g[1] + w[1][2] * g[2] + w[1][3] * g[3];\n";
            out_ += "        " + slope + "[0] = w[1][0] * s[0] + w[1][1] * s[1] + w[1][2] * s[2] + w[1][3] * s[3];\n";
            out_ += "        " + slope +
                    "[1] = d[1][0] * g[0] + d[1][1] * g[1] + d[1][2] * g[2] + d[1][3] * g[3];\n    }\n";
            return;
        }
        const std::string n = std::to_string(n_) + "u";
        const std::string width = std::to_string(std::size_t{1} << n_) + "u";
        out_ += "    {\n        unsigned corner, mask, k, j;\n        " + value + " = " + number(0) + ";\n";
        out_ +=
            "        for (j = 0; j < " + n + "; ++j) {\n            " + slope + "[j] = " + number(0) + ";\n        }\n";
        out_ += "        for (corner = 0; corner < " + width +
                "; ++corner) {\n            unsigned node = 0;\n            const " + real + "* a;\n";
        for (std::size_t k = 0; k < n_; ++k) {
            out_ += "            node = node * " + std::to_string(g_.axes[k].points.size()) + "u + cell[" +
                    std::to_string(k) + "] + (corner >> " + std::to_string(k) + " & 1u);\n";
        }
        out_ += "            a = " + data + " + " + width + " * node;\n";
        out_ += "            for (mask = 0; mask < " + width + "; ++mask) {\n";
        out_ += "                " + real + " product = a[mask];\n";
        out_ += "                for (k = 0; k < " + n +
                "; ++k) {\n                    product *= w[k][2u * (corner >> k & 1u) + (mask >> k & 1u)];\n          "
                "      }\n";
        out_ += "                " + value + " += product;\n                for (j = 0; j < " + n +
                "; ++j) {\n                    " + real + " part = a[mask];\n";
        out_ += "                    for (k = 0; k < " + n +
                "; ++k) {\n                        part *= (k == j ? d : w)[k][2u * (corner >> k & 1u) + (mask >> k & "
                "1u)];\n";
        out_ += "                    }\n                    " + slope +
                "[j] += part;\n                }\n            }\n        }\n    }\n";
    }

    void sigma_part(const ExportQuantity& q) {
        const std::string real = name_ + "_real";
        const std::string one = number(1);
        out_ += "    {\n        " + real + " sigma = " + number(0) + ";\n";
        if (has_sigma(q)) {
            out_ += "        unsigned corner;\n        for (corner = 0; corner < " +
                    std::to_string(std::size_t{1} << n_) + "u; ++corner) {\n";
            out_ += "            unsigned node = 0;\n            " + real + " weight = " + one + ";\n";
            for (std::size_t k = 0; k < n_; ++k) {
                const std::string id = std::to_string(k);
                out_ += "            node = node * " + std::to_string(g_.axes[k].points.size()) + "u + cell[" + id +
                        "] + (corner >> " + id + " & 1u);\n";
                out_ += "            weight *= (corner >> " + id + " & 1u) ? t[" + id + "] : " + one + " - t[" + id +
                        "];\n";
            }
            out_ += "            sigma += weight * " + name_ + "_" + own(q, "sigma_data") + "[node];\n        }\n";
        }
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = std::to_string(k);
            if (has_cells(q, k)) {
                out_ += "        sigma += " + name_ + "_" + own(q, "cell" + id) + "[cell[" + id + "]] * " + number(4) +
                        " * t[" + id + "] * (" + one + " - t[" + id + "]);\n";
            }
            const auto& growth = q.error.growth(k);
            if (growth[0] != 0 || growth[1] != 0) {
                out_ += "        sigma += over[" + id + "] * (over[" + id + "] < " + number(0) + " ? " +
                        number(-growth[0]) + " : " + number(growth[1]) + ");\n";
            }
        }
        out_ += "        " + member(q, "sigma") + " = sigma;\n    }\n";
    }

    void outside_part() {
        std::string refused;
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = std::to_string(k);
            const RangePolicy range = g_.axes[k].range;
            if (range == RangePolicy::clamp) {
                out_ += "    if (held[" + id + "] != 0) {\n";
                for (const auto& q : g_.quantities) {
                    out_ += "        " + member(q, "slope") + "[" + id + "] = " + number(0) + ";\n";
                }
                out_ += "    }\n";
            } else if (range == RangePolicy::refuse) {
                const std::string beyond = "result->beyond[" + id + "]";
                refused += (refused.empty() ? "!(" : " || !(") + beyond + " >= " + number(0) + " && " + beyond +
                           " <= " + number(0) + ")";
            }
        }
        out_ += "    result->refused = 0;\n";
        if (!refused.empty()) {
            out_ += "    if (" + refused + ") {\n        const " + name_ + "_real zero = " + number(0) +
                    ";\n        result->refused = 1;\n";
            for (const auto& q : g_.quantities) {
                out_ += "        " + member(q, "value") + " = zero / zero;\n";
                for (std::size_t k = 0; k < n_; ++k) {
                    out_ +=
                        "        " + member(q, "slope") + "[" + std::to_string(k) + "] = " + member(q, "value") + ";\n";
                }
            }
            out_ += "    }\n";
        }
        out_ += "    (void)held;\n    (void)over;\n";
    }

    void no_data_part() {
        out_ += "    result->no_data = result->outside;\n";
        if (g_.support.empty()) {
            return;
        }
        out_ += "    {\n        unsigned bit = 0;\n";
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = std::to_string(k), cells = std::to_string(g_.support.lines()[k].size() - 1) + "u";
            out_ += "        bit = bit * " + cells + " + " + name_ + "_between(" + name_ + "_known" + id + ", " +
                    cells + ", point[" + id + "]);\n";
        }
        out_ += "        if (((unsigned)" + name_ +
                "_known[bit >> 3] >> (bit & 7u) & 1u) == 0u) {\n            result->no_data = 1;\n        }\n    }\n";
    }

    void shorthands() {
        std::string parameters;
        std::string fill;
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = identifier(g_.axes[k].name);
            parameters += (k == 0 ? "" : ", ") + name_ + "_real " + id;
            fill += "    point[" + std::to_string(k) + "] = " + id + ";\n";
        }
        const std::string begin = "    " + name_ + "_real point[" + std::to_string(n_) + "];\n    " + name_ +
                                  "_result result;\n" + fill + "    " + name_ + "_at(point, &result);\n";
        for (const auto& q : g_.quantities) {
            const std::string of = many_ ? "_" + identifier(q.name) : "", inner = many_ ? identifier(q.name) + "." : "";
            out_ += "static inline " + name_ + "_real " + name_ + of + "_value(" + parameters + ") {\n" + begin +
                    "    return result." + inner + "value;\n}\n\n";
            out_ += "static inline " + name_ + "_real " + name_ + of + "_sigma(" + parameters + ") {\n" + begin +
                    "    return result." + inner + "sigma;\n}\n\n";
        }
        out_ += "static inline int " + name_ + "_outside(" + parameters + ") {\n" + begin +
                "    return result.outside;\n}\n\n";
        out_ += "static inline int " + name_ + "_no_data(" + parameters + ") {\n" + begin +
                "    return result.no_data;\n}\n";
    }

    const ExportGrid& g_;
    std::size_t n_;
    bool many_;
    std::string name_;
    std::string real_;
    std::string out_;
    std::vector<double> per_unit_;
    std::vector<std::size_t> buckets_;
};

}  // namespace

void export_c(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    FixedBits bits;
    if (grid.fixed_point) {
        ExportGrid rounded = grid;
        core::write_file(path, c_fixed_point(rounded, bits));
        for (std::size_t q = 0; q < rounded.quantities.size(); ++q) {
            result.errors[q].second = rounded.quantities[q].difference;
        }
        result.error = rounded.first().difference;
    } else {
        core::write_file(path, Writer(grid).text());
    }
    if (grid.self_test_points > 0) {
        write_c_self_test(grid, path, grid.fixed_point ? &bits : nullptr);
        result.files.push_back(c_self_test(path));
    }
}

}  // namespace underbody::tables
