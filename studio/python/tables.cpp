// Force tables: a fit once, then values at many points.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
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
using Numbers = py::array_t<double, py::array::forcecast>;

/// An array that owns the numbers.
py::array_t<double> taken(std::vector<double>&& numbers) {
    auto* kept = new std::vector<double>(std::move(numbers));
    const py::capsule owner(kept, [](void* all) { delete static_cast<std::vector<double>*>(all); });
    return py::array_t<double>(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
}

/// Points as columns, one for each axis of a table, taken where they lie; a column of one number stands for every
/// point.
class Points {
public:
    Points(const ForceTable& table, const py::sequence& columns) {
        if (columns.size() != table.axes().size()) {
            throw core::UsageError("shape", "points have to be (n, " + std::to_string(table.axes().size()) +
                                                "): one column for each axis of the table");
        }
        for (const auto& one : columns) {
            columns_.push_back(one.cast<Numbers>());
            const Numbers& column = columns_.back();
            const auto count = static_cast<std::size_t>(column.size());
            first_.push_back(reinterpret_cast<const char*>(column.data()));
            step_.push_back(count == 1 ? 0 : column.strides(0));
            rows_ = count != 1 ? count : rows_;
        }
    }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] double operator()(std::size_t row, std::size_t axis) const {
        double x = 0;
        std::memcpy(&x, first_[axis] + static_cast<py::ssize_t>(row) * step_[axis], sizeof x);
        return x;
    }
    /// Rows [begin, end) side by side: [(end - begin) * axes]. Whether one of them lies outside the table's axes.
    bool gather(const ForceTable& table, std::size_t begin, std::size_t end, double* to) const {
        const std::size_t axes = first_.size();
        bool outside = false;
        for (std::size_t k = 0; k < axes; ++k) {
            const double lower = table.axes()[k].lower, upper = table.axes()[k].upper;
            const char* from = first_[k] + static_cast<py::ssize_t>(begin) * step_[k];
            const py::ssize_t step = step_[k];
            for (std::size_t i = 0; i < end - begin; ++i, from += step) {
                double x = 0;
                std::memcpy(&x, from, sizeof x);
                to[i * axes + k] = x;
                outside |= static_cast<bool>(static_cast<int>(x < lower) | static_cast<int>(x > upper));
            }
        }
        return outside;
    }

    /// Points of a block, small enough for the processor's cache.
    static constexpr std::size_t block = 8192;

private:
    std::vector<Numbers> columns_;
    std::vector<const char*> first_;
    std::vector<py::ssize_t> step_;  // bytes
    std::size_t rows_ = 1;
};

/// Work on blocks of points in Python's threads' own time: work(begin, end, points of the block). Whether a point lies
/// outside the table's axes.
template <typename Work>
bool for_blocks(const ForceTable& table, const Points& points, std::size_t block, const Work& work) {
    std::atomic<bool> outside = false;
    Call(py::none()).run(core::Progress::none(), [&] {
        core::parallel_blocks(points.rows(), block, [&](std::size_t begin, std::size_t end) {
            const auto gathered = std::make_unique_for_overwrite<double[]>((end - begin) * table.axes().size());
            if (points.gather(table, begin, end, gathered.get())) {
                outside = true;
            }
            work(begin, end, gathered.get());
        });
    });
    return outside;
}

/// An array that nothing is written to yet: [rows], or [rows, columns].
template <typename Number = double>
py::array_t<Number> room_for(std::size_t rows) {
    return py::array_t<Number>(static_cast<py::ssize_t>(rows));
}
py::array_t<double> room_for(std::size_t rows, std::size_t columns) {
    return py::array_t<double>({static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

/// value, slope [n, axes] or None, and whether a point lies outside the axes
py::tuple values(const ForceTable& table, const py::sequence& columns, bool with_slopes) {
    const Points points(table, columns);
    const std::size_t axes = table.axes().size();
    py::array_t<double> value = room_for(points.rows()), slope = room_for(with_slopes ? points.rows() : 0, axes);
    double *const values = value.mutable_data(), *const slopes = with_slopes ? slope.mutable_data() : nullptr;
    const bool by_policy = std::any_of(table.axes().begin(), table.axes().end(), [](const tables::TableAxis& axis) {
        return axis.range != tables::RangePolicy::clamp;
    });
    const bool outside =
        for_blocks(table, points, Points::block, [&](std::size_t begin, std::size_t end, const double* at) {
            double* to = with_slopes ? slopes + begin * axes : nullptr;
            if (!by_policy) {
                tables::values(table, at, end - begin, values + begin, to);
                return;
            }
            for (std::size_t i = begin; i < end; ++i, at += axes, to += with_slopes ? axes : 0) {
                values[i] = table.value_by_policy(at, to);
            }
        });
    return py::make_tuple(value, with_slopes ? py::object(slope) : py::object(py::none()), outside);
}

/// value, sigma, slope [n, axes], outside, no_data, and whether a point lies outside the axes
py::tuple at(const ForceTable& table, const py::sequence& columns) {
    const Points points(table, columns);
    const std::size_t rows = points.rows(), axes = table.axes().size();
    py::array_t<double> value = room_for(rows), sigma = room_for(rows), slope = room_for(rows, axes);
    py::array_t<bool> outside = room_for<bool>(rows), no_data = room_for<bool>(rows);
    double *const values = value.mutable_data(), *const sigmas = sigma.mutable_data(),
                  *const slopes = slope.mutable_data();
    bool *const are_outside = outside.mutable_data(), *const lack_data = no_data.mutable_data();
    const bool beyond = for_blocks(table, points, 1024, [&](std::size_t begin, std::size_t end, const double* point) {
        for (std::size_t i = begin; i < end; ++i, point += axes) {
            const auto e = table.at({point, axes});
            values[i] = e.value;
            sigmas[i] = e.sigma;
            std::copy_n(e.slope.begin(), axes, slopes + i * axes);
            are_outside[i] = e.outside;
            lack_data[i] = e.no_data;
        }
    });
    return py::make_tuple(value, sigma, slope, outside, no_data, beyond);
}

/// The remark of the point that lies furthest outside, and how many do.
py::str outside_remark(const ForceTable& table, const py::sequence& columns) {
    const Points points(table, columns);
    const std::size_t rows = points.rows(), axes = table.axes().size();
    std::size_t count = 0, worst = 0;
    double furthest = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        double beyond = 0;
        for (std::size_t k = 0; k < axes; ++k) {
            const auto& axis = table.axes()[k];
            const double x = points(i, k);
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
        held.emplace_back(table.axes()[k].name, points(worst, k));
    }
    std::string text;
    for (const auto& remark : tables::outside_remarks(table, held)) {
        text += (text.empty() ? "" : "; ") + remark.message;
    }
    return rows == 1 ? py::str(text)
                     : py::str(core::counted_of(count, rows, "point", "lies", "lie") + " outside: " + text);
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
