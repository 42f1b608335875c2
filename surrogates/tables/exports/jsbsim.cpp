// JSBSim: <external_reactions> that apply the forces and moments to the body, with <table>s of the values, their slopes
// and errors as functions. JSBSim interpolates linearly between the points of a table and holds the ends, so the grid
// is one that is dense enough for that, and the file says so.
#include <algorithm>

#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

constexpr double foot = 0.3048;            ///< m
constexpr double pound = 4.4482216152605;  ///< N
const char* const forces[] = {"x", "y", "z"};

class Writer {
public:
    explicit Writer(const ExportGrid& grid) : g_(grid), n_(grid.axes.size()) {}

    std::string text() {
        out_ = "<?xml version=\"1.0\"?>\n<!--\n";
        for (const auto& line : g_.origin) {
            out_ += "  " + without_dashes(line) + "\n";
        }
        out_ +=
            "  JSBSim interpolates linearly and has no cubics: the points are so dense that this differs from the "
            "table by no more than said above.\n";
        out_ +=
            "  Outside the range of an axis JSBSim holds the end value; it cannot refuse or extrapolate.\n"
            "  " +
            property("outside") + " is 1 there, else 0; " + property("no_data") +
            " is 1 where no points of the table lie around: outside, or in an empty corner of its box.\n";
        out_ +=
            "  Use: <external_reactions file=\"...\"/> in the aircraft. The forces act at the centre of the base, the "
            "moments are about it.\n";
        out_ += g_.lever ? "  <location> holds when the centre of gravity is the origin of the structural frame; else "
                           "add its place there.\n"
                         : "  Nothing says where the centre of the base is: <location> is the origin of the structural "
                           "frame, move it there.\n";
        out_ += "  Inputs to be set, in SI units:" + inputs_to_set() + "\n-->\n<external_reactions>\n";
        inputs();
        for (const auto& q : g_.quantities) {
            tables(q);
        }
        flags();
        reactions();
        return out_ + "</external_reactions>\n";
    }

private:
    [[nodiscard]] std::string property(const std::string& name) const { return "underbody/" + g_.name + "/" + name; }
    [[nodiscard]] static std::string element(const std::string& what, const std::string& content) {
        return "<" + what + ">" + content + "</" + what + ">";
    }
    [[nodiscard]] static std::string from(const std::string& name) { return element("property", name); }
    [[nodiscard]] static std::string value(double v) { return element("value", core::format_number(v)); }
    [[nodiscard]] static std::string product(const std::string& factors) { return element("product", factors); }
    static std::string without_dashes(std::string text) {
        for (std::size_t at; (at = text.find("--")) != std::string::npos;) {
            text.replace(at, 2, "- ");
        }
        return text;
    }

    void function(const std::string& name, const std::string& what, const std::string& content) {
        out_ += " <function name=\"" + property(name) + "\">\n  <description>" + core::escape_html(what) +
                "</description>\n  " + content + "\n </function>\n";
    }

    /// What JSBSim knows of an axis; empty: nothing.
    [[nodiscard]] std::string state(const std::string& axis) const {
        const std::string theta = from("attitude/theta-rad");
        if (axis == "pitch") {
            return theta;
        }
        if (axis == "pitch_rate") {
            return from("velocities/q-rad_sec");
        }
        if (axis == "heave_velocity" || axis == "heave_velocity_down") {
            return product(from("velocities/h-dot-fps") + value(axis == "heave_velocity" ? foot : -foot));
        }
        if (axis == "speed") {
            return element("abs", from(property("forward_speed")));
        }
        if (axis == "time") {
            return from("simulation/sim-time-sec");
        }
        if (axis == "gap" && g_.lever) {
            // Of the centre of gravity, less how far the centre of the base hangs below it.
            const auto& [x, y, z] = *g_.lever;
            const std::string phi = from("attitude/phi-rad");
            const std::string below =
                element("sum", product(value(y) + element("sin", phi)) + product(value(z) + element("cos", phi)));
            return element("difference", element("sum", product(from("position/h-agl-ft") + value(foot)) +
                                                            product(value(x) + element("sin", theta))) +
                                             product(below + element("cos", theta)));
        }
        return "";
    }

    [[nodiscard]] std::string inputs_to_set() const {
        std::string list;
        for (const auto& axis : g_.axes) {
            list += state(axis.name).empty() ? " " + property(axis.name) + " [" + axis.unit + "]" : "";
        }
        return list.empty() ? " none" : list;
    }

    void inputs() {
        for (const auto& axis : g_.axes) {
            if (state(axis.name).empty()) {
                out_ += " <property value=\"" + core::format_number(0.5 * (axis.lower + axis.upper)) + "\">" +
                        property(axis.name) + "</property>\n";
            }
        }
        const std::string theta = from("attitude/theta-rad");
        function("forward_speed", "m/s, through the water, along the ground in the heading",
                 product(element("sum", product(from("velocities/u-aero-fps") + element("cos", theta)) +
                                            product(from("velocities/w-aero-fps") + element("sin", theta))) +
                         value(foot)));
        for (const auto& axis : g_.axes) {
            if (const std::string content = state(axis.name); !content.empty()) {
                function(axis.name, axis.unit, content);
            }
        }
    }

    using Lines = std::vector<std::vector<double>>;

    void tables(const ExportQuantity& q) {
        const auto& data = q.surface.hermite();
        Lines x;
        for (const auto& axis : g_.axes) {
            x.push_back(axis.points);
        }
        table(q.name, q.name + " [" + q.unit + "]", x, [&](std::size_t node) { return data[node << n_]; });
        for (std::size_t k = 0; k < n_; ++k) {
            table(q.name + "_per_" + g_.axes[k].name,
                  "slope along " + g_.axes[k].name + ", " + q.unit + " per " + g_.axes[k].unit, x,
                  [&](std::size_t node) { return data[(node << n_) + (std::size_t{1} << k)]; });
        }
        table(q.name + "_sigma", "one standard deviation, " + q.unit, x,
              [&](std::size_t node) { return q.error.empty() ? 0 : q.error.node_sigma()[node]; });
    }

    void flags() {
        std::string beyond;
        for (const auto& axis : g_.axes) {
            const std::string at = from(property(axis.name));
            beyond += element("lt", at + value(axis.lower)) + element("gt", at + value(axis.upper));
        }
        function("outside", "1 outside the range of an axis, else 0", element("or", beyond));
        const Steps steps = no_data_steps(g_);
        table("no_data", "1 where no points of the table lie around, else 0", steps.points,
              [&](std::size_t node) { return steps.value[node]; });
    }

    template <class F>
    void table(const std::string& name, const std::string& what, const Lines& x, F&& f) {
        std::string out = "<table>\n";
        static const char* lookups[] = {"row", "column", "table"};
        for (std::size_t k = 0; k < n_; ++k) {
            out += std::string("   <independentVar lookup=\"") + lookups[k] + "\">" + property(g_.axes[k].name) +
                   "</independentVar>\n";
        }
        if (n_ == 1) {
            out += "   <tableData>\n";
            for (std::size_t i = 0; i < x[0].size(); ++i) {
                out += "    " + core::format_number(x[0][i]) + " " + core::format_number(f(i)) + "\n";
            }
            out += "   </tableData>\n";
        } else if (n_ == 2) {
            out += "   <tableData>\n" + block(x, f, 1, 0) + "   </tableData>\n";
        } else {
            for (std::size_t i = 0; i < x[2].size(); ++i) {
                out += "   <tableData breakPoint=\"" + core::format_number(x[2][i]) + "\">\n" +
                       block(x, f, x[2].size(), i) + "   </tableData>\n";
            }
        }
        function(name, what, out + "  </table>");
    }

    /// Rows along axis 0, columns along axis 1, out of nodes with the last axis fastest.
    template <class F>
    static std::string block(const Lines& x, F&& f, std::size_t layers, std::size_t layer) {
        std::string out = "    ";
        for (const double y : x[1]) {
            out += " " + core::format_number(y);
        }
        out += "\n";
        for (std::size_t i = 0; i < x[0].size(); ++i) {
            out += "    " + core::format_number(x[0][i]);
            for (std::size_t j = 0; j < x[1].size(); ++j) {
                out += " " + core::format_number(f((i * x[1].size() + j) * layers + layer));
            }
            out += "\n";
        }
        return out;
    }

    /// The property of a force by its name in the frame of lift and drag; a minus where the frame has turned it; empty:
    /// not among the quantities.
    [[nodiscard]] std::string of(const char* up, const char* ned, double sign) const {
        for (const auto& q : g_.quantities) {
            if (q.name == up || q.name == ned) {
                return product(from(property(q.name)) + value(q.name == up ? 1 : sign));
            }
        }
        return value(0);
    }

    /// Forces along body axes at the centre of the base, moments about it; N and N m as functions, pounds and feet for
    /// JSBSim.
    void reactions() {
        const std::string st = element("sin", from("attitude/theta-rad")),
                          ct = element("cos", from("attitude/theta-rad")),
                          sp = element("sin", from("attitude/phi-rad")), cp = element("cos", from("attitude/phi-rad"));
        function("up", "N, away from the ground", of("lift_force", "z_force", -1));
        // Drag turns with the motion, smoothly through rest.
        const std::string forward = from(property("forward_speed"));
        function("back", "N, along the ground against the heading",
                 product(of("drag_force", "x_force", -1) +
                         element("quotient",
                                 forward + element("pow", element("sum", product(forward + forward) + value(1e-6)) +
                                                              value(0.5)))));
        const std::string up = from(property("up")), back = from(property("back"));
        function("x", "N, body axis forward", element("difference", product(up + st) + product(back + ct)));
        function("y", "N, body axis to starboard",
                 element("difference", of("side_force", "y_force", 1) +
                                           product(sp + element("sum", product(up + ct) + product(back + st)))));
        function("z", "N, body axis down",
                 product(value(-1) + cp + element("sum", product(up + ct) + product(back + st))));
        for (int k = 0; k < 3; ++k) {
            const Lever lever = g_.lever.value_or(Lever{});
            out_ += std::string(" <force name=\"") + g_.name + "_" + forces[k] + "\" frame=\"BODY\">\n  " +
                    element("function", product(from(property(forces[k])) + value(1 / pound))) +
                    "\n  <location unit=\"M\"> <x> " + core::format_number(lever[0] == 0 ? 0 : -lever[0]) +
                    " </x> <y> " + core::format_number(lever[1]) + " </y> <z> " +
                    core::format_number(lever[2] == 0 ? 0 : -lever[2]) + " </z> </location>\n" + direction(k) +
                    " </force>\n";
        }
        const char* const moments[] = {"roll_moment", "pitch_moment", "yaw_moment"};
        for (int k = 0; k < 3; ++k) {
            const bool given = std::any_of(g_.quantities.begin(), g_.quantities.end(),
                                           [&](const ExportQuantity& q) { return q.name == moments[k]; });
            if (given) {
                out_ += std::string(" <moment name=\"") + g_.name + "_" + moments[k] + "\" frame=\"BODY\">\n  " +
                        element("function", product(from(property(moments[k])) + value(1 / (pound * foot)))) + "\n" +
                        direction(k) + " </moment>\n";
            }
        }
    }

    static std::string direction(int axis) {
        std::string text = "  <direction>";
        for (int k = 0; k < 3; ++k) {
            text += std::string(" <") + forces[k] + "> " + (k == axis ? "1" : "0") + " </" + forces[k] + ">";
        }
        return text + " </direction>\n";
    }

    const ExportGrid& g_;
    std::size_t n_;
    std::string out_;
};

void say(ExportResult& result, core::Problem::Severity severity, std::string text) {
    result.remarks.push_back({severity, std::move(text), {}});
}

}  // namespace

void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    for (const auto& q : grid.quantities) {
        say(result, core::Problem::Severity::note,
            "JSBSim interpolates linearly: within " + core::format_number(q.difference, 3) + " " + q.unit +
                " of the table" + (grid.quantities.size() > 1 ? " of " + q.name : ""));
    }
    for (const auto& axis : grid.axes) {
        if (axis.range != RangePolicy::clamp) {
            say(result, core::Problem::Severity::warning,
                "JSBSim holds the ends of " + axis.name + ": it cannot " + to_string(axis.range));
        }
    }
    if (!grid.lever) {
        say(result, core::Problem::Severity::warning,
            "nothing says where the centre of the base lies: the forces act at the origin of the structural frame, and "
            "the gap is an input");
    }
    core::write_file(path, Writer(grid).text());
}

}  // namespace underbody::tables
