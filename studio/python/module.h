// The parts of the Python module, one source each.
#pragma once

#include <pybind11/pybind11.h>

#include "core/table.h"

namespace underbody::python {

void add_fields(pybind11::module_& module);
void add_tables(pybind11::module_& module);
void add_commands(pybind11::module_& module);

/// {name: array or list of str} of a table's columns; the arrays take the numbers over without a copy.
pybind11::dict columns_of(core::Table&& table);

}  // namespace underbody::python
