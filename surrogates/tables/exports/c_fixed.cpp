// C99 header in whole numbers: no floating point, no division, no heap, no library but <stdint.h>. Straight lines
// between points that are dense enough for them, every number an int32 over a power of two.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/error.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

/// Bits after the point that leave `largest` below 2^29: room for twice as much and for sums.
int bits_for(double largest) { return largest > 0 ? 29 - static_cast<int>(std::ceil(std::log2(largest))) : 0; }

std::int32_t raw(double value, int bits) {
    return static_cast<std::int32_t>(
        std::clamp(std::round(std::ldexp(value, bits)), double{INT32_MIN + 1}, double{INT32_MAX}));
}

double largest_of(const std::vector<double>& values) {
    double largest = 0;
    for (const double v : values) {
        largest = std::max(largest, std::abs(v));
    }
    return largest;
}

struct FixedAxis {
    int bits = 0;
    std::vector<std::int32_t> x;
    std::vector<std::uint32_t> rate;  ///< of a cell: 2^(30 + shift) over its width, which has `shift` bits
    std::vector<int> shift;
    std::vector<std::int32_t> known;
    std::int32_t lower = 0, upper = 0;

    FixedAxis(const ExportAxis& axis, const std::vector<double>& lines) {
        bits = bits_for(std::max(std::abs(axis.points.front()), std::abs(axis.points.back())));
        for (const double v : axis.points) {
            const std::int32_t r = raw(v, bits);
            x.push_back(x.empty() ? r : std::max(r, x.back() + 1));
        }
        if (std::int64_t{x.back()} - x.front() < 1000 * static_cast<std::int64_t>(x.size())) {
            throw core::InputError(
                "range", "the range of " + axis.name + " is too narrow beside its values for whole numbers of 32 bits");
        }
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            const auto width = static_cast<std::uint64_t>(std::int64_t{x[i + 1]} - x[i]);
            int used = 0;
            while (width >> used != 0) {
                ++used;
            }
            shift.push_back(used);
            rate.push_back(static_cast<std::uint32_t>(
                std::min<std::uint64_t>((std::uint64_t{1} << (30 + used)) / width, UINT32_MAX)));
        }
        for (const double v : lines) {
            known.push_back(raw(v, bits));
        }
        lower = raw(axis.lower, bits);
        upper = raw(axis.upper, bits);
    }
};

class Writer {
public:
    explicit Writer(ExportGrid& grid) : g_(grid), n_(grid.axes.size()), name_(grid.name) {
        for (std::size_t k = 0; k < n_; ++k) {
            axes_.emplace_back(g_.axes[k], g_.support.empty() ? std::vector<double>{} : g_.support.lines()[k]);
        }
    }

    [[nodiscard]] const FixedBits& bits() const { return bits_; }
    std::string text() {
        for (std::size_t k = 0; k < n_; ++k) {
            bits_.axis.push_back(axes_[k].bits);
            axis_data(k);
        }
        for (ExportQuantity& q : g_.quantities) {
            quantity_data(q);
        }
        support_data();
        helpers();
        evaluation();
        std::string content;
        std::swap(content, out_);
        head("UNDERBODY_" + upper(name_) + "_" + core::content_hash(content).substr(0, 12) + "_H");
        return out_ + content + "\n#endif\n";
    }

private:
    static std::string upper(std::string text) {
        std::transform(text.begin(), text.end(), text.begin(),
                       [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
        return text;
    }
    template <class Values>
    void array(const std::string& type, const std::string& name, const Values& values, const char* suffix = "") {
        out_ += "static const " + type + " " + name_ + "_" + name + "[" + std::to_string(values.size()) + "] = {";
        for (std::size_t i = 0; i < values.size(); ++i) {
            out_ += (i % 10 == 0 ? "\n    " : " ") + std::to_string(values[i]) + suffix +
                    (i + 1 < values.size() ? "," : "");
        }
        out_ += "\n};\n";
    }
    [[nodiscard]] std::string macro(const std::string& what) const { return upper(name_ + "_" + what) + "_BITS"; }
    [[nodiscard]] static std::string per(const ExportQuantity& q, const ExportAxis& axis) {
        return identifier(q.name) + "_per_" + identifier(axis.name);
    }
    void define(const std::string& what, int bits) {
        defines_ += "#define " + macro(what) + " (" + std::to_string(bits) + ")\n";
    }

    /// The largest number that a coordinate can be, and a conversion that holds what is larger there.
    void conversion(std::size_t k) {
        const std::string name = identifier(g_.axes[k].name), of = upper(name_ + "_" + name);
        const std::string most = core::format_number(std::ldexp(double{INT32_MAX}, -axes_[k].bits), 6);
        defines_ += "/* " + g_.axes[k].name + " from -" + most + " to " + most + " " + g_.axes[k].unit +
                    ": a plain conversion of more wraps around; this one holds it at the ends, and 0 for no number */\n"
                    "#define " +
                    of + "_RAW(v) (((double)(v) * " + scale(axes_[k].bits) +
                    ") >= 2147483647.0 ? INT32_MAX : ((double)(v) * " + scale(axes_[k].bits) +
                    ") <= -2147483647.0 ? -INT32_MAX : ((double)(v) == (double)(v)) ? (int32_t)((double)(v) * " +
                    scale(axes_[k].bits) + " + ((double)(v) < 0.0 ? -0.5 : 0.5)) : 0)\n";
    }
    /// 2^bits as C reads it.
    [[nodiscard]] static std::string scale(int bits) {
        const std::string text = core::format_number(std::ldexp(1.0, bits), 17);
        return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
    }

    void axis_data(std::size_t k) {
        const std::string id = std::to_string(k);
        const FixedAxis& axis = axes_[k];
        define(identifier(g_.axes[k].name), axis.bits);
        conversion(k);
        out_ += "/* " + g_.axes[k].name + " [" + g_.axes[k].unit + "] times 2^" + std::to_string(axis.bits) + " */\n";
        array("int32_t", "x" + id, axis.x);
        array("uint32_t", "rate" + id, axis.rate, "U");
        array("uint8_t", "shift" + id, axis.shift, "U");
    }

    std::vector<std::int32_t> raws(const std::vector<double>& values, int bits) {
        std::vector<std::int32_t> all;
        for (const double v : values) {
            all.push_back(raw(v, bits));
        }
        return all;
    }

    void quantity_data(ExportQuantity& q) {
        const std::string name = identifier(q.name);
        const auto& hermite = q.surface.hermite();
        const std::size_t nodes = q.surface.nodes();
        std::vector<double> value(nodes), sigma = q.error.node_sigma();
        sigma.resize(nodes, 0.0);
        for (std::size_t i = 0; i < nodes; ++i) {
            value[i] = hermite[i << n_];
        }
        double most_sigma = largest_of(sigma);  // as far outside again as the table reaches
        for (std::size_t k = 0; k < n_; ++k) {
            const auto& x = g_.axes[k].points;
            most_sigma += std::max(q.error.growth(k)[0], q.error.growth(k)[1]) * (x.back() - x.front());
        }
        const int bits = bits_for(std::max(largest_of(value), most_sigma));
        define(name, bits);
        array("int32_t", name + "_data", raws(value, bits));
        array("int32_t", name + "_sigma_data", raws(sigma, bits));
        bits_.value.push_back(bits);
        bits_.slope.emplace_back();
        bits_.growth.emplace_back();
        double rounding = std::ldexp(static_cast<double>(n_) + 2, -bits);
        for (std::size_t k = 0; k < n_; ++k) {
            std::vector<double> slope(nodes);
            for (std::size_t i = 0; i < nodes; ++i) {
                slope[i] = hermite[(i << n_) + (std::size_t{1} << k)];
            }
            const auto& growth = q.error.growth(k);
            // A slope so flat that its bits could not be moved to those of the value has fewer: what they leave out,
            // the value cannot show.
            const int room = bits - axes_[k].bits;
            const auto bits_of = [room](double most) {
                constexpr int most_moved = 62;
                return most > 0 ? std::min({bits_for(most), room + most_moved, most_moved}) : std::max(room, 0);
            };
            bits_.slope.back().push_back(bits_of(largest_of(slope)));
            bits_.growth.back().push_back(bits_of(std::max(growth[0], growth[1])));
            define(per(q, g_.axes[k]), bits_.slope.back()[k]);
            array("int32_t", per(q, g_.axes[k]) + "_data", raws(slope, bits_.slope.back()[k]));
            rounding += std::ldexp(largest_of(slope), -axes_[k].bits);
        }
        // The steepest straight line is not steeper than twice the steepest slope at its ends.
        q.difference += 2 * rounding;
    }

    void support_data() {
        if (g_.support.empty()) {
            return;
        }
        for (std::size_t k = 0; k < n_; ++k) {
            array("int32_t", "known" + std::to_string(k), axes_[k].known);
        }
        std::vector<unsigned> bytes((g_.support.has_data().size() + 7) / 8, 0);
        for (std::size_t i = 0; i < g_.support.has_data().size(); ++i) {
            bytes[i / 8] |= g_.support.has_data()[i] != 0 ? 1U << i % 8 : 0;
        }
        array("uint8_t", "known", bytes, "U");
    }

    void head(const std::string& guard) {
        out_ += "/*\n";
        for (auto line : header_lines(g_)) {
            for (const char* mark : {"*/", "/*"}) {
                for (std::size_t at; (at = line.find(mark)) != std::string::npos;) {
                    line.insert(at + 1, " ");
                }
            }
            out_ += " * " + line + "\n";
        }
        out_ +=
            " * Whole numbers: straight lines between the points; the rounding of numbers is counted among the "
            "differences. What no number of 32 bits holds (far outside) is the largest one. A refused point gives 0.\n";
        for (const auto& q : g_.quantities) {
            out_ += " * " + q.name + " is within " + core::format_number(q.difference, 3) + " " + q.unit + "\n";
        }
        out_ += " *\n * Use: " + name_ + "_result r; " + name_ + "_at(point, &r);  with point[] = {";
        for (std::size_t k = 0; k < n_; ++k) {
            out_ += (k == 0 ? "" : ", ") + g_.axes[k].name + " [" + g_.axes[k].unit + "] times 2^" +
                    macro(identifier(g_.axes[k].name));
        }
        const std::string first = identifier(g_.first().name);
        out_ += "}\n * " + first + " [" + g_.first().unit + "] is r." + first + ".value over 2^" + macro(first) +
                ", its sigma likewise, its slopes over 2^" + macro(per(g_.first(), g_.axes[0])) +
                " ...\n * point[0] = " + upper(name_ + "_" + identifier(g_.axes[0].name)) + "_RAW(v) of a v in " +
                g_.axes[0].unit +
                " holds what is too large for it; where v is a constant no floating point is left.\n */\n";
        out_ += "#ifndef " + guard + "\n#define " + guard + "\n\n#include <stdint.h>\n\n" + defines_ + "\n";
        const std::string n = std::to_string(n_);
        out_ += "typedef struct {\n    int32_t value;\n    int32_t slope[" + n + "];\n    int32_t sigma;\n} " + name_ +
                "_quantity;\n\ntypedef struct {\n";
        for (const auto& q : g_.quantities) {
            out_ += "    " + name_ + "_quantity " + identifier(q.name) + ";\n";
        }
        out_ += "    int32_t beyond[" + n +
                "]; /* how far outside each axis, signed; 0 inside */\n    int outside; /* 1 when the point lies "
                "outside the table */\n"
                "    int refused; /* 1 when it lies outside an axis that refuses this */\n"
                "    int no_data; /* 1 where no points of the table lie around */\n} " +
                name_ + "_result;\n\n";
    }

    void helpers() {
        out_ += "\nstatic inline int32_t " + name_ +
                "_held(int64_t v) {\n    int64_t w = v;\n    if (w > INT32_MAX) {\n        w = INT32_MAX;\n    } else "
                "if (w < -INT32_MAX) {\n        w = -INT32_MAX;\n    } else {\n        /* it fits */\n    }\n    "
                "return (int32_t)w;\n}\n\n";
        out_ +=
            "/* a / 2^bits, rounded */\nstatic inline int64_t " + name_ +
            "_over(int64_t a, uint32_t bits) {\n    const uint64_t half = ((uint64_t)1U << bits) >> 1U;\n    "
            "const int64_t size = (a < 0) ? -a : a;\n    const uint64_t moved = (uint64_t)size + half;\n    const "
            "uint64_t part = moved >> bits;\n    const int64_t r = (int64_t)part;\n    return (a < 0) ? -r : r;\n}\n\n";
        out_ += "/* cell between ascending lines; beyond them the nearest */\nstatic inline uint32_t " + name_ +
                "_cell(const int32_t x[], uint32_t cells, int32_t v) {\n    uint32_t low = 0U;\n    uint32_t high = "
                "cells;\n    while ((high - low) > 1U) {\n        const uint32_t middle = (low + high) / 2U;\n        "
                "if (v >= x[middle]) {\n            low = middle;\n        } else {\n            high = middle;\n"
                "        }\n    }\n    return low;\n}\n\n";
        const std::string n = std::to_string(n_), corners = std::to_string(std::size_t{1} << n_);
        out_ += "static inline int32_t " + name_ +
                "_sum(const int32_t data[], const uint32_t cell[], const int32_t "
                "t[]) {\n    int32_t c[" +
                corners + "];\n    uint32_t i;\n    uint32_t k;\n    uint32_t half = " + corners +
                "U;\n    for (i = 0U; i < " + corners + "U; ++i) {\n        uint32_t node = 0U;\n";
        for (std::size_t k = 0; k < n_; ++k) {
            out_ += "        node = (node * " + std::to_string(axes_[k].x.size()) + "U) + cell[" + std::to_string(k) +
                    "] + ((i >> " + std::to_string(k) + "U) & 1U);\n";
        }
        out_ += "        c[i] = data[node];\n    }\n    for (k = " + n +
                "U; k > 0U; --k) {\n        half /= 2U;\n        for (i = 0U; i < half; ++i) {\n            c[i] += "
                "(int32_t)" +
                name_ +
                "_over(((int64_t)c[i + half] - c[i]) * t[k - 1U], 30U);\n        }\n    }\n    "
                "return c[0];\n}\n\n";
    }

    void evaluation() {
        const std::string n = std::to_string(n_);
        out_ += "/* Everything at a point. */\nstatic inline void " + name_ + "_at(const int32_t point[], " + name_ +
                "_result *result) {\n    uint32_t cell[" + n + "];\n    int32_t t[" + n + "];\n    int32_t over[" + n +
                "];\n    result->outside = 0;\n    result->refused = 0;\n";
        for (std::size_t k = 0; k < n_; ++k) {
            axis_part(k);
        }
        for (std::size_t q = 0; q < g_.quantities.size(); ++q) {
            quantity_part(q);
        }
        out_ += "    result->no_data = result->outside;\n";
        if (!g_.support.empty()) {
            out_ += "    {\n        uint32_t bit = 0U;\n";
            for (std::size_t k = 0; k < n_; ++k) {
                const std::string id = std::to_string(k), cells = std::to_string(axes_[k].known.size() - 1) + "U";
                out_ += "        bit = (bit * " + cells + ") + " + name_ + "_cell(" + name_ + "_known" + id + ", " +
                        cells + ", point[" + id + "]);\n";
            }
            out_ += "        if ((((uint32_t)" + name_ +
                    "_known[bit >> 3U] >> (bit & 7U)) & 1U) == 0U) {\n            result->no_data = 1;\n        }\n    "
                    "}\n";
        }
        out_ += "}\n";
    }

    void axis_part(std::size_t k) {
        const std::string id = std::to_string(k), x = name_ + "_x" + id;
        const FixedAxis& axis = axes_[k];
        const std::string cells = std::to_string(axis.x.size() - 1) + "U";
        out_ += "    {\n        const int32_t v = point[" + id + "];\n        int32_t p = v;\n";
        out_ += "        if (v < " + x + "[0]) {\n            p = " + x + "[0];\n        } else if (v > " + x + "[" +
                cells + "]) {\n            p = " + x + "[" + cells +
                "];\n        } else {\n            /* inside */\n"
                "        }\n        over[" +
                id + "] = " + name_ + "_held((int64_t)v - p);\n";
        out_ += "        result->beyond[" + id + "] = 0;\n        if ((v < " + std::to_string(axis.lower) +
                ") || (v > " + std::to_string(axis.upper) + ")) {\n            result->beyond[" + id + "] = " + name_ +
                "_held((int64_t)v - ((v < " + std::to_string(axis.lower) + ") ? " + std::to_string(axis.lower) + " : " +
                std::to_string(axis.upper) + "));\n            result->outside = 1;\n" +
                (g_.axes[k].range == RangePolicy::refuse ? "            result->refused = 1;\n" : "") + "        }\n";
        out_ += "        cell[" + id + "] = " + name_ + "_cell(" + x + ", " + cells +
                ", p);\n        {\n            const int64_t past = (int64_t)p - " + x + "[cell[" + id +
                "]];\n            const uint64_t from = (uint64_t)past;\n            const uint64_t share = (from * " +
                name_ + "_rate" + id + "[cell[" + id + "]]) >> " + name_ + "_shift" + id + "[cell[" + id +
                "]];\n            t[" + id + "] = (int32_t)share;\n        }\n    }\n";
    }

    void quantity_part(std::size_t at) {
        const ExportQuantity& q = g_.quantities[at];
        const std::string name = identifier(q.name), of = "result->" + name + ".", call = name_ + "_sum(" + name_ + "_";
        out_ += "    {\n        int64_t value = " + call + name + "_data, cell, t);\n        int64_t sigma = " + call +
                name + "_sigma_data, cell, t);\n";
        for (std::size_t k = 0; k < n_; ++k) {
            const std::string id = std::to_string(k);
            out_ += "        " + of + "slope[" + id + "] = " + call + per(q, g_.axes[k]) + "_data, cell, t);\n";
            const auto& growth = q.error.growth(k);
            const int grown = bits_.growth[at][k] + axes_[k].bits - bits_.value[at];
            const int gone = bits_.slope[at][k] + axes_[k].bits - bits_.value[at];
            if (gone < 0 || grown < 0) {
                throw core::InputError("range", q.name + " is too steep along " + g_.axes[k].name +
                                                    " beside its values for whole numbers of 32 bits");
            }
            out_ += "        if (over[" + id + "] != 0) {\n            const int64_t far = (over[" + id +
                    "] < 0) ? -(int64_t)over[" + id + "] : (int64_t)over[" + id + "];\n            sigma += " + name_ +
                    "_over(far * ((over[" + id + "] < 0) ? " + std::to_string(raw(growth[0], bits_.growth[at][k])) +
                    " : " + std::to_string(raw(growth[1], bits_.growth[at][k])) + "), " + std::to_string(grown) +
                    "U);\n";
            if (g_.axes[k].range == RangePolicy::extrapolate) {
                out_ += "            value += " + name_ + "_over((int64_t)over[" + id + "] * " + of + "slope[" + id +
                        "], " + std::to_string(gone) + "U);\n";
            } else {
                out_ += "            " + of + "slope[" + id + "] = 0;\n";
            }
            out_ += "        }\n";
        }
        out_ += "        " + of + "value = " + name_ + "_held(value);\n        " + of + "sigma = " + name_ +
                "_held(sigma);\n";
        const bool refuses = std::any_of(g_.axes.begin(), g_.axes.end(),
                                         [](const ExportAxis& a) { return a.range == RangePolicy::refuse; });
        if (refuses) {
            out_ += "        if (result->refused != 0) {\n            " + of + "value = 0;\n";
            for (std::size_t k = 0; k < n_; ++k) {
                out_ += "            " + of + "slope[" + std::to_string(k) + "] = 0;\n";
            }
            out_ += "        }\n";
        }
        out_ += "    }\n";
    }

    ExportGrid& g_;
    std::size_t n_;
    std::string name_;
    std::vector<FixedAxis> axes_;
    FixedBits bits_;
    std::string defines_, out_;
};

}  // namespace

std::string c_fixed_point(ExportGrid& grid, FixedBits& bits) {
    Writer writer(grid);
    std::string text = writer.text();
    bits = writer.bits();
    return text;
}

}  // namespace underbody::tables
