#include <array>
#include <cctype>
#include <charconv>

#include "core/error.h"
#include "core/hash.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::estimator {

namespace {

// Shortest digits that read back to the same double, always a floating constant of C.
std::string number(double value) {
    std::array<char, 40> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    std::string text(buffer.data(), end);
    if (text.find_first_of(".e") == std::string::npos) {
        text += ".0";
    }
    return text;
}

void table(std::string& out, const std::string& name, const Matrix& m) {
    out +=
        "static const double " + name + "[" + std::to_string(m.rows()) + "][" + std::to_string(m.columns()) + "] = {\n";
    for (std::size_t i = 0; i < m.rows(); ++i) {
        out += "    {";
        for (std::size_t j = 0; j < m.columns(); ++j) {
            out += (j > 0 ? ", " : "") + number(m(i, j));
        }
        out += i + 1 < m.rows() ? "},\n" : "}};\n";
    }
}

void table(std::string& out, const std::string& name, const Vector& v) {
    out += "static const double " + name + "[" + std::to_string(v.size()) + "] = {";
    for (std::size_t i = 0; i < v.size(); ++i) {
        out += (i > 0 ? ", " : "") + number(v[i]);
    }
    out += "};\n";
}

std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& n : names) {
        text += (text.empty() ? "" : ", ") + n;
    }
    return text;
}

void check_name(const std::string& name) {
    bool good = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0;
    for (const char c : name) {
        good = good && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
    }
    if (!good) {
        throw core::InputError("name", "'" + name + "' is no name in C", {},
                               "letters, digits and '_', not beginning with a digit");
    }
}

std::string sum_line(const std::string& target, const std::string& matrix, std::size_t columns,
                     const std::string& factor) {
    return "        for (j = 0; j < " + std::to_string(columns) + "; ++j) {\n            " + target + " += " + matrix +
           "[i][j] * " + factor + "[j];\n        }\n";
}

/// The functions start and step, and read, by which both write the estimates.
std::string functions_of(const LinearFilter& f, const std::string& name) {
    const std::size_t n = f.phi.rows(), m = f.measured.size(), q = f.inputs.size(), p = f.estimates.size();
    const auto count = [](std::size_t v) { return std::to_string(v); };
    std::string out;
    out += "\nstatic inline void " + name + "_read(const " + name + "_state *o, double *estimates) {\n    int i, j;\n";
    out += "    for (i = 0; i < " + count(p) + "; ++i) {\n        double sum = " + name + "_output_constant[i];\n";
    out += sum_line("sum", name + "_output", n, "o->s") + sum_line("sum", name + "_feed", m, "o->last");
    out += "        estimates[i] = sum;\n    }\n}\n\n";
    out += "static inline void " + name + "_start(" + name +
           "_state *o, const double *measured, double *estimates) {\n    int i, j;\n";
    out += "    for (i = 0; i < " + count(m) + "; ++i) {\n        o->last[i] = measured[i];\n    }\n";
    out += "    for (i = 0; i < " + count(n) + "; ++i) {\n        double sum = " + name + "_start_value[i];\n";
    out += sum_line("sum", name + "_start_feed", m, "measured") + "        o->s[i] = sum;\n    }\n";
    out += "    " + name + "_read(o, estimates);\n}\n\n";
    out += "static inline void " + name + "_step(" + name +
           "_state *o, const double *measured, const double *input, double *estimates) {\n    double next[" + count(n) +
           "];\n    int i, j;\n";
    out += "    for (i = 0; i < " + count(n) + "; ++i) {\n        double sum = " + name + "_constant[i];\n";
    out += sum_line("sum", name + "_phi", n, "o->s") + sum_line("sum", name + "_previous", m, "o->last") +
           sum_line("sum", name + "_present", m, "measured") + sum_line("sum", name + "_input", q, "input");
    out += "        next[i] = sum;\n    }\n";
    out += "    for (i = 0; i < " + count(n) + "; ++i) {\n        o->s[i] = next[i];\n    }\n";
    out += "    for (i = 0; i < " + count(m) + "; ++i) {\n        o->last[i] = measured[i];\n    }\n";
    out += "    " + name + "_read(o, estimates);\n}\n\n#endif\n";
    return out;
}

std::string head_of(const LinearFilter& f, const std::string& name, const std::vector<std::string>& made_from) {
    std::string out = "/* Observer '" + f.name + "' at a sample time of " + number(f.step) + " s, SI units.\n";
    out +=
        " * measured:  " + list(f.measured) + "\n * input:     " + list(f.inputs) + " (held since the last sample)\n";
    out += " * estimates: " + list(f.estimates) + "\n";
    for (std::string line : made_from) {
        for (std::size_t at; (at = line.find("*/")) != std::string::npos;) {
            line.replace(at, 2, "* /");
        }
        out += " * made from: " + line + "\n";
    }
    out += " * C99, no heap, no library. Call " + name + "_start with the first sample, then " + name +
           "_step with each next one. */\n";
    return out;
}

}  // namespace

std::string export_c(const LinearFilter& f, const std::string& name, const std::vector<std::string>& made_from) {
    check_name(name);
    const FilterRunner sizes_agree(f);
    const std::size_t n = f.phi.rows(), m = f.measured.size(), q = f.inputs.size(), p = f.estimates.size();
    const auto count = [](std::size_t v) { return std::to_string(v); };
    const std::string head = head_of(f, name, made_from);
    std::string out;
    out += "enum { " + name + "_states = " + count(n) + ", " + name + "_measured = " + count(m) + ", " + name +
           "_inputs = " + count(q) + ", " + name + "_estimates = " + count(p) + " };\n\n";
    out += "typedef struct {\n    double s[" + count(n) + "];\n    double last[" + count(m) + "];\n} " + name +
           "_state;\n\n";
    table(out, name + "_phi", f.phi);
    table(out, name + "_previous", f.previous);
    table(out, name + "_present", f.present);
    table(out, name + "_input", f.input);
    table(out, name + "_constant", f.constant);
    table(out, name + "_output", f.output);
    table(out, name + "_feed", f.feed);
    table(out, name + "_output_constant", f.output_constant);
    table(out, name + "_start_value", f.start);
    table(out, name + "_start_feed", f.start_feed);
    out += functions_of(f, name);
    // Another observer of the same name has another guard: a compiler then says what is defined twice.
    const std::string guard = "UNDERBODY_" + name + "_" + core::content_hash(out).substr(0, 12) + "_H";
    return head + "#ifndef " + guard + "\n#define " + guard + "\n\n" + out;
}

}  // namespace underbody::estimator
