// Force tables: a fit once, then values at many points.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/parallel.h"
#include "core/units.h"
#include "studio/cli/caller.h"
#include "studio/cli/shell.h"
#include "studio/cli/table_options.h"
#include "studio/python/call.h"
#include "studio/python/docstrings.h"
#include "studio/python/module.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/table_batch.h"

namespace underbody::python {

namespace {

using tables::ForceTable;
using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array that owns the numbers.
py::array_t<double> taken(std::vector<double>&& numbers, std::vector<py::ssize_t> shape = {}) {
    auto* kept = new std::vector<double>(std::move(numbers));
    const py::capsule owner(kept, [](void* all) { delete static_cast<std::vector<double>*>(all); });
    if (shape.empty()) {
        shape = {static_cast<py::ssize_t>(kept->size())};
    }
    return py::array_t<double>(shape, kept->data(), owner);
}

/// [n, axes]
std::size_t rows_of(const ForceTable& table, const Points& points) {
    if (points.ndim() != 2 || static_cast<std::size_t>(points.shape(1)) != table.axes().size()) {
        throw core::UsageError("shape", "points have to be (n, " + std::to_string(table.axes().size()) +
                                            "): one column for each axis of the table");
    }
    return static_cast<std::size_t>(points.shape(0));
}

/// Points in Python's threads' own time: blocks on all cores.
constexpr std::size_t block = 16384;

py::tuple values(const ForceTable& table, const Points& points, bool with_slopes) {
    const std::size_t rows = rows_of(table, points);
    const std::size_t axes = table.axes().size();
    std::vector<double> value(rows), slope(with_slopes ? rows * axes : 0);
    bool by_policy = false;
    for (const auto& axis : table.axes()) {
        by_policy = by_policy || axis.range != tables::RangePolicy::clamp;
    }
    const double* at = points.data();
    Call(py::none()).run(core::Progress::none(), [&] {
        core::parallel_blocks(rows, block, [&](std::size_t begin, std::size_t end) {
            double* to = with_slopes ? slope.data() + begin * axes : nullptr;
            if (!by_policy) {
                tables::values(table, at + begin * axes, end - begin, value.data() + begin, to);
                return;
            }
            for (std::size_t i = begin; i < end; ++i) {
                value[i] = table.value_by_policy(at + i * axes, with_slopes ? slope.data() + i * axes : nullptr);
            }
        });
    });
    return py::make_tuple(
        taken(std::move(value)),
        with_slopes
            ? py::object(taken(std::move(slope), {static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(axes)}))
            : py::object(py::none()));
}

/// value, sigma, slope [n, axes], outside, no_data
py::tuple at(const ForceTable& table, const Points& points) {
    const std::size_t rows = rows_of(table, points);
    const std::size_t axes = table.axes().size();
    std::vector<double> value(rows), sigma(rows), slope(rows * axes);
    std::vector<unsigned char> outside(rows), no_data(rows);
    const double* first = points.data();
    Call(py::none()).run(core::Progress::none(), [&] {
        core::parallel_blocks(rows, 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto e = table.at({first + i * axes, axes});
                value[i] = e.value;
                sigma[i] = e.sigma;
                std::copy_n(e.slope.begin(), axes, slope.begin() + static_cast<std::ptrdiff_t>(i * axes));
                outside[i] = e.outside ? 1 : 0;
                no_data[i] = e.no_data ? 1 : 0;
            }
        });
    });
    const auto flags = [](const std::vector<unsigned char>& all) {
        py::array_t<bool> result(static_cast<py::ssize_t>(all.size()));
        std::copy(all.begin(), all.end(), result.mutable_data());
        return result;
    };
    return py::make_tuple(taken(std::move(value)), taken(std::move(sigma)),
                          taken(std::move(slope), {static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(axes)}),
                          flags(outside), flags(no_data));
}

/// Do all points lie within the axes? The usual case, in one quick pass.
bool all_inside(const ForceTable& table, const double* first, std::size_t rows) {
    const std::size_t axes = table.axes().size();
    for (std::size_t k = 0; k < axes; ++k) {
        double lowest = table.axes()[k].lower, highest = table.axes()[k].upper;
        const double* x = first + k;
        for (std::size_t i = 0; i < rows; ++i, x += axes) {
            lowest = *x < lowest ? *x : lowest;
            highest = *x > highest ? *x : highest;
        }
        if (lowest < table.axes()[k].lower || highest > table.axes()[k].upper) {
            return false;
        }
    }
    return true;
}

/// The remark of the point that lies furthest outside, and how many do; nothing when all lie inside.
py::object outside_remark(const ForceTable& table, const Points& points) {
    const std::size_t rows = rows_of(table, points);
    const std::size_t axes = table.axes().size();
    const double* first = points.data();
    if (all_inside(table, first, rows)) {
        return py::none();
    }
    std::size_t count = 0, worst = 0;
    double furthest = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        double beyond = 0;
        for (std::size_t k = 0; k < axes; ++k) {
            const auto& axis = table.axes()[k];
            const double x = first[i * axes + k];
            beyond = std::max(beyond, std::max(axis.lower - x, x - axis.upper) / (axis.upper - axis.lower));
        }
        count += beyond > 0 ? 1 : 0;
        if (beyond > furthest) {
            furthest = beyond;
            worst = i;
        }
    }
    tables::Held held;
    for (std::size_t k = 0; k < axes; ++k) {
        held.emplace_back(table.axes()[k].name, first[worst * axes + k]);
    }
    std::string text;
    for (const auto& remark : tables::outside_remarks(table, held)) {
        text += (text.empty() ? "" : "; ") + remark.message;
    }
    return rows == 1 ? py::str(text)
                     : py::str(std::to_string(count) + " of " + std::to_string(rows) + " points lie outside: " + text);
}

/// The values of all axes, those that `given` does not name as the command line takes them; and what was chosen.
py::tuple held_point(const ForceTable& table, const std::vector<std::pair<std::string, double>>& given) {
    core::Problems remarks;
    auto point = tables::held_point(table, {}, given, &remarks);
    std::vector<std::string> texts;
    for (const auto& remark : remarks) {
        texts.push_back(remark.message);
    }
    return py::make_tuple(point, texts);
}

py::tuple fit(const std::map<std::string, std::string>& given, const py::object& progress) {
    studio::TableOptions options;
    for (const auto& [name, member] : {std::pair{"table", &studio::TableOptions::file},
                                       {"quantity", &studio::TableOptions::quantity},
                                       {"where", &studio::TableOptions::where},
                                       {"axes", &studio::TableOptions::axes},
                                       {"kind", &studio::TableOptions::kind},
                                       {"range", &studio::TableOptions::range}}) {
        if (const auto found = given.find(name); found != given.end()) {
            options.*member = found->second;
        }
    }
    studio::Caller caller;
    Call call(progress);
    studio::Shell shell(caller, call.listener());
    std::optional<ForceTable> table;
    call.run(shell.progress(), [&] { table = options.fit(shell); });
    py::list remarks;
    for (const auto& [level, text] : caller.remarks) {
        remarks.append(py::make_tuple(static_cast<int>(level), text));
    }
    return py::make_tuple(*table, remarks);
}

}  // namespace

py::dict columns_of(core::Table&& table) {
    py::dict columns;
    for (const core::Column& column : table.columns()) {
        // The table goes: its numbers may move out.
        auto& own = const_cast<core::Column&>(column);
        columns[column.name.c_str()] =
            column.is_text() ? py::cast(column.text) : py::object(taken(std::move(own.numbers)));
    }
    return columns;
}

void add_tables(py::module_& module) {
    py::class_<ForceTable>(module, "FittedTable", docs::ForceTable)
        .def_property_readonly("quantity", &ForceTable::quantity)
        .def_property_readonly("unit", &ForceTable::unit)
        .def_property_readonly("kind", &ForceTable::kind)
        .def_property_readonly("source", &ForceTable::source, docs::ForceTable_source)
        .def_property_readonly("json",
                               [](const ForceTable& table) {
                                   return nlohmann::json(table).dump(-1, ' ', false,
                                                                     nlohmann::json::error_handler_t::replace);
                               })
        .def_property_readonly("axes",
                               [](const ForceTable& table) {
                                   std::vector<std::tuple<std::string, std::string, double, double>> axes;
                                   for (const auto& axis : table.axes()) {
                                       axes.emplace_back(axis.name, axis.unit, axis.lower, axis.upper);
                                   }
                                   return axes;
                               })
        .def_property_readonly(
            "points", [](const ForceTable& table) { return columns_of(core::Table(table.points())); },
            docs::ForceTable_points)
        .def("values", &values)
        .def("at", &at)
        .def("outside_remark", &outside_remark)
        .def("held_point", &held_point);
    module.def("fit", &fit);
}

}  // namespace underbody::python
